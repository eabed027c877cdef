//! The systems of `reference/verdicts_visible.json` as a user writes them, each with true claims: this file compiles
//! only if they are proved. `tests/claims/visible.rs` shows that these are the systems of the file.

use crate::numeric::Numeric;

dalembert::model! {
    /// A disk that rolls upright.
    pub VerticalDisk {
        coordinates { x; y; theta: angle; phi: angle; }
        parameters { m > 0 = 2; I > 0 = 3; J > 0 = 5/7; R > 0 = 3/2; }
        lagrangian = m/2*(dot(x)^2 + dot(y)^2) + I/2*dot(theta)^2 + J/2*dot(phi)^2;
        constraints {
            rolling_x: dot(x) = R*cos(phi)*dot(theta);
            rolling_y: dot(y) = R*sin(phi)*dot(theta);
        }
        claims {
            density: exact;
            density = 1;
            conserved: energy;
            conserved: dot(theta);
            conserved: dot(phi);
        }
    }
}

dalembert::model! {
    /// Chaplygin's sleigh with its centre of mass ahead of the blade.
    pub Sleigh {
        coordinates { x; y; theta: angle; }
        parameters { m > 0 = 2; I > 0 = 3; a = 3/4; }
        let side = -sin(theta)*dot(x) + cos(theta)*dot(y);
        lagrangian = m/2*(dot(x)^2 + dot(y)^2) + a*m*dot(theta)*side + (I + m*a^2)/2*dot(theta)^2;
        constraints { blade: side = 0; }
        claims {
            density: none;
            density = 1/abs(dot(theta));
            conserved: energy;
            not conserved: dot(theta);
        }
    }
}

dalembert::model! {
    /// A sleigh with its centre of mass above the blade.
    pub SleighBalancedKnifeEdge {
        coordinates { x; y; theta: angle; }
        parameters { m > 0 = 2; I > 0 = 3; }
        lagrangian = m/2*(dot(x)^2 + dot(y)^2) + I/2*dot(theta)^2;
        constraints { blade: -sin(theta)*dot(x) + cos(theta)*dot(y) = 0; }
        claims {
            density: exact;
            density = 1;
            conserved: energy;
            conserved: dot(theta);
        }
    }
}

dalembert::model! {
    /// A knife edge on an inclined plane.
    pub KnifeEdgeOnIncline {
        coordinates { x; y; theta: angle; }
        parameters { m > 0 = 2; I > 0 = 3; gr = 1; }
        lagrangian = m/2*(dot(x)^2 + dot(y)^2) + I/2*dot(theta)^2 + 3/5*m*gr*x;
        constraints { blade: -sin(theta)*dot(x) + cos(theta)*dot(y) = 0; }
        claims {
            density: exact;
            density = 1;
            conserved: energy;
            conserved: dot(theta);
            not conserved: dot(x)*cos(theta) + dot(y)*sin(theta);
        }
    }
}

dalembert::model! {
    /// A free particle with `dz = y dx`.
    pub NhParticle {
        coordinates { x; y; z; }
        lagrangian = (dot(x)^2 + dot(y)^2 + dot(z)^2)/2;
        constraints { slope: d(z) - y*d(x) = 0; }
        claims {
            density: exact;
            density = sqrt(1 + y^2);
            conserved: energy;
            conserved: dot(y);
            conserved: sqrt(1 + y^2)*dot(x);
        }
    }
}

dalembert::model! {
    /// A free particle with `dz = exp(y) dx`.
    pub NhParticleExp {
        coordinates { x; y; z; }
        lagrangian = (dot(x)^2 + dot(y)^2 + dot(z)^2)/2;
        constraints { slope: d(z) - exp(y)*d(x) = 0; }
        claims {
            density: exact;
            density = sqrt(1 + exp(2*y));
            conserved: energy;
            conserved: sqrt(1 + exp(2*y))*dot(x);
        }
    }
}

dalembert::model! {
    /// A free particle with `dz = (x + y) dx`: no density.
    pub NhParticleSum {
        coordinates { x; y; z; }
        lagrangian = (dot(x)^2 + dot(y)^2 + dot(z)^2)/2;
        constraints { slope: d(z) - (x + y)*d(x) = 0; }
        claims {
            density: none;
            density = sqrt(1 + (x + y)^2)/abs(dot(x) + dot(y));
            conserved: energy;
            conserved: dot(y);
        }
    }
}

dalembert::model! {
    /// Brockett's integrator with the flat metric.
    pub Heisenberg {
        coordinates { x; y; z; }
        lagrangian = (dot(x)^2 + dot(y)^2 + dot(z)^2)/2;
        constraints { contact: d(z) + y/2*d(x) - x/2*d(y) = 0; }
        claims {
            density: exact;
            density = 1;
            conserved: energy;
            symmetry: y*partial(x) - x*partial(y);
        }
    }
}

dalembert::model! {
    /// Brockett's integrator with two masses.
    pub HeisenbergAniso {
        coordinates { x; y; z; }
        parameters { m1 > 0 = 2; m2 > 0 = 3; }
        lagrangian = (m1*dot(x)^2 + m2*dot(y)^2 + dot(z)^2)/2;
        constraints { contact: d(z) + y/2*d(x) - x/2*d(y) = 0; }
        claims {
            density: exact;
            density = 1;
            conserved: energy;
        }
    }
}

