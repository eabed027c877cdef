dalembert::model! {
    Particle {
        coordinates { q[2]; }
        parameters { m[2] > 0 = [1, 2, 3]; }
        lagrangian = m[1]*dot(q[1])^2 + m[2]*dot(q[2])^2;
    }
}

fn main() {}
