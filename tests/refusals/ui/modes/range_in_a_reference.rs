dalembert::model! {
    Wheel {
        const N = 3;
        coordinates { x; }
        parameters { l[N] > 0 = 1; spokes = 3; }
        modes {
            spoke[i in 1..=N] { lagrangian = l[i]^2*dot(x)^2/2; }
        }
        transitions {
            step: spoke[i in 1..=2] -> spoke[3] when x >= i;
        }
    }
}

fn main() {}
