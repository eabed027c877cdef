dalembert::model! {
    First { coordinates { x; } lagrangian = dot(x)^2; }
    Second { coordinates { x; } lagrangian = dot(x)^2; }
}

fn main() {}
