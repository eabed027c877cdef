dalembert::model! {
    Particle {
        coordinates { x; y; theta: angle; }
        parameters { m > 0 = 1; k > 0 = 1; }
        lagrangian = m/2*(dot(x)^2 + dot(y)^2 + dot(theta)^2);
        modes { smooth { constraints { hold: d(x) = 0; } } rough { } }
        transitions { enter: smooth -> rough when x >= 1; }
    }
}

fn main() {}
