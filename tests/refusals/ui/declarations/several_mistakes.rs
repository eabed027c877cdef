dalembert::model! {
    Particle {
        coordinates { x y; z; }
        lagrangian = 2x;
        constraints { a: d(x) == 0; b: d(z) = 0; c: = 0; }
        modes { }
    }
}

fn main() {}
