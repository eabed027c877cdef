dalembert::model! {
    Wheel {
        const N = 3;
        coordinates { x; }
        parameters { l[N] > 0 = 1; spokes = 3; }
        modes {
            left { lagrangian = dot(x)^2/2; }
            right { lagrangian = dot(x)^2; }
        }
        transitions {
            step[i in 1..=N]: left[i] -> right when x >= i;
        }
    }
}

fn main() {}
