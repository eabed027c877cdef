dalembert::model! {
    Particle {
        coordinates { x; }
        parameters { m[300] > 0 = 1; }
        lagrangian = m[1]/2*dot(x)^2;
    }
}

fn main() {}
