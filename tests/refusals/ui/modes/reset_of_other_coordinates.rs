dalembert::model! {
    Particle {
        parameters { m > 0 = 1; }
        modes {
            flat { coordinates { x; y; } lagrangian = m/2*(dot(x)^2 + dot(y)^2); }
            round { coordinates { phi[2]: angle; } lagrangian = m/2*(dot(phi[1])^2 + dot(phi[2])^2); }
        }
        transitions {
            enter: flat -> round when x >= 1 => reset { phi[3] = 0; phy[1] = 0; };
            leave: round -> flat when phi[1] <= -pi/2 => reset { x = 1; x = 2; y = 0; dot(x) = 0; dot(y) = phi[2]; };
        }
    }
}

fn main() {}
