//! Compares the interpreted program of a random declaration with dense linear algebra and finite differences.

use dalembert::math::larger;
use dalembert_codegen::Compiled;
use dalembert_codegen::program::{Function, Input, Program, interpret::interpret, verify::verify};
use dalembert_tests::numeric::{moved, slope, slopes};
use proptest::prelude::*;

use super::blows::check_blows;
use super::config;
use super::declaration::Declaration;
use super::dense::{Dense, Evaluated, Point, dot, times, unit};

/// Numbers in (-1, 1) with few digits. They are farther from 0, where `abs` has a kink, than the steps of differences.
fn numbers(n: usize) -> impl Strategy<Value = Vec<f64>> {
    let number = prop_oneof![64_i32..1024, -1023_i32..=-64];
    prop::collection::vec(number.prop_map(|k| f64::from(k) / 1024.0), n)
}

/// A declaration with a point.
fn sample(most: usize) -> impl Strategy<Value = (Declaration, Point, Vec<f64>)> {
    Declaration::any(most).prop_flat_map(|declaration| {
        let n = declaration.dimension();
        (
            Just(declaration),
            numbers(1),
            numbers(n),
            numbers(n),
            numbers(n),
        )
            .prop_map(|(declaration, t, q, qdot, excess)| {
                let point = Point { t: t[0], q, qdot };
                (declaration, point, excess)
            })
    })
}

/// Compiles a random declaration. A declaration without content, which the generator refuses with one of these
/// messages, is rejected as a sample. Any other refusal is an error of the generator.
pub fn compiled(declaration: &Declaration) -> Result<Compiled, TestCaseError> {
    const SAYS_NOTHING: [&str; 2] = ["this force is zero", "same surface as"];
    let source = declaration.named("Random");
    let tokens = source.parse().expect("tokens");
    dalembert_codegen::compile(tokens).map_err(|refused| {
        let messages: Vec<&str> = refused.iter().map(|error| error.message()).collect();
        let is_empty = |text: &&str| SAYS_NOTHING.iter().any(|known| text.contains(known));
        match messages.iter().all(is_empty) {
            true => TestCaseError::reject("a declaration that says nothing"),
            false => TestCaseError::fail(format!("{messages:?}")),
        }
    })
}

/// Quantities at a point for comparison, with the allowed error.
pub struct Comparison<'a> {
    pub compiled: &'a Compiled,
    dense: Dense<'a>,
    at: Point,
    evaluated: Evaluated,
    excess: Vec<f64>,
    /// Quasi-velocities, for functions of a reduced form.
    quasi: Vec<f64>,
    /// Rates of the velocities or momenta in the state, or an impulse on them.
    motion: Vec<f64>,
    /// Allowed rounding error, relative to the compared numbers.
    pub tolerance: f64,
}

impl<'a> Comparison<'a> {
    fn new(compiled: &'a Compiled, at: Point, excess: Vec<f64>) -> Self {
        let dense = Dense::new(compiled);
        let evaluated = dense.evaluate(&at);
        let tolerance = 64.0 * f64::EPSILON * evaluated.condition();
        Self {
            compiled,
            dense,
            at,
            evaluated,
            excess,
            quasi: Vec::new(),
            motion: Vec::new(),
            tolerance,
        }
    }

    pub fn run(&self, function: &Function) -> Vec<f64> {
        let input = |input| match input {
            Input::Time => self.at.t,
            Input::Coordinate(i) => self.at.q[i],
            Input::Velocity(i) => self.at.qdot[i],
            Input::Momentum(i) => self.evaluated.p[i],
            Input::Parameter(k) => self.dense.parameters[k],
            Input::Excess(k) => self.excess[k],
            Input::Quasi(i) => self.quasi[i],
            Input::MotionRate(i) => self.motion[i],
            Input::Multiplier(a) => self.evaluated.motion().1[a],
        };
        interpret(function, &input).expect("a value")
    }

    /// Compares vectors up to rounding.
    fn same(&self, what: &str, actual: &[f64], expected: &[f64]) -> Result<(), TestCaseError> {
        same_within(what, actual, expected, self.tolerance)
    }

