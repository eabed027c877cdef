//! The systems of the workloads, with Lagrangians, constraints and surfaces, but without claims. The sleigh declares a
//! frame, since its constraint can be solved for neither `dot(x)` nor `dot(y)` at all angles. The generator finds the
//! frame of the disk.

dalembert::model! {
    /// A vertical disk that rolls on an elliptical table.
    pub Disk {
        coordinates { x; y; theta: angle; phi: angle; }
        parameters { m > 0 = 0.0025; R > 0 = 0.01; I > 0 = 1.25e-7; J > 0 = 6.25e-8; ta > 0 = 0.15; tb > 0 = 0.20; }
        let table(u, v) = 1 - u^2/ta^2 - v^2/tb^2;
        lagrangian = m/2*(dot(x)^2 + dot(y)^2) + I/2*dot(theta)^2 + J/2*dot(phi)^2;
        constraints {
            rolling_x: d(x) - R*cos(phi)*d(theta) = 0;
            rolling_y: d(y) - R*sin(phi)*d(theta) = 0;
        }
        impacts {
            leading_edge: table(x + R*cos(phi), y + R*sin(phi)) >= 0;
            trailing_edge: table(x - R*cos(phi), y - R*sin(phi)) >= 0;
        }
    }
}

dalembert::model! {
    /// A Chaplygin sleigh with both tips on an elliptical table.
    pub Sleigh {
        coordinates { x; y; theta: angle; }
        parameters { m > 0 = 1; I > 0 = 1; a = 0.3; len > 0 = 0.5; ta > 0 = 3; tb > 0 = 4; }
        let table(u, v) = 1 - u^2/ta^2 - v^2/tb^2;
        let slip = -dot(x)*sin(theta) + dot(y)*cos(theta);
        lagrangian = m/2*(dot(x)^2 + dot(y)^2) + (I + m*a^2)/2*dot(theta)^2 + a*m*dot(theta)*slip;
        constraints { blade: -sin(theta)*d(x) + cos(theta)*d(y) = 0; }
        frame { v: cos(theta)*d(x) + sin(theta)*d(y); omega: d(theta); }
        impacts {
            front_tip: table(x + len*cos(theta), y + len*sin(theta)) >= 0;
            back_tip: table(x - len*cos(theta), y - len*sin(theta)) >= 0;
        }
        scenes {
            /// No table.
            free;
        }
    }
}

dalembert::model! {
    /// A planar double pendulum, absolute angles from the downward vertical.
    pub Pendulum {
        coordinates { theta1: angle; theta2: angle; }
        parameters { m1 > 0 = 1; m2 > 0 = 1; l1 > 0 = 1; l2 > 0 = 1; g = 9.81; }
        let x1 = l1*sin(theta1);
        let y1 = -l1*cos(theta1);
        let x2 = x1 + l2*sin(theta2);
        let y2 = y1 - l2*cos(theta2);
        lagrangian = m1/2*(dot(x1)^2 + dot(y1)^2) + m2/2*(dot(x2)^2 + dot(y2)^2) - m1*g*y1 - m2*g*y2;
    }
}

dalembert::model! {
    /// A ball that keeps nine tenths of its speed at each bounce.
    pub Ball {
        coordinates { x; }
        parameters { m > 0 = 1; g > 0 = 9.81; e in [0, 1] = 0.9; }
        lagrangian = m/2*dot(x)^2 - m*g*x;
        impacts { floor: x >= 0 => restitution(e); }
    }
}
