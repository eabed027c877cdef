//! The known properties of each function - parity, exact values, sign, domain - agree with its values. A new function is
//! tested here without a change.

use dalembert_expr::{Assumption, ExprId, Function, Pool, Rational, Sign};

/// Values that satisfy an assumption, ends of domains among them.
fn samples(assumption: Assumption) -> Vec<f64> {
    let all = [-2.5, -1.0, -0.75, -0.25, 0.0, 0.25, 0.75, 1.0, 2.5];
    let allowed = |x: &f64| match assumption {
        Assumption::None => true,
        Assumption::Positive => *x > 0.0,
        Assumption::NonNegative => *x >= 0.0,
        Assumption::NonZero => *x != 0.0,
    };
    all.into_iter().filter(allowed).collect()
}

/// The value of a function without any rewrite: its argument is a symbol without assumption.
fn plain(function: Function, x: f64) -> f64 {
    let mut pool = Pool::new();
    let symbol = pool.symbol("x", "x", Assumption::None);
    let argument = pool.variable(symbol);
    let call = pool.call(function, argument);
    pool.eval(&[call], &|_| x)[0]
}

fn agree(a: f64, b: f64) -> bool {
    (a - b).abs() <= 1e-14 * (1.0 + b.abs()) || !a.is_finite() && !b.is_finite()
}

fn contradicts(sign: Sign, value: f64) -> bool {
    sign.is_nonzero() && value == 0.0
        || sign.is_nonnegative() && value < 0.0
        || sign.is_nonpositive() && value > 0.0
}

/// Calls `check` with the pool, a function, its call at a multiple of a symbol, and values of the symbol and of the
/// argument. All functions, assumptions on the symbol and signs of the multiple occur.
fn for_each_call(mut check: impl FnMut(&Pool, Function, ExprId, f64, f64)) {
    for function in Function::ALL {
        for assumption in [
            Assumption::None,
            Assumption::Positive,
            Assumption::NonNegative,
            Assumption::NonZero,
        ] {
            for factor in [1, 3, -1, -3] {
                let mut pool = Pool::new();
                let symbol = pool.symbol("x", "x", assumption);
                let x = pool.variable(symbol);
                let argument = pool.scale(&Rational::from(factor), x);
                let call = pool.call(function, argument);
                for value in samples(assumption) {
                    check(&pool, function, call, value, value * factor as f64);
                }
            }
        }
    }
}

#[test]
fn rewrites_keep_the_value() {
    for_each_call(|pool, function, call, x, argument| {
        let (value, expected) = (pool.eval(&[call], &|_| x)[0], plain(function, argument));
        assert!(
            agree(value, expected),
            "{} at {argument}: {value} for {expected}",
            pool.text(call)
        );
    });
}

#[test]
fn signs_and_domains_hold_at_every_value() {
    for_each_call(|pool, function, call, x, argument| {
        let value = plain(function, argument);
        let text = pool.text(call);
        assert!(
            value.is_finite() || !pool.is_finite(call),
            "{text} at {x} is {value}"
        );
        let sign = pool.sign(call);
        assert!(
            !contradicts(sign, value),
            "{text} at {x} is {value}, known as {sign:?}"
        );
    });
}

#[test]
fn exact_values_are_the_values() {
    for function in Function::ALL {
        for units in -24..=24 {
            let mut pool = Pool::new();
            let pi = pool.pi();
            let arguments = [
                (pool.int(units), units as f64),
                (pool.number(Rational::new(units, 8)), units as f64 / 8.0),
                (
                    pool.scale(&Rational::new(units, 12), pi),
                    units as f64 / 12.0 * std::f64::consts::PI,
                ),
            ];
            for (argument, x) in arguments {
                let call = pool.call(function, argument);
                let (value, expected) = (pool.eval(&[call], &|_| 0.0)[0], plain(function, x));
                let text = pool.text(call);
                // At a pole a rounded argument gives a large number.
                let pole = expected.abs() > 1e15;
                assert!(
                    agree(value, expected) || pole,
                    "{}({x}) as {text}",
                    function.name()
                );
                assert!(!pool.is_undefined_constant(call) || !expected.is_finite() || pole);
                assert!(!pool.is_finite(call) || expected.is_finite() && !pole);
                assert!(!contradicts(pool.sign(call), value), "{text}");
            }
        }
    }
}