    /// The group of this name in the output of `eval`.
    fn group(&self, values: &[f64], name: &str) -> Vec<f64> {
        let mut start = 0;
        for group in &self.compiled.programs.global().geometry.groups {
            let end = start + group.shape.count();
            if group.name == name {
                return values[start..end].to_vec();
            }
            start = end;
        }
        panic!("no `{name}`")
    }
}

/// Compares vectors; `tolerance` is relative to their largest number, at least 1.
pub fn same_within(
    what: &str,
    actual: &[f64],
    expected: &[f64],
    tolerance: f64,
) -> Result<(), TestCaseError> {
    prop_assert_eq!(actual.len(), expected.len(), "{}", what);
    let size = expected
        .iter()
        .fold(1.0_f64, |size, value| larger(size, value.abs()));
    for (a, e) in actual.iter().zip(expected) {
        prop_assert!(
            (a - e).abs() <= tolerance * size,
            "{what}: {actual:?}, expected {expected:?}, tolerance {tolerance:e}"
        );
    }
    Ok(())
}

/// Compares velocities, rates, multipliers and energy.
fn check_motion(comparison: &Comparison<'_>) -> Result<(), TestCaseError> {
    let values = comparison.run(&comparison.compiled.programs.global().geometry.function);
    let group = |name| comparison.group(&values, name);
    let (acceleration, multipliers) = comparison.evaluated.motion();
    let rate = [
        comparison.at.qdot.clone(),
        comparison.evaluated.momentum_rate(),
    ]
    .concat();
    comparison.same("qdot", &group("qdot"), &comparison.at.qdot)?;
    comparison.same(
        "pdot",
        &group("pdot"),
        &comparison.evaluated.momentum_rate(),
    )?;
    comparison.same("acceleration", &group("acceleration"), &acceleration)?;
    comparison.same("multipliers", &group("multipliers"), &multipliers)?;
    comparison.same("energy", &group("energy"), &[comparison.evaluated.energy])?;
    comparison.same(
        "metric",
        &group("metric"),
        &comparison.evaluated.metric.concat(),
    )?;
    let program = comparison.compiled.programs.global();
    let mut parts = comparison.run(&program.force);
    if let Some(constrained) = &program.constrained {
        let reaction = comparison.run(&constrained.reaction_force);
        parts.iter_mut().zip(reaction).for_each(|(f, r)| *f += r);
    }
    comparison.same("force", &parts, &comparison.evaluated.momentum_rate())?;
    comparison.same("rate", &comparison.run(&program.rate), &rate)?;
    comparison.same(
        "velocity",
        &comparison.run(&program.velocity),
        &comparison.at.qdot,
    )?;
    comparison.same(
        "momentum",
        &comparison.run(&program.momentum),
        &comparison.evaluated.p,
    )
}

/// Compares the geometry of the constraints and the projections onto them.
fn check_constraints(comparison: &Comparison<'_>) -> Result<(), TestCaseError> {
    let Some(program) = &comparison.compiled.programs.global().constrained else {
        return Ok(());
    };
    let evaluated = &comparison.evaluated;
    let values = comparison.run(&comparison.compiled.programs.global().geometry.function);
    let group = |name| comparison.group(&values, name);
    let n = comparison.at.q.len();
    let fields: Vec<_> = evaluated
        .forms
        .iter()
        .map(|form| evaluated.raised(form))
        .collect();
    let mass: Vec<_> = evaluated
        .forms
        .iter()
        .map(|form| times(&fields, form))
        .collect();
    let columns: Vec<_> = (0..n).map(|j| evaluated.project(&unit(n, j))).collect();
    let projector: Vec<f64> = (0..n)
        .flat_map(|i| columns.iter().map(move |column| column[i]))
        .collect();
    comparison.same("W", &group("W"), &fields.concat())?;
    comparison.same("constraint_mass", &group("constraint_mass"), &mass.concat())?;
    comparison.same("pi_D", &group("pi_D"), &projector)?;
    comparison.same(
        "multipliers",
        &comparison.run(&program.multipliers),
        &evaluated.motion().1,
    )?;
    let projected = times(&evaluated.metric, &evaluated.projected(&comparison.at.qdot));
    let projected = moved(&projected, 1.0, &evaluated.linear);
    let back = program
        .return_to_constraints
        .as_ref()
        .expect("a global form");
    comparison.same("project", &comparison.run(&back.nearest), &projected)?;
    check_restored(comparison, &comparison.run(&back.restore))?;
    check_levels(comparison, &comparison.run(&program.level_correction))
}

