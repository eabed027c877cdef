dalembert::model! {
    Particle {
        coordinates { x; }
        parameters { mode > 0 = 1; }
        lagrangian = mode*dot(x)^2;
        modes { smooth { } rough { } }
        transitions { enter: smooth -> rough when x >= 0; }
    }
}

fn main() {}
