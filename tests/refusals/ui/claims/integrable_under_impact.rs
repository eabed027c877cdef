dalembert::model! {
    pub Particle {
        coordinates { x; y; theta: angle; }
        parameters { c > 0 = 1/2; }
        lagrangian = (dot(x)^2 + dot(y)^2 + dot(theta)^2)/2;
        impacts { wall: x >= 0 => newton(1/2); }
        claims {
            integrable: momentum(x), momentum(y), momentum(theta);
        }
    }
}

fn main() {}
