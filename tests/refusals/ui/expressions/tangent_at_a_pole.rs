dalembert::model! {
    Particle {
        coordinates { x; y; theta: angle; }
        parameters { m > 0 = 1; v = 2; }
        lagrangian = m/2*(dot(x)^2 + dot(y)^2 + dot(theta)^2) - x*tan(pi/2);
    }
}

fn main() {}
