dalembert::model! {
    Particle {
        coordinates { x; y; theta: angle; }
        parameters { m > 0 = 1; k > 0 = 1; }
        lagrangian = m/2*(dot(x)^2 + dot(y)^2 + dot(theta)^2);
        constraints {
            first: d(x) - k*d(y) = 0;
            second: 2*d(x) - 2*k*d(y) = 0;
        }
    }
}

fn main() {}
