dalembert::model! {
    Particle {
        coordinates { x; }
        parameters { m > 0 = 1; }
    }
}

fn main() {}