/// Compares functions of the reduced form at the nearest allowed velocity, if there is a frame.
fn check_reduced(comparison: &Comparison<'_>) -> Result<(), TestCaseError> {
    let Ok(frame) = &comparison.compiled.derivation.frame else {
        return Ok(());
    };
    let mut at = comparison.at.clone();
    at.qdot = comparison.evaluated.projected(&comparison.at.qdot);
    let mut on = Comparison::new(comparison.compiled, at, comparison.excess.clone());
    let forms = frame
        .quasi
        .iter()
        .map(|quasi| on.dense.values(&quasi.form, &on.at));
    let forms: Vec<Vec<f64>> = forms.collect();
    on.quasi = times(&forms, &on.at.qdot);
    let curvature: Vec<_> = frame.quasi.iter().map(|quasi| quasi.curvature).collect();
    let curvature = on.dense.values(&curvature, &on.at);
    let (acceleration, multipliers) = on.evaluated.motion();
    let rate = moved(&times(&forms, &acceleration), 1.0, &curvature);
    check_surfaces(&mut on, &acceleration, rate.clone())?;
    let program = &comparison.compiled.programs.main;
    let reduced = program.reduced.as_ref().expect("a reduced form");
    on.same("reduced velocity", &on.run(&program.velocity), &on.at.qdot)?;
    on.same(
        "reduced rate",
        &on.run(&program.rate),
        &[on.at.qdot.clone(), rate].concat(),
    )?;
    on.same(
        "reduced energy",
        &on.run(&program.energy),
        &[on.evaluated.energy],
    )?;
    on.same(
        "reduced momentum",
        &on.run(&reduced.momentum),
        &on.evaluated.p,
    )?;
    on.same("quasi-velocities", &on.run(&reduced.quasi), &on.quasi)?;
    for program in [&on.compiled.programs.main, on.compiled.programs.global()] {
        check_blows(&on, program)?;
    }
    comparison.same(
        "nearest",
        &comparison.run(&reduced.nearest_velocities),
        &on.quasi,
    )?;
    comparison.same(
        "nearest",
        &comparison.run(&reduced.nearest_momenta),
        &on.quasi,
    )?;
    match &program.constrained {
        Some(program) => on.same("multipliers", &on.run(&program.multipliers), &multipliers),
        None => Ok(()),
    }
}

/// Compares, in both forms, second rates of gaps with differences along the motion, and compliances with responses.
fn check_surfaces(
    on: &mut Comparison<'_>,
    acceleration: &[f64],
    rate: Vec<f64>,
) -> Result<(), TestCaseError> {
    let programs = &on.compiled.programs;
    let surfaces = on.compiled.derivation.surfaces.iter();
    let gap_rates: Vec<_> = surfaces.map(|surface| surface.gap_rate).collect();
    let expected = slopes(&|h| {
        let mut carried = on.at.shifted(h, &on.at.qdot, 1.0);
        carried.qdot = moved(&on.at.qdot, h, acceleration);
        on.dense.values(&gap_rates, &carried)
    });
    let rates = [rate, on.evaluated.momentum_rate()];
    for (program, rate) in [&programs.main, programs.global()].into_iter().zip(rates) {
        let Some(functions) = &program.impacting else {
            continue;
        };
        on.motion = rate;
        let accelerations = on.run(&functions.gap_accelerations);
        same_within("gap acceleration", &accelerations, &expected, 1e-7)?;
        for (s, contact) in functions.contacts.iter().enumerate() {
            let contact = on.run(contact);
            let (scalars, direction) = contact.split_at(5);
            on.motion = direction.to_vec();
            let responses = on.run(&functions.gap_responses);
            on.same("compliance", &responses[s..=s], &scalars[3..4])?;
        }
    }
    Ok(())
}

