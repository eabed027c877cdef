dalembert::model! {
    Wheel {
        const N = 3;
        coordinates { x; }
        parameters { l[N] > 0 = 1; spokes = 3; }
        modes {
            spoke[i in 1..=spokes] { lagrangian = dot(x)^2/2; }
        }
        transitions {
            step[i in 1..=N]: spoke[i] -> spoke[i%N + 1] when x >= i => reset { x = -x; };
        }
    }
}

fn main() {}
