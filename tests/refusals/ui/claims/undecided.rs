dalembert::model! {
    pub Particle {
        coordinates { x; y; z; }
        parameters { m > 0 = 1; k > 0 = 2; }
        lagrangian = m/2*(dot(x)^2 + dot(y)^2 + dot(z)^2) - m*k*y;
        forces { vortex: -k*dot(z)*(x*dot(y) - y*dot(x))/(x^2 + y^2)*d(z); }
        claims {
            density: exact;
            density: locally_exact;
        }
    }
}

fn main() {}
