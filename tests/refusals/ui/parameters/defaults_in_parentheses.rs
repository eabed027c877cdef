dalembert::model! {
    Particle {
        coordinates { x; y; theta: angle; }
        parameters { m[2] > 0 = (1, 2); }
        lagrangian = m[1]*(dot(x)^2 + dot(y)^2 + dot(theta)^2);
    }
}

fn main() {}
