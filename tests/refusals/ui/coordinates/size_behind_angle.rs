dalembert::model! {
    Particle {
        coordinates { theta: angle[3]; }
        parameters { m > 0 = 1; k > 0 = 1; }
        lagrangian = m/2*sum(i in 1..=3: dot(theta[i])^2);
    }
}

fn main() {}
