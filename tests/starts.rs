//! What `check` says of starts that the declaration leaves to defaults.

use dalembert_cli::{Exit, models};
use dalembert_tests::command::{self, Finished};

dalembert::model! {
    /// A particle that may be beyond 1 only; nothing says where it starts, which is at 0.
    pub Behind {
        coordinates { x; y; }
        lagrangian = (dot(x)^2 + dot(y)^2)/2;
        impacts { wall: x >= 1; }
    }
}

dalembert::model! {
    /// The same with a wall that ends above the start.
    pub Beside {
        coordinates { x; y; }
        lagrangian = (dot(x)^2 + dot(y)^2)/2;
        impacts { wall: x >= 1 when y > 1; }
    }
}

fn checked(model: &str) -> Finished {
    command::run(models![Behind, Beside], &["check", model], "")
}

#[test]
fn a_start_behind_a_wall_is_not_admissible() {
    let Finished { exit, output, .. } = checked("behind");
    assert_eq!(exit, Exit::Other, "{output}");
    let expected = "it lies behind the surface `wall`: its gap is -1";
    assert!(output.contains(expected), "{output}");
}

#[test]
fn a_start_beside_a_wall_is_admissible() {
    let Finished { exit, output, .. } = checked("beside");
    assert_eq!(exit, Exit::Reached, "{output}");
}
