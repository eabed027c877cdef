dalembert::model! {
    Particle {
        coordinates { q[3]; }
        parameters { m > 0 = 1; }
        lagrangian = m/2*dot(q)^2;
    }
}

fn main() {}
