//! Random starts of every shipped model with surfaces: all integrators meet the same surfaces in the same order.
//!
//! Two runs at the tolerance 1e-13 by different methods are the reference as far as they agree. Up to there no error
//! has grown, even in chaotic motion. A run by another integrator is compared with the reference until its error
//! reaches [`LOST`], or until a graze is flagged. Certified impacts bound the times of the reference.

mod runs;
mod starts;

use dalembert::Outcome;
use dalembert::math::larger;
use dalembert_driver::{Form, Integrator};
use dalembert_tests::parallel;
use dalembert_tests::sampling::{Random, asked};

use runs::{Course, IMPACTS, Way, apart, certified, error, run, state_at};
use starts::{Case, Shipped};

/// Largest difference between two reference runs that agree.
const AGREED: f64 = 1e-7;

/// Error of a run beyond which its impacts are not compared.
const LOST: f64 = 1e-4;

/// The reference of a start.
struct Reference {
    course: Course,
    /// Number of first impacts on which both runs agree.
    sure: usize,
}

/// Mistakes of all runs, and numbers of comparisons.
#[derive(Debug, Default)]
struct Tally {
    starts: u64,
    runs: u64,
    impacts: u64,
    certified: u64,
    wrong: Vec<String>,
}

impl Tally {
    fn add(&mut self, other: Self) {
        self.starts += other.starts;
        self.runs += other.runs;
        self.impacts += other.impacts;
        self.certified += other.certified;
        self.wrong.extend(other.wrong);
    }
}

/// Integrators of the reference runs.
fn references() -> [Way; 2] {
    [Integrator::Taylor, Integrator::Dop853].map(|integrator| Way {
        integrator,
        form: Form::Reduced,
        tol: 1e-13,
    })
}

/// The reference of a start; `None` if the start is refused.
fn reference(case: &Case, tally: &mut Tally) -> Option<Reference> {
    let [first, second] = references();
    let course = run(case, first, case.until)?;
    if course.ending.t == 0.0 && !course.ending.reached {
        return None;
    }
    let other = run(case, second, case.until)?;
    let mut sure = 0;
    for (a, b) in course.impacts.iter().zip(&other.impacts) {
        let is_same = a.surface == b.surface && a.graze == b.graze;
        if !is_same || error(a, b, case.until) > AGREED {
            break;
        }
        sure += 1;
    }
    let is_decided = sure < course.impacts.len() && sure < other.impacts.len();
    let next = [&course, &other].map(|course| {
        course
            .impacts
            .get(sure)
            .map(|hit| (hit.t, hit.surface, hit.graze))
    });
    let kinds = [&course, &other].map(|measured| measured.ending.outcome.kind());
    // The agreement ends by an error that has grown, by a graze, or by a mistake.
    let before = sure.checked_sub(1).map_or(0.0, |k| {
        error(&course.impacts[k], &other.impacts[k], case.until)
    });
    let grazes = next.iter().flatten().any(|(_, _, graze)| *graze);
    let differ = match is_decided {
        true => next[0].map(|hit| hit.1) != next[1].map(|hit| hit.1),
        false => next[0].is_some() != next[1].is_some() || kinds[0] != kinds[1],
    };
    if differ && !grazes && before < AGREED / 100.0 {
        tally.wrong.push(format!(
            "{}: references differ after {sure} impacts with error {before:.1e}: {next:?}, {kinds:?}\n{}",
            case.name,
            told(case)
        ));
    }
    Some(Reference { course, sure })
}

/// The start as text.
fn told(case: &Case) -> String {
    let description = case.model.description();
    let parameters = description.parameters.iter().enumerate();
    let values: Vec<String> = parameters
        .map(|(index, parameter)| format!("{}={:?}", parameter.name, case.model.parameter(index)))
        .collect();
    format!("    {} {:?}", values.join(" "), case.origin)
}

/// Describes the mistake of a run; `None` if it has none.
fn mistake(case: &Case, way: Way, reference: &Reference) -> Option<String> {
    let Reference { course, sure } = reference;
    let last = course.ending.t;
    let until = match course.ending.outcome {
        Outcome::Done => last,
        _ => last + 1e-3 * case.until,
    };
    let measured = run(case, way, until)?;
    let outcome = measured.ending.outcome;
    let told = |what: &str| {
        let [ours, theirs] = [&measured, course].map(|one| {
            let hits: Vec<_> = one.impacts.iter().map(|hit| (hit.surface, hit.t)).collect();
            format!(
                "{:?} at {} after {hits:?}",
                one.ending.outcome, one.ending.t
            )
        });
        Some(format!(
            "{} by {way:?}, {what}: {ours}, where {theirs}\n{}",
            case.name,
            self::told(case)
        ))
    };
    if outcome.kind() == "projection_failed" {
        return told("a projection failed");
    }
    let lost_before = |t: f64| is_lost(case, way, [until, case.until], t);
    let mut worst: f64 = 0.0;
    for (k, there) in course.impacts[..*sure].iter().enumerate() {
        let Some(here) = measured.impacts.get(k) else {
            let is_out_of_depth = !way.integrator.is_adaptive() && !measured.ending.reached;
            return match is_out_of_depth || lost_before(there.t) {
                true => None,
                false => told("an impact is missing"),
            };
        };
        if here.graze || there.graze {
            return None;
        }
        let is_near = (here.t - there.t).abs() <= 1e-2 * case.until;
        if here.surface != there.surface || !is_near {
            return match lost_before(here.t.min(there.t)) {
                true => None,
                false => told("another impact"),
            };
        }
        worst = larger(worst, error(here, there, case.until));
        if worst > LOST {
            return None;
        }
    }
    let [ours, theirs] = [&measured, course].map(|one| &one.ending.last);
    let ends_lost = apart(&theirs.q, &ours.q).max(apart(&theirs.qdot, &ours.qdot)) > LOST;
    let is_whole = *sure == course.impacts.len() && measured.ending.t == last && !ends_lost;
    match is_whole && measured.impacts.len() != *sure {
        true => told("an impact too many"),
        false => None,
    }
}

