dalembert::model! {
    Particle {
        coordinates { dot; }
        parameters { m > 0 = 1; }
        lagrangian = m/2;
    }
}

fn main() {}
