dalembert::model! {
    pub Particle {
        coordinates { x; y; theta: angle; }
        parameters { c > 0 = 1/2; }
        field { dot(x) = c*y; dot(y) = -x; dot(theta) = 1; }
        claims {
            involution: x, y;
        }
    }
}

fn main() {}
