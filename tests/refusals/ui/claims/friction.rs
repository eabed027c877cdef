dalembert::model! {
    pub Dragged {
        coordinates { x; y; z; }
        parameters { c = 1/2; }
        lagrangian = (dot(x)^2 + dot(y)^2 + dot(z)^2)/2;
        constraints { slope: d(z) - y*d(x) = 0; }
        forces { drag: -c*dot(y)*d(y); }
        claims {
            density: exact;
        }
    }
}

fn main() {}
