dalembert::model! {
    Particle {
        coordinates { x; y; theta: angle; }
        parameters { m in [0.1, pi/2] = 2; }
        lagrangian = m/2*(dot(x)^2 + dot(y)^2 + dot(theta)^2);
    }
}

fn main() {}
