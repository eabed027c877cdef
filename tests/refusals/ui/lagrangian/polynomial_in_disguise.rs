dalembert::model! {
    Particle {
        coordinates { x; y; }
        parameters { m > 0 = 1; }
        lagrangian = m/2*dot(y)^2 + sqrt(dot(x)^4)/2;
    }
}

fn main() {}
