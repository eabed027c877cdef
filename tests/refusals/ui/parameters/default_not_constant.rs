dalembert::model! {
    Particle {
        coordinates { x; }
        parameters { m > 0 = x; }
        lagrangian = m/2*dot(x)^2;
    }
}

fn main() {}
