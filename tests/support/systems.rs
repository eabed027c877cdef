//! Systems that only tests declare: affine constraints, velocity-linear terms, dependence on time, forces, integrable
//! constraints.
//!
//! If `tests/reference` has a file for a system, names, order, parameters and surfaces are those of the file.

use dalembert::Described;
use dalembert_cli::Entry;
use dalembert_stability::text::Text;

dalembert::model! {
    /// Chaplygin sleigh on a support with a cross flow: affine constraint.
    #[global]
    pub AffineSleigh {
        coordinates { x; y; theta: angle; }
        parameters { m > 0 = 1; I > 0 = 1; a = 1/5; len > 0 = 1/4; ta > 0 = 2; tb > 0 = 1; }
        let table(u, v) = 1 - u^2/ta^2 - v^2/tb^2;
        lagrangian = m/2*(dot(x)^2 + dot(y)^2) + (I + m*a^2)/2*dot(theta)^2
            + a*m*dot(theta)*(-dot(x)*sin(theta) + dot(y)*cos(theta));
        constraints { blade: -sin(theta)*d(x) + cos(theta)*d(y) + (x^2*y + sin(theta))*d(t) = 0; }
        frame { v: cos(theta)*d(x) + sin(theta)*d(y); omega: d(theta); }
        impacts {
            wall: table(x + len*cos(theta), y + len*sin(theta)) >= 0;
            wall_behind: table(x - len*cos(theta), y - len*sin(theta)) >= 0;
        }
    }
}

dalembert::model! {
    /// Ball on a rotating table with a wall at rest.
    pub TableWall {
        coordinates { x; y; phi: angle; theta in (0, pi); psi: angle; }
        parameters { r > 0 = 1; k > 0 = 2/3; Om = 1/2; ta > 0 = 3; tb > 0 = 2; }
        lagrangian = 1/2*(dot(x)^2 + dot(y)^2)
            + k^2/2*(dot(phi)^2 + 2*dot(phi)*dot(psi)*cos(theta) + dot(psi)^2 + dot(theta)^2);
        constraints {
            rolling_x: dot(x) + r*sin(theta)*cos(psi)*dot(phi) - r*sin(psi)*dot(theta) = -Om*y;
            rolling_y: dot(y) + r*sin(psi)*sin(theta)*dot(phi) + r*cos(psi)*dot(theta) = Om*x;
        }
        impacts { rim: 1 - y^2/tb^2 - x^2/ta^2 >= 0; }
    }
}

dalembert::model! {
    /// Rolling disk with a charge in a magnetic field: velocity-linear terms and a potential.
    pub MagneticDisk {
        coordinates { x; y; theta: angle; phi: angle; }
        parameters {
            m > 0 = 3/2; R > 0 = 1/4; I > 0 = 1/5; J > 0 = 1/8; b = 4/5; c = 3/10; k >= 0 = 1/2; s = 2/5;
            ta > 0 = 2; tb > 0 = 3/2;
        }
        let table(u, v) = 1 - u^2/ta^2 - v^2/tb^2;
        lagrangian = I*dot(theta)^2/2 + J*dot(phi)^2/2 + b*(x*dot(y) - dot(x)*y)/2 + c*dot(theta)*cos(phi)
            - k*(x^2 + 2*y^2)/2 + m*(dot(x)^2 + dot(y)^2)/2 - s*sin(phi);
        constraints {
            rolling_x: d(x) - R*cos(phi)*d(theta) = 0;
            rolling_y: d(y) - R*sin(phi)*d(theta) = 0;
        }
        frame { forward: cos(phi)*d(x) + sin(phi)*d(y); turn: d(phi); }
        impacts {
            leading_edge: table(x + R*cos(phi), y + R*sin(phi)) >= 0;
            trailing_edge: table(x - R*cos(phi), y - R*sin(phi)) >= 0;
        }
    }
}

dalembert::model! {
    /// Chaplygin sleigh with linear and cubic friction.
    pub DampedSleigh {
        coordinates { x; y; theta: angle; }
        parameters {
            m > 0 = 1; I > 0 = 1; a = 1/5; c >= 0 = 3/10; k >= 0 = 1/10; len > 0 = 1/4; ta > 0 = 2; tb > 0 = 1;
        }
        let table(u, v) = 1 - u^2/ta^2 - v^2/tb^2;
        lagrangian = m/2*(dot(x)^2 + dot(y)^2) + (I + m*a^2)/2*dot(theta)^2
            + a*m*dot(theta)*(-dot(x)*sin(theta) + dot(y)*cos(theta));
        constraints { blade: -sin(theta)*d(x) + cos(theta)*d(y) = 0; }
        frame { v: cos(theta)*d(x) + sin(theta)*d(y); omega: d(theta); }
        forces {
            drag: -c*(dot(x)*d(x) + dot(y)*d(y));
            spin: -k*dot(theta)*(1 + dot(theta)^2)*d(theta);
        }
        impacts { front_tip: table(x + len*cos(theta), y + len*sin(theta)) >= 0; }
    }
}

