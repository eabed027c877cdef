dalembert::model! {
    Particle {
        coordinates { x; y; theta: angle; }
        parameters { m > 0 = 1; k > 0 = 1; }
        lagrangian = m/2*(dot(x)^2 + dot(y)^2 + dot(theta)^2);
        modes {
            smooth { impacts { wall: y >= 0; } }
            rough { impacts { wall: y >= 1; } }
        }
        transitions { enter: smooth -> rough when x >= 0; }
    }
}

fn main() {}
