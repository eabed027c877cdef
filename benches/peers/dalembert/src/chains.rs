//! The chain of N unit masses on unit rods, declared twice: by the angles of its rods, and by the positions of its
//! masses with the rods as constraints.

/// Declares the chain of this number of links by angles.
macro_rules! by_angles {
    ($angles:ident, $links:literal) => {
        dalembert::model! {
            /// Chain in absolute angles from the downward vertical.
            pub $angles {
                const N = $links;
                coordinates { theta[N]: angle; }
                parameters { g = 9.81; }
                let X[0] = 0;
                let X[i in 1..=N] = X[i-1] + sin(theta[i]);
                let Y[0] = 0;
                let Y[i in 1..=N] = Y[i-1] - cos(theta[i]);
                lagrangian = sum(i in 1..=N: 1/2*(dot(X[i])^2 + dot(Y[i])^2) - g*Y[i]);
            }
        }
    };
}

/// Declares the chain of this number of links by the positions of its masses.
macro_rules! by_rods {
    ($rods:ident, $links:literal) => {
        dalembert::model! {
            /// Chain in the positions of its masses.
            pub $rods {
                const N = $links;
                coordinates { x[N]; y[N]; }
                parameters { g = 9.81; }
                lagrangian = sum(i in 1..=N: 1/2*(dot(x[i])^2 + dot(y[i])^2) - g*y[i]);
                let X[0] = 0;
                let X[i in 1..=N] = x[i];
                let Y[0] = 0;
                let Y[i in 1..=N] = y[i];
                constraints {
                    rod[i in 1..=N]: (X[i] - X[i-1])*(d(X[i]) - d(X[i-1])) + (Y[i] - Y[i-1])*(d(Y[i]) - d(Y[i-1])) = 0;
                }
            }
        }
    };
}

by_angles!(Angles2, 2);
by_angles!(Angles4, 4);
by_angles!(Angles8, 8);
by_angles!(Angles16, 16);
by_angles!(Angles32, 32);

by_rods!(Rods2, 2);
by_rods!(Rods4, 4);
by_rods!(Rods8, 8);
by_rods!(Rods16, 16);
by_rods!(Rods32, 32);
