//! Rows of the factorised metric that are written out.

use dalembert_codegen::{Compiled, compile};

fn factors(source: &str) -> Compiled {
    compile(source.parse().expect("tokens")).expect("a model")
}

#[test]
fn rows_that_elimination_simplifies_are_written_out() {
    let body = factors(
        "pub Body {
            coordinates { x; y; theta: angle; }
            parameters { m > 0 = 1; I > 0 = 1; a = 1; }
            let v_x = dot(x) - a*sin(theta)*dot(theta);
            let v_y = dot(y) + a*cos(theta)*dot(theta);
            lagrangian = m/2*(v_x^2 + v_y^2) + I/2*dot(theta)^2;
        }",
    );
    let [None, None, Some(row)] = &body.derivation.factors[..] else {
        panic!("a row of the angle: {:?}", body.derivation.factors);
    };
    let pool = &body.model.pool;
    assert_eq!(pool.text(row.pivot), "I");
    let below: Vec<String> = row.below.iter().map(|&entry| pool.text(entry)).collect();
    assert_eq!(below, ["-a*sin(theta)", "a*cos(theta)"]);
}

#[test]
fn rows_that_grow_are_factorised_numerically() {
    let pendulum = factors(
        "pub Pendulum {
            coordinates { a: angle; b: angle; }
            parameters { m > 0 = 1; M > 0 = 1; l > 0 = 1; }
            lagrangian = (m + M)*l^2/2*dot(a)^2 + m*l^2/2*dot(b)^2 + m*l^2*cos(a - b)*dot(a)*dot(b);
        }",
    );
    assert!(pendulum.derivation.factors.iter().all(Option::is_none));
}
