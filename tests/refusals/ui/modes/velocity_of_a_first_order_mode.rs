dalembert::model! {
    Particle {
        coordinates { x; y; }
        modes { one { field { dot(x) = 1; dot(y) = 0; } } two { field { dot(x) = -1; dot(y) = 0; } } }
        transitions { on: one -> two when x >= 1 => reset { dot(x) = 0; }; }
    }
}

fn main() {}
