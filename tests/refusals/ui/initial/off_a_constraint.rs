dalembert::model! {
    Particle {
        coordinates { x; y; }
        lagrangian = (dot(x)^2 + dot(y)^2)/2;
        constraints { rod: x^2 + y^2 = 1; }
        initial { x = 4/5; y = 4/5; }
    }
}

fn main() {}