/// Checks that restored momenta belong to velocities on the constraints.
fn check_restored(comparison: &Comparison<'_>, p: &[f64]) -> Result<(), TestCaseError> {
    let evaluated = &comparison.evaluated;
    let qdot = evaluated.raised(&moved(p, -1.0, &evaluated.linear));
    let residuals = moved(&times(&evaluated.forms, &qdot), 1.0, &evaluated.affine);
    comparison.same("restore", &residuals, &vec![0.0; residuals.len()])
}

/// Checks that the correction of positions is the smallest one in the metric that removes the excess of the levels to
/// first order.
fn check_levels(comparison: &Comparison<'_>, correction: &[f64]) -> Result<(), TestCaseError> {
    let evaluated = &comparison.evaluated;
    let levelled: Vec<usize> = comparison.compiled.derivation.levelled().collect();
    let forms: Vec<Vec<f64>> = levelled
        .iter()
        .map(|&a| evaluated.forms[a].clone())
        .collect();
    let excess: Vec<f64> = comparison
        .excess
        .iter()
        .take(forms.len())
        .map(|level| -level)
        .collect();
    comparison.same("level correction", &times(&forms, correction), &excess)?;
    let covector = times(&evaluated.metric, correction);
    let fields: Vec<_> = forms.iter().map(|form| evaluated.raised(form)).collect();
    let mass: Vec<_> = forms.iter().map(|form| times(&fields, form)).collect();
    let weights = dalembert_tests::linear::solve(&mass, &excess);
    let combined = weights
        .iter()
        .zip(&forms)
        .fold(vec![0.0; covector.len()], |sum, (weight, form)| {
            moved(&sum, *weight, form)
        });
    comparison.same("level correction", &covector, &combined)
}

/// Compares gaps and contacts with differences of the gaps and with dense algebra.
fn check_contacts(comparison: &Comparison<'_>) -> Result<(), TestCaseError> {
    let Some(program) = &comparison.compiled.programs.global().impacting else {
        return Ok(());
    };
    let gap = |s: usize, at: &Point| {
        comparison
            .dense
            .value(comparison.compiled.model.surfaces[s].gap, at)
    };
    for (s, contact) in program.contacts.iter().enumerate() {
        let n = comparison.at.q.len();
        let along = |direction: &[f64], dt: f64| {
            slope(&mut |h| gap(s, &comparison.at.shifted(h, direction, dt)))
        };
        let form: Vec<f64> = (0..n).map(|i| along(&unit(n, i), 0.0)).collect();
        let gradient = comparison.evaluated.raised(&form);
        let allowed = comparison.evaluated.project(&gradient);
        let direction = times(&comparison.evaluated.metric, &allowed);
        let expected = [
            along(&comparison.at.qdot, 1.0),
            dot(&direction, &comparison.at.qdot),
            along(&vec![0.0; n], 1.0),
            dot(&form, &allowed),
            dot(&form, &gradient),
        ];
        let expected = [expected.to_vec(), direction].concat();
        let tolerance = comparison.tolerance.max(1e-8);
        same_within("contact", &comparison.run(contact), &expected, tolerance)?;
        let expected = gap(s, &comparison.at);
        comparison.same("gap", &comparison.run(&program.gaps)[s..=s], &[expected])?;
    }
    Ok(())
}

