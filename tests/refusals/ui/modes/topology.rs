dalembert::model! {
    Particle {
        modes {
            one { coordinates { x; y; } lagrangian = dot(x)^2 + dot(y)^2; }
            two { coordinates { x: angle; y; } lagrangian = dot(x)^2 + dot(y)^2; }
        }
        transitions { on: one -> two when x >= 1; }
    }
}

fn main() {}
