dalembert::model! {
    pub Particle {
        coordinates { x; y; }
        parameters { m > 0 = 1; c >= 0 = 2; }
        lagrangian = m/2*(dot(x)^2 + dot(y)^2);
        forces { drag: -c*dot(x)*d(x); volume: d(y); }
        impacts { wall: x >= 0; side[i in 1..=2]: y + i >= 0; drag: 1 - y >= 0; }
        scenes { free; side_on: side; }
        claims for fre { conserved: energy; }
        claims for side_on { conserved: dot(x); conserved: dot(x); conserved under wall: energy; }
        claims for free { conserved: x; }
    }
}

fn main() {}
