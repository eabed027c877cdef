dalembert::model! {
    pub Corner {
        coordinates { x; y; }
        lagrangian = (dot(x)^2 + dot(y)^2)/2;
        impacts { walls: x*y >= 0; }
        claims {
            conserved under walls: dot(x)^2;
        }
    }
}

fn main() {}
