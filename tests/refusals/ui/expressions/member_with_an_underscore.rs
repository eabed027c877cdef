dalembert::model! {
    Particle {
        coordinates { q[3]; }
        parameters { m > 0 = 1; k > 0 = 1; }
        lagrangian = m/2*sum(i in 1..=3: dot(q[i])^2);
        outputs { o: q_1; }
    }
}

fn main() {}
