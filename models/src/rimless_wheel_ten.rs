//! A rimless wheel of ten spokes of different lengths that rolls down a slope: a mode for each spoke that stands.
//!
//! Facts: on one spoke the wheel is a pendulum upside down; where the next one lands speed is lost, and the square of the rate is
//! mapped affinely from turn to turn, so that there is one limit cycle and every motion that goes on tends to it.
//! Source: W. Clark, thesis, section 4.3 and Table 4.2, with the angles of the triangles between feet and hub by the law of
//! cosines.

dalembert::model! {
    /// Rimless wheel with ten spokes (W. Clark, thesis, Table 4.2).
    pub RimlessWheelTen {
        const N = 10;
        /// Angle of the spoke that stands, from the vertical.
        coordinates { x; }
        parameters {
            /// Slope.
            alpha = 0.1752;
            /// Half the angle between a spoke and the next.
            delta[N] > 0 = [0.3204, 0.2411, 0.1766, 0.3762, 0.3389, 0.3622, 0.2944, 0.3648, 0.3352, 0.3316];
            /// Lengths of the spokes.
            l[N] > 0 = [1.7662, 1.4658, 1.6226, 1.5025, 1.6158, 1.8655, 1.6204, 1.9142, 1.6427, 1.8764];
            /// Acceleration of gravity.
            g > 0 = 1;
        }
        // Distance of the feet of two spokes, and the angle at the second of them.
        let s[i in 1..=N] = sqrt(l[i]^2 + l[i%N + 1]^2 - 2*l[i]*l[i%N + 1]*cos(2*delta[i]));
        let xi[i in 1..=N] = acos((l[i%N + 1]^2 + s[i]^2 - l[i]^2)/(2*l[i%N + 1]*s[i]));
        let landing(angle, half) = pi/2 - angle - 2*half - alpha;
        let pendulum(r) = r^2*dot(x)^2/2 - g*r*cos(x);
        modes {
            spoke[i in 1..=N] { lagrangian = pendulum(l[i]); }
            spoke[1] { initial { x = 0.06; dot(x) = -0.5; until = 40; } }
        }
        transitions {
            step[i in 1..=N]: spoke[i] -> spoke[i%N + 1] when x <= landing(xi[i], delta[i]) => reset {
                x = x + 2*delta[i];
                dot(x) = l[i]/l[i%N + 1]*cos(2*delta[i])*dot(x);
            };
        }
        claims { conserved: energy; }
    }
}
