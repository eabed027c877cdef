dalembert::model! {
    Particle {
        coordinates { x; y; }
        parameters { m > 0 = 1; }
        lagrangian = m/2*dot(x)^2 + (1 - sin(x)^2 - cos(x)^2)*dot(y)^2;
    }
}

fn main() {}
