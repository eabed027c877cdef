dalembert::model! {
    Particle {
        coordinates { x; y; theta: angle; }
        parameters { m > 0 = 1; k > 0 = 1; }
        lagrangian = m/2*(dot(x)^2 + dot(y)^2 + dot(theta)^2);
        impacts { wall: x >= 0 => reset { dot(x) == 0; }; }
    }
}

fn main() {}
