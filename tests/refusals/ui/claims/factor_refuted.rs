dalembert::model! {
    pub Particle {
        coordinates { x; y; }
        parameters { c > 0 = 1/2; }
        lagrangian = (dot(x)^2 + dot(y)^2)/2;
        impacts { wall: x >= 0 => newton(1/2); floor: y >= 0 => reset { dot(y) = -2*dot(y); }; }
        claims {
            density under wall: factor = 1/4 + 1e-9;
        }
    }
}

fn main() {}
