dalembert::model! {
    Particle {
        coordinates { x; }
        parameters { x > 0 = 1; }
        lagrangian = dot(x)^2;
    }
}

fn main() {}
