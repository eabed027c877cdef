dalembert::model! {
    Belt {
        coordinates { x; y; }
        parameters { m > 0 = 1; k >= 0 = 0; }
        lagrangian = m/2*(dot(x)^2 + dot(y)^2);
        constraints { belt: k*dot(x) = 0; }
    }
}

fn main() {}