dalembert::model! {
    /// Martinet's form with the flat metric.
    pub MartinetFlat {
        coordinates { x; y; z; }
        lagrangian = (dot(x)^2 + dot(y)^2 + dot(z)^2)/2;
        constraints { slope: d(z) - y^2*d(x) = 0; }
        claims {
            density: exact;
            density = sqrt(1 + y^4);
            conserved: energy;
            conserved: dot(y);
        }
    }
}

dalembert::model! {
    /// A point on an ellipsoid: an integrable form multiplied by a function.
    pub HolonomicRescaled {
        coordinates { x; y; z; }
        lagrangian = (dot(x)^2 + dot(y)^2 + dot(z)^2)/2;
        constraints { ellipsoid: exp(z)*(x*d(x) + 2*y*d(y) + 3*z*d(z)) = 0; }
        claims {
            density: exact;
            density = exp(z)*(x^2 + 4*y^2 + 9*z^2);
            conserved: energy;
            conserved: x^2 + 2*y^2 + 3*z^2;
        }
    }
}

dalembert::model! {
    /// A screw. Its density exists where `phi` runs over the line, but not on the circle.
    pub HelicalCircle {
        coordinates { phi: angle; x; z; }
        parameters { k = 1/3; b > 0 = 1; }
        let slip = dot(z) - k*z*dot(phi) - b*dot(x);
        lagrangian = (dot(phi)^2 + dot(x)^2 + slip^2)/2;
        constraints { screw: slip = 0; }
        claims {
            density: locally_exact;
            conserved: energy;
        }
    }
}

dalembert::model! {
    /// Suslov's problem with a body that is not balanced.
    pub Suslov {
        coordinates { phi: angle; theta in (0, pi); psi: angle; }
        parameters { I11 > 0 = 3; I22 > 0 = 4; I33 > 0 = 5; I12 = 1/2; I13 = 1/3; I23 = 1/4; }
        let w1 = sin(theta)*sin(psi)*dot(phi) + cos(psi)*dot(theta);
        let w2 = sin(theta)*cos(psi)*dot(phi) - sin(psi)*dot(theta);
        let w3 = cos(theta)*dot(phi) + dot(psi);
        lagrangian = (I11*w1^2 + I22*w2^2 + I33*w3^2)/2 + I12*w1*w2 + I13*w1*w3 + I23*w2*w3;
        constraints { no_spin: w3 = 0; }
        claims {
            density: none;
            density = 1/abs(I13*w1 + I23*w2);
            conserved: energy;
            conserved: (I11*w1^2 + I22*w2^2)/2 + I12*w1*w2;
        }
    }
}

dalembert::model! {
    /// Veselova's problem.
    pub Veselova {
        coordinates { phi: angle; theta in (0, pi); psi: angle; }
        parameters { I1 > 0 = 3; I2 > 0 = 4; I3 > 0 = 5; }
        let w1 = sin(theta)*sin(psi)*dot(phi) + cos(psi)*dot(theta);
        let w2 = sin(theta)*cos(psi)*dot(phi) - sin(psi)*dot(theta);
        let w3 = cos(theta)*dot(phi) + dot(psi);
        let mass = sin(theta)^2*(sin(psi)^2/I1 + cos(psi)^2/I2) + cos(theta)^2/I3;
        lagrangian = (I1*w1^2 + I2*w2^2 + I3*w3^2)/2;
        constraints { no_turn: dot(phi) + cos(theta)*dot(psi) = 0; }
        claims {
            density: exact;
            density = sqrt(mass);
            conserved: energy;
        }
    }
}

dalembert::model! {
    /// A ball with equal moments of inertia on a plane.
    pub HomogeneousBall {
        coordinates { x; y; phi: angle; theta in (0, pi); psi: angle; }
        parameters { m > 0 = 2; I > 0 = 3; r > 0 = 5/4; }
        let w_x = cos(phi)*dot(theta) + sin(phi)*sin(theta)*dot(psi);
        let w_y = sin(phi)*dot(theta) - cos(phi)*sin(theta)*dot(psi);
        let w_z = dot(phi) + cos(theta)*dot(psi);
        lagrangian = m/2*(dot(x)^2 + dot(y)^2) + I/2*(w_x^2 + w_y^2 + w_z^2);
        constraints {
            rolling_x: dot(x) - r*w_y = 0;
            rolling_y: dot(y) + r*w_x = 0;
        }
        claims {
            density: exact;
            density = 1;
            conserved: energy;
            conserved: w_x;
            conserved: w_z;
        }
    }
}

