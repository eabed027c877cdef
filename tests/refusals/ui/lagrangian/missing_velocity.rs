dalembert::model! {
    Particle {
        coordinates { x; z; }
        parameters { m > 0 = 1; }
        lagrangian = m/2*dot(x)^2 - m*z;
    }
}

fn main() {}
