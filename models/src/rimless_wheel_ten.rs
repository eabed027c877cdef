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
            spoke1 { lagrangian = pendulum(l[1]); initial { x = 0.06; dot(x) = -0.5; until = 40; } }
            spoke2 { lagrangian = pendulum(l[2]); }
            spoke3 { lagrangian = pendulum(l[3]); }
            spoke4 { lagrangian = pendulum(l[4]); }
            spoke5 { lagrangian = pendulum(l[5]); }
            spoke6 { lagrangian = pendulum(l[6]); }
            spoke7 { lagrangian = pendulum(l[7]); }
            spoke8 { lagrangian = pendulum(l[8]); }
            spoke9 { lagrangian = pendulum(l[9]); }
            spoke10 { lagrangian = pendulum(l[10]); }
        }
        transitions {
            step1: spoke1 -> spoke2 when x <= landing(xi[1], delta[1]) => reset {
                x = x + 2*delta[1];
                dot(x) = l[1]/l[2]*cos(2*delta[1])*dot(x);
            };
            step2: spoke2 -> spoke3 when x <= landing(xi[2], delta[2]) => reset {
                x = x + 2*delta[2];
                dot(x) = l[2]/l[3]*cos(2*delta[2])*dot(x);
            };
            step3: spoke3 -> spoke4 when x <= landing(xi[3], delta[3]) => reset {
                x = x + 2*delta[3];
                dot(x) = l[3]/l[4]*cos(2*delta[3])*dot(x);
            };
            step4: spoke4 -> spoke5 when x <= landing(xi[4], delta[4]) => reset {
                x = x + 2*delta[4];
                dot(x) = l[4]/l[5]*cos(2*delta[4])*dot(x);
            };
            step5: spoke5 -> spoke6 when x <= landing(xi[5], delta[5]) => reset {
                x = x + 2*delta[5];
                dot(x) = l[5]/l[6]*cos(2*delta[5])*dot(x);
            };
            step6: spoke6 -> spoke7 when x <= landing(xi[6], delta[6]) => reset {
                x = x + 2*delta[6];
                dot(x) = l[6]/l[7]*cos(2*delta[6])*dot(x);
            };
            step7: spoke7 -> spoke8 when x <= landing(xi[7], delta[7]) => reset {
                x = x + 2*delta[7];
                dot(x) = l[7]/l[8]*cos(2*delta[7])*dot(x);
            };
            step8: spoke8 -> spoke9 when x <= landing(xi[8], delta[8]) => reset {
                x = x + 2*delta[8];
                dot(x) = l[8]/l[9]*cos(2*delta[8])*dot(x);
            };
            step9: spoke9 -> spoke10 when x <= landing(xi[9], delta[9]) => reset {
                x = x + 2*delta[9];
                dot(x) = l[9]/l[10]*cos(2*delta[9])*dot(x);
            };
            step10: spoke10 -> spoke1 when x <= landing(xi[10], delta[10]) => reset {
                x = x + 2*delta[10];
                dot(x) = l[10]/l[1]*cos(2*delta[10])*dot(x);
            };
        }
        claims { conserved: energy; }
    }
}
