dalembert::model! {
    Particle {
        parameters { m > 0 = 1; }
        lagrangian = m;
    }
}

fn main() {}
