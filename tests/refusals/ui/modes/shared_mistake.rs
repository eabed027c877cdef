dalembert::model! {
    Particle {
        coordinates { x; }
        lagrangian = dot(x)^2 - thta;
        modes { smooth { } rough { lagrangian = dot(x)^2; scenes { s; } } }
        transitions { enter: smooth -> rough when x >= 0; }
    }
}

fn main() {}
