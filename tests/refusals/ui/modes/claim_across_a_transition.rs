dalembert::model! {
    Particle {
        coordinates { x; y; }
        modes {
            smooth {
                coordinates { z; }
                lagrangian = (dot(x)^2 + dot(y)^2 + dot(z)^2)/2;
                claims { conserved under enter: energy + z; }
            }
            rough { lagrangian = (dot(x)^2 + dot(y)^2)/2; }
        }
        transitions { enter: smooth -> rough when x >= 0 => reset { y = z; }; }
    }
}

fn main() {}
