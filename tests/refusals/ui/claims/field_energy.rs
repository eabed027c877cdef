dalembert::model! {
    pub Flow {
        coordinates { x; y; }
        field { dot(x) = y; dot(y) = -x; }
        impacts { wall: x >= 0 => reset { y = -y; }; }
        claims {
            energy under wall: not increasing;
        }
    }
}

fn main() {}
