//! Random starts at rest on surfaces, or close to rest, with random forces and gaps. Adaptive integrators agree on the
//! motion: none passes a surface, and none stops where the gap is smaller than its rounding error.

use dalembert::Outcome;
use dalembert_cli::Integrator;
use dalembert_cli::suite::Setting;
use dalembert_stability::course::{Course, End, Random};
use dalembert_stability::text::Text;
use dalembert_tests::sampling::asked;

/// Number of impacts after which a case decides nothing.
const IMPACTS: u64 = 200;

/// Largest difference of the last positions, relative to their size.
const APART: f64 = 1e-4;

/// Coordinates from which a motion runs away.
const FAR: f64 = 1e6;

struct Case {
    text: String,
    q: Vec<f64>,
    qdot: Vec<f64>,
    until: f64,
}

fn one_of<T: Copy>(random: &mut Random, choices: &[T]) -> T {
    choices[(random.bits() % choices.len() as u64) as usize]
}

/// A sum of one to three terms, some of them 0. The parameter `none` is 0, so that a sum of zeros is no error.
fn force(random: &mut Random) -> String {
    let terms = 1 + random.bits() % 3;
    let term = |_| {
        let any = random.between(-2.0, 2.0);
        let factor = one_of(random, &[0.0, 0.0, 1.0, -1.0, 0.5, -0.5, any]);
        let powers = [
            "1",
            "t",
            "t^2",
            "sin(2*t)",
            "sin(3.7*t)",
            "x",
            "dot(x)",
            "x^2",
        ];
        format!("({factor})*{}", one_of(random, &powers))
    };
    format!(
        "none + {}",
        (0..terms).map(term).collect::<Vec<_>>().join(" + ")
    )
}

fn case(random: &mut Random) -> Case {
    let law = one_of(
        random,
        &[
            "elastic",
            "newton(0)",
            "newton(0.5)",
            "newton(0.9)",
            "impact_plastic",
        ],
    );
    let weight = one_of(random, &[0.0, 1.0, 9.81]);
    let until = one_of(random, &[1.0, 3.0, 7.5]);
    if random.bits().is_multiple_of(2) {
        let gap = one_of(
            random,
            &[
                "x",
                "x - 0.3*sin(2*t)",
                "x + 0.2*x^2",
                "x - 0.1*t",
                "x + 0.1*t^2",
                "sqrt(1 + x^2 + 2*x) - 1",
            ],
        );
        let text = format!(
            "Line {{ coordinates {{ x; }} parameters {{ none = 0; }} lagrangian = dot(x)^2/2 - {weight}*x; \
             forces {{ pull: ({})*d(x); }} impacts {{ ground: {gap} >= 0 => {law}; }} }}",
            force(random)
        );
        let speed = one_of(random, &[0.0, 0.0, 0.0, 1.0, -1.0, 1e-9, -1e-9]);
        return Case {
            text,
            q: vec![0.0],
            qdot: vec![speed],
            until,
        };
    }
    let gap = one_of(
        random,
        &[
            "y",
            "y + 0.2*x",
            "y - 0.1*x^2",
            "1 - x^2 - (y - 1)^2",
            "x^2 + (y + 1)^2 - 1",
        ],
    );
    let text = format!(
        "Plane {{ coordinates {{ x; y; }} parameters {{ none = 0; }} lagrangian = (dot(x)^2 + dot(y)^2)/2 - {weight}*y; \
         forces {{ pull: ({})*d(x) + ({})*d(y); }} impacts {{ ground: {gap} >= 0 => {law}; }} }}",
        force(random),
        force(random)
    );
    let speeds = [
        one_of(random, &[0.0, 0.0, 0.5, -1.0]),
        one_of(random, &[0.0, 0.0, 0.0, 1.0]),
    ];
    Case {
        text,
        q: vec![0.0; 2],
        qdot: speeds.to_vec(),
        until,
    }
}

fn end(case: &Case, integrator: Integrator) -> End {
    let model = Text::new(case.text.clone().leak()).model();
    let course = Course::new(&model, &case.q, &case.qdot, case.until).tol(1e-12);
    let course = course.steps(20_000).impacts(IMPACTS).resting();
    course.run(Setting::free(integrator))
}

fn agree(seed: u64, cases: u64) {
    let mut random = Random::new(seed);
    let mut compared = 0;
    for number in 0..cases {
        let case = case(&mut random);
        let ends = [Integrator::Taylor, Integrator::Dop853, Integrator::Dopri5]
            .map(|integrator| (integrator.name(), end(&case, integrator)));
        let told = || {
            let lines = ends.iter().map(|(name, end)| {
                format!("{name}: {:?} at {}, q = {:?}", end.outcome, end.t, end.q)
            });
            format!(
                "case {number} of seed {seed}: {}\n{:?}, {:?} until {}\n{}",
                case.text,
                case.q,
                case.qdot,
                case.until,
                lines.collect::<Vec<_>>().join("\n")
            )
        };
        for (_, end) in &ends {
            let fails = matches!(
                end.outcome,
                Outcome::StepUnderflow { .. }
                    | Outcome::StartsInside { .. }
                    | Outcome::BeginsBehind { .. }
            );
            // Some motions run away to infinity.
            let is_near = end.q.iter().all(|q| q.abs() < FAR);
            assert!(!(fails && is_near), "{}", told());
        }
        let done: Vec<_> = ends
            .iter()
            .filter(|(_, end)| end.outcome == Outcome::Done)
            .collect();
        for pair in done.windows(2) {
            compared += 1;
            for (a, b) in pair[0].1.q.iter().zip(&pair[1].1.q) {
                assert!((a - b).abs() <= APART * (1.0 + b.abs()), "{}", told());
            }
        }
    }
    assert!(compared > cases, "{compared} comparisons of {cases} cases");
}

#[test]
fn integrators_agree_on_starts_at_rest() {
    agree(1, 100);
}

#[test]
#[ignore = "nightly: fresh cases"]
fn integrators_agree_on_many_starts_at_rest() {
    agree(asked("PROPTEST_RNG_SEED", 2), asked("RESTING_CASES", 3000));
}
