dalembert::model! {
    Particle {
        coordinates { x; }
        parameters { m > 1 = 2; }
        lagrangian = m/2*dot(x)^2;
    }
}

fn main() {}