/// True if the error of a run exceeds [`LOST`] just before the time `t`, or if a state is missing there. The run lasts
/// until `until`, its reference until `reference_until`.
fn is_lost(case: &Case, way: Way, [until, reference_until]: [f64; 2], t: f64) -> bool {
    let before = t - 1e-9 * case.until;
    let states = state_at(case, way, until, before).and_then(|(t, ours)| {
        let (_, theirs) = state_at(case, references()[0], reference_until, t)?;
        Some((ours, theirs))
    });
    states.is_none_or(|(ours, theirs)| {
        apart(&theirs.q, &ours.q).max(apart(&theirs.qdot, &ours.qdot)) > LOST
    })
}

/// The integrators, forms and tolerances with which a model is run.
fn ways(case: &Case, adaptive: &[f64], fixed: &[f64]) -> Vec<Way> {
    let description = case.model.description();
    let has_no_principle = description.is_first_order || !description.modes.is_empty();
    let mut ways = Vec::new();
    for &integrator in Integrator::every() {
        let is_discrete = matches!(integrator, Integrator::Dla2 | Integrator::Dla4);
        if is_discrete && has_no_principle {
            continue;
        }
        let tolerances = match integrator.is_adaptive() {
            true => adaptive,
            false => fixed,
        };
        for form in Form::every() {
            ways.extend(tolerances.iter().map(|&tol| Way {
                integrator,
                form: *form,
                tol,
            }));
        }
    }
    ways
}

/// Compares the reference with certified impacts.
fn check_certified(case: &Case, reference: &Reference, tally: &mut Tally) {
    let Some((strikes, _)) = certified(case, 4) else {
        return;
    };
    let sure = &reference.course.impacts[..reference.sure];
    for (strike, hit) in strikes.iter().zip(sure) {
        let slack = 1e-9 * case.until;
        let is_inside = strike.time.lo - slack <= hit.t && hit.t <= strike.time.hi + slack;
        if strike.surface != hit.surface || !is_inside {
            let found = (hit.surface, hit.t);
            tally.wrong.push(format!(
                "{}: {found:?} where surface {} at {:?} is certain\n{}",
                case.name,
                strike.surface,
                strike.time,
                told(case)
            ));
            return;
        }
        tally.certified += 1;
    }
}

/// Compares all runs of a start. Returns false if the start is refused.
fn compare(case: &Case, [adaptive, fixed]: [&[f64]; 2], tally: &mut Tally) -> bool {
    let Some(reference) = reference(case, tally) else {
        return false;
    };
    tally.starts += 1;
    tally.impacts += reference.sure as u64;
    check_certified(case, &reference, tally);
    for way in ways(case, adaptive, fixed) {
        tally.runs += 1;
        tally.wrong.extend(mistake(case, way, &reference));
    }
    true
}

/// Largest number of draws until a start is accepted.
const DRAWS: u64 = 200;

/// Compares the declared start and `count` drawn starts of every model.
/// Compares the declared start of a model and so many drawn ones.
fn compare_starts(shipped: &Shipped, count: u64, seed: u64, tolerances: [&[f64]; 2]) -> Tally {
    let mut tally = Tally::default();
    assert!(
        compare(&shipped.declared(), tolerances, &mut tally),
        "{}",
        shipped.name
    );
    for number in 0..count {
        let mut random = Random::new(seed.wrapping_mul(1_000_003).wrapping_add(number));
        let mut draws = (0..DRAWS).map(|_| shipped.drawn(number, &mut random));
        let is_found = draws.any(|case| compare(&case, tolerances, &mut tally));
        assert!(is_found, "{}: no start was accepted", shipped.name);
    }
    println!("{}: {} impacts", shipped.name, tally.impacts);
    tally
}

fn compare_all(count: u64, seed: u64, tolerances: [&[f64]; 2]) {
    let only = std::env::var("SEQUENCES_MODEL").ok();
    let is_asked = |shipped: &Shipped| only.as_ref().is_none_or(|name| name == shipped.name);
    let models: Vec<Shipped> = Shipped::with_surfaces().filter(is_asked).collect();
    let tallies = parallel::each(&models, |shipped| {
        compare_starts(shipped, count, seed, tolerances)
    });
    let mut tally = Tally::default();
    for of_model in tallies {
        tally.add(of_model);
    }
    println!(
        "{} starts, {} runs, {} impacts, {} of them certified",
        tally.starts, tally.runs, tally.impacts, tally.certified
    );
    assert!(
        tally.wrong.is_empty(),
        "{} wrong:\n{}",
        tally.wrong.len(),
        tally.wrong.join("\n")
    );
    assert!(only.is_some() || tally.impacts > tally.starts * IMPACTS / 4);
}

#[test]
fn integrators_agree_on_the_impacts_of_shipped_models() {
    compare_all(1, 1, [&[1e-5, 1e-9], &[1e-4]]);
}

#[test]
#[ignore = "nightly: forty starts of every shipped model"]
fn integrators_agree_on_forty_starts_of_every_shipped_model() {
    let count = asked("SEQUENCES_STARTS", 40);
    compare_all(
        count,
        asked("SEQUENCES_SEED", 2),
        [&[1e-4, 1e-7, 1e-10], &[1e-4, 1e-6]],
    );
}
