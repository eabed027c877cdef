dalembert::model! {
    pub Particle {
        coordinates { x; y; z; }
        parameters { m > 0 = 1; k > 0 = 2; }
        lagrangian = m/2*(dot(x)^2 + dot(y)^2 + dot(z)^2) - m*k*y;
        claims {
            conserved: sqrt(dot(x) - 1 - dot(x)^2);
        }
    }
}

fn main() {}
