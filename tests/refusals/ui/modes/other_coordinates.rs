dalembert::model! {
    Particle {
        parameters { m > 0 = 1; }
        modes {
            flat { coordinates { x; y; } lagrangian = m/2*(dot(x)^2 + dot(y)^2); }
            round { coordinates { phi: angle; } lagrangian = m/2*dot(phi)^2; }
        }
        transitions { enter: flat -> round when x >= 1; leave: round -> flat when phi <= -pi/2 => reset { x = 1; }; }
    }
}

fn main() {}
