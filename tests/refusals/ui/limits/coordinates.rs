dalembert::model! {
    Particle {
        coordinates { q[65]; }
        parameters { m > 0 = 1; }
        lagrangian = sum(i in 1..=65: m/2*dot(q[i])^2);
    }
}

fn main() {}
