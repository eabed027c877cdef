dalembert::model! {
    Particle {
        coordinates { u in (0, inf); }
        parameters { m > 0 = 1; k > 0 = 1; }
        lagrangian = m/2*dot(u)^2;
    }
}

fn main() {}
