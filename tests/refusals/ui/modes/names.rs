dalembert::model! {
    Particle {
        coordinates { x; y; theta: angle; }
        parameters { m > 0 = 1; k > 0 = 1; }
        lagrangian = m/2*(dot(x)^2 + dot(y)^2 + dot(theta)^2);
        modes { coordinate { } slow_down { } SlowDown { } Fast { } }
        transitions {
            a: coordinate -> slow_down when x >= 0;
            b: coordinate -> SlowDown when y >= 0;
            b: coordinate -> Fast when x + y >= 0;
        }
    }
}

fn main() {}