dalembert::model! {
    /// Chaplygin's sphere: a ball with three moments of inertia.
    pub ChaplyginSphere {
        coordinates { x; y; phi: angle; theta in (0, pi); psi: angle; }
        parameters { m > 0 = 2; I1 > 0 = 3; I2 > 0 = 4; I3 > 0 = 5; r > 0 = 5/4; }
        let w1 = sin(theta)*sin(psi)*dot(phi) + cos(psi)*dot(theta);
        let w2 = sin(theta)*cos(psi)*dot(phi) - sin(psi)*dot(theta);
        let w3 = cos(theta)*dot(phi) + dot(psi);
        lagrangian = m/2*(dot(x)^2 + dot(y)^2) + (I1*w1^2 + I2*w2^2 + I3*w3^2)/2;
        constraints {
            rolling_x: dot(x) - r*(sin(phi)*dot(theta) - cos(phi)*sin(theta)*dot(psi)) = 0;
            rolling_y: dot(y) + r*(cos(phi)*dot(theta) + sin(phi)*sin(theta)*dot(psi)) = 0;
        }
        claims {
            density: exact;
            conserved: energy;
        }
    }
}

dalembert::model! {
    /// A disk that rolls and falls.
    pub FallingDisk {
        coordinates { x; y; phi: angle; theta in (0, pi); psi: angle; }
        parameters { m > 0 = 2; I1 > 0 = 3; I3 > 0 = 5; R > 0 = 5/4; gr = 1; }
        let w3 = cos(theta)*dot(phi) + dot(psi);
        let height = R*sin(theta);
        lagrangian = m/2*(dot(x)^2 + dot(y)^2 + dot(height)^2) - m*gr*height
            + I1/2*(dot(theta)^2 + sin(theta)^2*dot(phi)^2) + I3/2*w3^2;
        constraints {
            rolling_x: dot(x) + R*(cos(phi)*w3 - sin(phi)*sin(theta)*dot(theta)) = 0;
            rolling_y: dot(y) + R*(sin(phi)*w3 + cos(phi)*sin(theta)*dot(theta)) = 0;
        }
        claims {
            density: exact;
            conserved: energy;
        }
    }
}

dalembert::model! {
    /// The roller racer.
    pub RollerRacer {
        coordinates { x; y; theta: angle; phi: angle; }
        parameters { m > 0 = 2; I1 > 0 = 3; I2 > 0 = 1/2; a = 1; b > 0 = 1/2; }
        lagrangian = m/2*(dot(x)^2 + dot(y)^2) + I1/2*dot(theta)^2 + I2/2*(dot(theta) + dot(phi))^2;
        constraints {
            body: -sin(theta)*dot(x) + cos(theta)*dot(y) = 0;
            handle: -sin(theta + phi)*dot(x) + cos(theta + phi)*dot(y) + (a*cos(phi) - b)*dot(theta) = b*dot(phi);
        }
        claims {
            density: none;
            density = sqrt(sin(phi)^2/m + a^2*cos(phi)^2/I1 + b^2/I2)/abs(dot(phi));
            conserved: energy;
        }
    }
}

dalembert::model! {
    /// A ball that rolls inside a vertical cylinder.
    pub BallInVerticalCylinder {
        coordinates { alpha: angle; z; phi: angle; theta in (0, pi); psi: angle; }
        parameters { m > 0 = 2; I > 0 = 3; r > 0 = 1/4; rho > 0 = 2; gr = 1; }
        let w_x = cos(phi)*dot(theta) + sin(phi)*sin(theta)*dot(psi);
        let w_y = sin(phi)*dot(theta) - cos(phi)*sin(theta)*dot(psi);
        let w_z = dot(phi) + cos(theta)*dot(psi);
        lagrangian = m/2*(rho^2*dot(alpha)^2 + dot(z)^2) + I/2*(w_x^2 + w_y^2 + w_z^2) - m*gr*z;
        constraints {
            around: rho*dot(alpha) + r*w_z = 0;
            up: dot(z) - r*(cos(alpha)*w_y - sin(alpha)*w_x) = 0;
        }
        claims {
            density: exact;
            density = 1;
            conserved: energy;
            conserved: dot(alpha);
        }
    }
}

/// Names in the file with their models, in the order of the file.
pub fn systems() -> Vec<(&'static str, Box<dyn Numeric>)> {
    macro_rules! named {
        ($($name:literal $model:ident)*) => { vec![$(($name, Box::new($model::default()) as Box<dyn Numeric>),)*] };
    }
    named! {
        "vertical_disk" VerticalDisk
        "chaplygin_sleigh" Sleigh
        "sleigh_balanced_knife_edge" SleighBalancedKnifeEdge
        "knife_edge_on_incline" KnifeEdgeOnIncline
        "nh_particle" NhParticle
        "nh_particle_exp" NhParticleExp
        "nh_particle_sum" NhParticleSum
        "heisenberg" Heisenberg
        "heisenberg_aniso" HeisenbergAniso
        "martinet_flat" MartinetFlat
        "holonomic_rescaled" HolonomicRescaled
        "helical_circle" HelicalCircle
        "suslov" Suslov
        "veselova" Veselova
        "homogeneous_ball" HomogeneousBall
        "chaplygin_sphere" ChaplyginSphere
        "falling_disk" FallingDisk
        "roller_racer" RollerRacer
        "ball_in_vertical_cylinder" BallInVerticalCylinder
    }
}
