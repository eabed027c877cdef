dalembert::model! {
    pub Screw {
        coordinates { phi: angle; x; z; }
        parameters { k != 0 = 1/3; b > 0 = 1; }
        let slip = dot(z) - k*z*dot(phi) - b*dot(x);
        lagrangian = (dot(phi)^2 + dot(x)^2 + slip^2)/2;
        constraints { screw: slip = 0; }
        claims {
            density: none;
        }
    }
}

fn main() {}
