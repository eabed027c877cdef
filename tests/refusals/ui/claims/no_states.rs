dalembert::model! {
    pub Nowhere {
        coordinates { x; y; }
        lagrangian = (dot(x)^2 + dot(y)^2)/2 - sqrt(x - 1 - x^2);
        claims {
            conserved: energy;
        }
    }
}

fn main() {}
