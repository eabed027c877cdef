dalembert::model! {
    pub Sleigh {
        coordinates { x; y; theta: angle; }
        parameters { m > 0 = 2; I > 0 = 3; a = 3/4; }
        let slip = -sin(theta)*dot(x) + cos(theta)*dot(y);
        lagrangian = m/2*(dot(x)^2 + dot(y)^2) + (I + m*a^2)/2*dot(theta)^2 + a*m*dot(theta)*slip;
        constraints { blade: slip = 0; }
        impacts { wall: 1 - x >= 0; }
        claims {
            density: good;
        }
    }
}

fn main() {}
