//! From local to global: circles, singular configurations, conditions on parameters.

use dalembert_tests::verdict::Existence;
use dalembert_tests::verified::verified;

/// With `dx = x dy` every density is `f(C) m/|x|`, `C` the leaf: on both sides of `x = 0` alike, and on that leaf
/// `exp(-y)`, which is many-valued if `y` is an angle.
#[test]
fn densities_that_are_singular_somewhere_are_none_of_all_of_q() {
    let leaves = |y: &str| {
        format!(
            "Leaves {{ coordinates {{ x; y{y}; z; }} lagrangian = (dot(x)^2 + dot(y)^2 + dot(z)^2)/2;
                constraints {{ c: d(x) - x*d(y) = 0; }} }}"
        )
    };
    assert_eq!(verified(&leaves("")), Existence::Global);
    assert_eq!(verified(&leaves(": angle")), Existence::LocalAtLeast);
    // Everything is drawn to y = 0.
    let attracted = "Attracted { coordinates { x; y; } parameters { k > 0 = 2; }
        lagrangian = (dot(x)^2 + dot(y)^2)/2; constraints { c: dot(y) = -k*y; } }";
    assert_eq!(verified(attracted), Existence::LocalAtLeast);
    let half = "Attracted { coordinates { x; y in (0, 9); } parameters { k > 0 = 2; }
        lagrangian = (dot(x)^2 + dot(y)^2)/2; constraints { c: dot(y) = -k*y; } }";
    assert_eq!(verified(half), Existence::Global);
}

/// Where both forms of the snakeboard are the same it has no equations.
#[test]
fn circles_that_leave_the_regular_domain_leave_the_question_open() {
    let snakeboard = |phi: &str| {
        format!(
            "Snakeboard {{
                coordinates {{ x; y; theta: angle; psi: angle; phi{phi}; }}
                parameters {{ m > 0 = 2; r > 0 = 1; J > 0 = 1; Jr > 0 = 1/2; Jw > 0 = 1/3; }}
                lagrangian = m/2*(dot(x)^2 + dot(y)^2) + J/2*dot(theta)^2 + Jr/2*(dot(psi) + dot(theta))^2
                    + Jw/2*((dot(phi) + dot(theta))^2 + (dot(phi) - dot(theta))^2);
                constraints {{
                    front: -sin(theta + phi)*d(x) + cos(theta + phi)*d(y) + r*cos(phi)*d(theta) = 0;
                    back: -sin(theta - phi)*d(x) + cos(theta - phi)*d(y) - r*cos(phi)*d(theta) = 0;
                }}
            }}"
        )
    };
    assert_eq!(
        verified(&snakeboard(" in (-pi/2, pi/2)")),
        Existence::Global
    );
    assert_eq!(verified(&snakeboard(": angle")), Existence::LocalAtLeast);
}
