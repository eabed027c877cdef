dalembert::model! {
    Particle {
        coordinates { x; }
        lagrangian = dot(x)^2/2
        initial { x = 1; }
    }
}

fn main() {}
