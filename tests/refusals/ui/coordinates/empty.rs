dalembert::model! {
    Particle {
        coordinates { }
        parameters { m > 0 = 1; }
        lagrangian = m;
    }
}

fn main() {}
