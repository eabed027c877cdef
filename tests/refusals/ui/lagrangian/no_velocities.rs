dalembert::model! {
    Particle {
        coordinates { x; }
        parameters { m > 0 = 1; }
        lagrangian = -m*x^2;
    }
}

fn main() {}
