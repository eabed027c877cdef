//! A skate on an incline with a wall at its foot, and the dalembert command line for it.

use std::process::ExitCode;

dalembert::model! {
    /// Skate on an incline that ends at a wall.
    pub InclinedSkate {
        coordinates { x; y; theta: angle; }
        parameters { m > 0 = 1; I > 0 = 0.1; g > 0 = 9.81; slope = 0.1; foot > 0 = 2; e in [0, 1] = 0.5; }
        lagrangian = m/2*(dot(x)^2 + dot(y)^2) + I/2*dot(theta)^2 + m*g*sin(slope)*x;
        constraints { edge: sin(theta)*d(x) - cos(theta)*d(y) = 0; }
        impacts { wall: foot - x >= 0 => restitution(e); }
        initial { theta = 0.2; dot(theta) = 0.1; until = 10; }
        view { path: (x, y); }
        outputs { edge_force: multiplier(edge); }
    }
}

fn main() -> ExitCode {
    dalembert_cli::run(dalembert_cli::models![InclinedSkate])
}
