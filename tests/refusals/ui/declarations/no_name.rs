dalembert::model! {
    pub struct {
        coordinates { x; }
        parameters { m > 0 = 1; }
        lagrangian = m/2*dot(x)^2;
    }
}

fn main() {}
