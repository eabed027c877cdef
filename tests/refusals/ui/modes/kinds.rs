dalembert::model! {
    Particle {
        coordinates { x; }
        modes { moving { lagrangian = dot(x)^2; } drifting { field { dot(x) = -x; } } }
        transitions { stop: moving -> drifting when x >= 1; }
    }
}

fn main() {}