dalembert::model! {
    /// Bead on an ellipse with gravity and a spring: an integrable constraint, written as a differential.
    pub IntegrableBead {
        coordinates { x; y; }
        parameters { m > 0 = 1; g = 1; k >= 0 = 3/4; w = 7/4; }
        lagrangian = m/2*(dot(x)^2 + dot(y)^2) - m*g*y - k/2*(x - 1)^2;
        constraints { ellipse: d(x^2/4 + y^2 - 1) = 0; }
        impacts { slope: w - x - y/3 >= 0; }
    }
}

dalembert::model! {
    /// Linear terms, potential, constraint, force and wall depend on time.
    pub Rheonomic {
        coordinates { x; y; z; }
        parameters { m > 0 = 1; b = 3/10; k >= 0 = 1/2; s = 1/4; c >= 0 = 1/5; d_ = 1/10; w = 3/2; }
        lagrangian = b*t*dot(x)*z/2 + b*x*dot(y)*cos(t) - k*(x^2 + z^2)/2
            + m*(dot(x)^2 + dot(y)^2 + dot(z)^2*(x^2 + 1))/2 - s*x*sin(2*t);
        constraints { sweep: x*(-t/3 - 1)*d(x) + d(y) + sin(t)*d(t) = 0; }
        frame { xdot: d(x); slide: z*d(x) + d(z); }
        forces {
            friction: -c*dot(x)*(dot(z)^2 + 1)*d(x) + (-c*dot(y) + d_*dot(z)*sin(t))*d(y)
                + (-c*dot(z)^3 - d_*dot(x))*d(z);
        }
        impacts { wall: w - x - z^2/4 + sin(t)/5 >= 0; }
    }
}

dalembert::model! {
    /// A particle whose density has no closed form of the searched kinds. The constraint form and its dual field `d_z`
    /// have length 1, so `theta = L_{d_z} eta = -h dx - k dphi`: `G` has the derivative `-h` along
    /// `d_x + (y + z*h)*d_z` and `-k` along `d_phi + z*k*d_z`.
    pub CurvedDual {
        coordinates { x; y; z; phi: angle; }
        let h = 1/(1 + x^4);
        let k = cos(phi)/(2 + sin(phi)^3);
        let slip = dot(z) - (y + z*h)*dot(x) - z*k*dot(phi);
        lagrangian = (dot(x)^2 + dot(y)^2 + dot(phi)^2 + slip^2)/2;
        constraints { blade: slip = 0; }
        claims { density: exact; }
    }
}

dalembert::model! {
    /// A rolling ball with its centre of mass off its centre (Routh). Its density is not of a searched kind.
    #[global]
    pub RouthSphere {
        coordinates { x; y; phi: angle; theta in (0, pi); psi: angle; }
        parameters { m > 0 = 1; I > 0 = 1/2; J > 0 = 1/3; R > 0 = 1; l > 0 = 1/4; }
        let spin = dot(psi) + cos(theta)*dot(phi);
        lagrangian = m/2*((dot(x) + l*dot(sin(theta)*sin(phi)))^2
                + (dot(y) - l*dot(sin(theta)*cos(phi)))^2 + (l*sin(theta)*dot(theta))^2)
            + I/2*(dot(theta)^2 + sin(theta)^2*dot(phi)^2) + J/2*spin^2;
        constraints {
            rolling_x: dot(x) = R*(dot(theta)*sin(phi) - dot(psi)*sin(theta)*cos(phi));
            rolling_y: dot(y) = -R*(dot(theta)*cos(phi) + dot(psi)*sin(theta)*sin(phi));
        }
        claims { density: exact; }
    }
}

dalembert::model! {
    /// Same as [`CurvedDual`] without `phi`, with a pole of `h`.
    pub OnePole {
        coordinates { x; y; z; }
        let slip = dot(z) - (y + z*(1/x + 1/(1 + x^4)))*dot(x);
        lagrangian = (dot(x)^2 + dot(y)^2 + slip^2)/2;
        constraints { blade: slip = 0; }
        claims { density: exact; }
    }
}

