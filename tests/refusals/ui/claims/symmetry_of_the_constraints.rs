dalembert::model! {
    pub Particle {
        coordinates { x; y; z; }
        lagrangian = (dot(x)^2 + dot(y)^2 + dot(z)^2)/2;
        constraints { slope: d(z) - y*d(x) = 0; }
        claims {
            symmetry: partial(y);
        }
    }
}

fn main() {}
