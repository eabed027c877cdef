dalembert::model! {
    Particle {
        coordinates { x; }
        parameters { m > 0 = 1; e in [0, 1] = 1.5; }
        lagrangian = m/2*dot(x)^2;
    }
}

fn main() {}