/// Compares derivatives in the derivation with differences of the declared expressions.
fn check_derivatives(comparison: &Comparison<'_>) -> Result<(), TestCaseError> {
    let (model, derivation) = (&comparison.compiled.model, &comparison.compiled.derivation);
    let n = comparison.at.q.len();
    let close =
        |what: &str, actual: &[f64], expected: &[f64]| same_within(what, actual, expected, 1e-8);
    let lagrangian = |at: &Point| comparison.dense.value(model.lagrangian.whole, at);
    let applied: Vec<f64> = (0..n)
        .map(|k| {
            model
                .forces
                .iter()
                .map(|force| comparison.dense.value(force.form[k], &comparison.at))
                .sum()
        })
        .collect();
    let force =
        (0..n).map(|k| slope(&mut |h| lagrangian(&comparison.at.shifted(h, &unit(n, k), 0.0))));
    let force: Vec<f64> = force.collect();
    close(
        "force",
        &comparison.evaluated.force,
        &moved(&force, 1.0, &applied),
    )?;
    let momentum = (0..n).map(|k| slope(&mut |h| lagrangian(&comparison.at.kicked(h, k))));
    close(
        "momentum",
        &comparison.evaluated.p,
        &momentum.collect::<Vec<f64>>(),
    )?;
    let carried = |h| {
        comparison
            .dense
            .evaluate(&comparison.at.shifted(h, &comparison.at.qdot, 1.0))
    };
    let drift = comparison
        .dense
        .values(&derivation.field.drift, &comparison.at);
    close("drift", &drift, &slopes(&|h| carried(h).p))?;
    let residuals = |h| {
        let carried = carried(h);
        moved(
            &times(&carried.forms, &comparison.at.qdot),
            1.0,
            &carried.affine,
        )
    };
    let curvature: Vec<_> = derivation
        .constraints
        .iter()
        .map(|constraint| constraint.curvature)
        .collect();
    close(
        "curvature",
        &comparison.dense.values(&curvature, &comparison.at),
        &slopes(&residuals),
    )
}

/// Compares the divergence of the field on T*Q with differences.
fn check_divergence(comparison: &Comparison<'_>) -> Result<(), TestCaseError> {
    let (q, p) = (&comparison.at.q, &comparison.evaluated.p);
    let n = q.len();
    let divergence: f64 = (0..n)
        .map(|i| {
            let unit = unit(n, i);
            let by_q = slope(&mut |h| {
                comparison
                    .dense
                    .rate(comparison.at.t, &moved(q, h, &unit), p)[i]
            });
            let by_p = slope(&mut |h| {
                comparison
                    .dense
                    .rate(comparison.at.t, q, &moved(p, h, &unit))[n + i]
            });
            by_q + by_p
        })
        .sum();
    let rate = comparison.dense.rate(comparison.at.t, q, p);
    let size = rate
        .iter()
        .fold(1.0_f64, |size, rate| larger(size, rate.abs()));
    let density = comparison.compiled.programs.global().density.as_ref();
    let actual = comparison.run(&density.expect("of a whole model").divergence);
    same_within(
        "divergence",
        &actual,
        &[divergence],
        1e-7 * size * (1.0 + comparison.tolerance * 1e10),
    )
}

fn check(declaration: &Declaration, at: Point, excess: Vec<f64>) -> Result<(), TestCaseError> {
    let compiled = compiled(declaration)?;
    let programs = &compiled.programs;
    for function in [&programs.main, programs.global()]
        .map(Program::functions)
        .concat()
    {
        prop_assert_eq!(verify(function), Ok(()));
    }
    let comparison = Comparison::new(&compiled, at, excess);
    check_motion(&comparison)?;
    check_constraints(&comparison)?;
    check_reduced(&comparison)?;
    check_contacts(&comparison)?;
    if compiled.derivation.constraints.is_empty() {
        check_blows(&comparison, programs.global())?;
    }
    check_derivatives(&comparison)?;
    check_divergence(&comparison)
}

proptest! {
    #![proptest_config(config(400))]

    #[test]
    fn programs_do_what_dense_algebra_does((declaration, at, excess) in sample(4)) {
        check(&declaration, at, excess)?;
    }
}

proptest! {
    #![proptest_config(config(2000))]

    #[test]
    #[ignore = "nightly: many larger declarations"]
    fn larger_programs_do_what_dense_algebra_does((declaration, at, excess) in sample(7)) {
        check(&declaration, at, excess)?;
    }
}
