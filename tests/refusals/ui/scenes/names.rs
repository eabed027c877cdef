dalembert::model! {
    pub Particle {
        coordinates { x; y; }
        parameters { m > 0 = 1; c >= 0 = 2; }
        lagrangian = m/2*(dot(x)^2 + dot(y)^2);
        forces { drag: -c*dot(x)*d(x); volume: d(y); }
        impacts { wall: x >= 0; side[i in 1..=2]: y + i >= 0; drag: 1 - y >= 0; }
        scenes {
            all;
            Free;
            surface;
            _1;
            slow;
            slow: wall;
            slow_global;
        }
    }
}

fn main() {}