dalembert::model! {
    /// Walker with its foot held by a multiplier (W. Clark, thesis, section 4.2, with corrected signs).
    pub WalkerWithMultiplier {
        coordinates { x_c; y_c; theta; }
        parameters { m > 0 = 1; I > 0 = 1/4; lf > 0 = 1/2; b >= 0 = 1; g = 1; alpha = 1/10; }
        lagrangian = m/2*(dot(x_c)^2 + dot(y_c)^2) + I/2*dot(theta)^2
            - g*m*(lf*cos(alpha)*cos(theta) - x_c*sin(alpha));
        constraints { foot: d(y_c) + lf*sin(theta)*d(theta) = 0; }
        forces {
            slip: -b*(dot(x_c) + lf*dot(theta)*cos(theta))*d(x_c)
                - b*lf*cos(theta)*(dot(x_c) + lf*dot(theta)*cos(theta))*d(theta);
        }
    }
}

dalembert::model! {
    /// Rolling disk that may tilt, in Euler angles.
    pub FallingDisk {
        coordinates { x; y; phi: angle; theta in (0, pi); psi: angle; }
        parameters { m > 0 = 2; R > 0 = 3/4; I > 0 = 1/3; J > 0 = 1/2; gravity > 0 = 1; }
        let roll = dot(psi) + cos(theta)*dot(phi);
        let vertical = R*cos(theta)*dot(theta);
        lagrangian = m/2*(dot(x)^2 + dot(y)^2 + vertical^2)
            + I/2*(dot(theta)^2 + sin(theta)^2*dot(phi)^2) + J/2*roll^2 - m*gravity*R*sin(theta);
        constraints {
            along: cos(phi)*dot(x) + sin(phi)*dot(y) + R*roll = 0;
            across: -sin(phi)*dot(x) + cos(phi)*dot(y) + R*sin(theta)*dot(theta) = 0;
        }
        claims { density: exact; }
    }
}

dalembert::model! {
    /// Vertical disk with two combinations of its constraints, each with entries in `d(x)`, `d(y)` and `d(theta)`.
    pub MixedDisk {
        coordinates { x; y; theta: angle; phi: angle; }
        parameters { m > 0 = 2; R > 0 = 1/2; I > 0 = 1/3; J > 0 = 1/5; }
        lagrangian = m/2*(dot(x)^2 + dot(y)^2) + I/2*dot(theta)^2 + J/2*dot(phi)^2;
        constraints {
            first: (2 + x^2)*(d(x) - R*cos(phi)*d(theta)) + y*(d(y) - R*sin(phi)*d(theta)) = 0;
            second: (1 + y^2)*(d(y) - R*sin(phi)*d(theta)) + sin(theta)*(d(x) - R*cos(phi)*d(theta)) = 0;
        }
        claims { density: exact; }
    }
}

dalembert::model! {
    /// Particle with `dz = y dx` and a stated density.
    pub NonholonomicParticle {
        coordinates { x; y; z; }
        lagrangian = (dot(x)^2 + dot(y)^2 + dot(z)^2)/2;
        constraints { slope: dot(z) = y*dot(x); }
        claims { density: exact; density = 3*sqrt(1 + y^2); }
    }
}

dalembert::model! {
    /// A density that is multiplied by `exp(-2 pi/3)` with each turn.
    pub HelicalCircle {
        coordinates { phi: angle; x; z; }
        let slip = dot(z) - dot(x) - z*dot(phi)/3;
        lagrangian = (dot(phi)^2 + dot(x)^2 + slip^2)/2;
        constraints { slipping: slip = 0; }
        claims { density: locally_exact; }
    }
}

/// The texts of all systems of this file.
pub fn texts() -> impl Iterator<Item = &'static Text> {
    macro_rules! texts {
        ($($system:ident)*) => {
            [$(Text::new($system::DESCRIPTION.source.value())),*]
        };
    }
    static TEXTS: [Text; 14] = texts! {
        AffineSleigh TableWall MagneticDisk DampedSleigh IntegrableBead Rheonomic WalkerWithMultiplier FallingDisk MixedDisk
        NonholonomicParticle HelicalCircle CurvedDual RouthSphere OnePole
    };
    TEXTS.iter()
}

/// Every system of this file, for the command line.
pub fn all() -> Vec<Entry> {
    texts().map(Text::entry).collect()
}
