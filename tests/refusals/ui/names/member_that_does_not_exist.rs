dalembert::model! {
    Particle {
        coordinates { q[3]; }
        parameters { m > 0 = 1; }
        lagrangian = sum(i in 1..=4: m/2*dot(q[i])^2);
    }
}

fn main() {}
