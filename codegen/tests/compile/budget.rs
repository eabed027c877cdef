//! The algebra of a model has a budget of steps.

use dalembert_codegen::{compile_spec, spec};

const DECLARATION: &str = "
    P {
        coordinates { x; y; z; theta: angle; }
        parameters { m > 0 = 1; k >= 0 = 2; e in [0, 1] = 1/2; }
        let r(u, v) = sqrt(1 + u^2 + sin(v)^2);
        lagrangian = m/2*(dot(x*y)^2 + dot(x)^2 + dot(y)^2 + dot(z)^2) + dot(r(x, theta))^2 + dot(theta)^2
            - k*r(x, y);
        constraints { slip: d(z) = x*d(y); hold: d(x + sin(theta)) = 0; }
        forces { drag: -k*dot(y)*d(y); }
        impacts { wall: y + r(z, z) >= 0 => newton(e); }
        outputs { o: multiplier(slip) + energy; }
        claims { density: none; }
    }";

/// Wherever the algebra is given up, the current stage ends and reports that.
#[test]
fn algebra_may_be_given_up_anywhere() {
    let compile = |steps| {
        let tokens = DECLARATION.parse().expect("tokens");
        spec::parse(tokens).and_then(|spec| compile_spec(&spec, steps))
    };
    let (mut given_up, mut steps) = (0, 1);
    while let Err(errors) = compile(steps) {
        let texts: Vec<&str> = errors.iter().map(|error| error.message()).collect();
        assert!(
            texts[0].contains("steps; it was given up here"),
            "{texts:?}"
        );
        given_up += 1;
        steps += 1 + steps / 16;
    }
    assert!(given_up > 50, "only {given_up} budgets were too small");
}
