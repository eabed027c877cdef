use dalembert::jet::Work;
use dalembert_cli::Integrator;
use dalembert_driver::accuracy::{NoChoice, Plan, Study, TIMES};
use dalembert_driver::{
    AnyModel, Contact, Form, Impact, OffConstraint, Origin, Piece, Rates, Settings, Watch,
};

use super::folder::Folder;
use super::*;

/// A plan that is quick to measure.
fn plan(until: f64) -> Plan {
    Plan {
        integrators: vec![Integrator::Dop853, Integrator::Rk4],
        tolerances: vec![1e-3, 1e-6, 1e-9],
        rounds: 1,
        least: std::time::Duration::ZERO,
        ..Plan::new(until)
    }
}

/// A state at rest, or with the given velocities.
fn origin(q: &[f64]) -> Origin {
    Origin {
        q: q.to_vec(),
        rates: Rates::Velocities(vec![0.0; q.len()]),
        policy: OffConstraint::Error,
    }
}

fn settings(until: f64) -> Settings {
    Settings {
        form: Form::Reduced,
        integrator: Integrator::Dop853,
        tol: 1e-10,
        step: None,
        max_step: None,
        steps: None,
        until,
        impacts: None,
        laws: Vec::new(),
        policies: dalembert::Policies::default(),
        projection: None,
    }
}

fn measure(model: &dyn AnyModel, q: &[f64], plan: &Plan) -> Study {
    let base = settings(plan.until);
    model
        .study(&origin(q), &base, plan, &mut |_| {})
        .unwrap_or_else(|refusal| panic!("{refusal}"))
}

/// The oscillator that moves as `q[0] cos(t)` along x and as `q[1] cos(2 t)` along y if it starts at rest.
fn oscillator() -> Box<dyn AnyModel> {
    let mut model = systems::oscillator();
    model.set_parameter(0, 4.0);
    model
}

/// Keeps the largest difference from a closed form at the compared times.
struct Closed<F> {
    until: f64,
    next: u64,
    worst: [f64; 2],
    solution: F,
}

impl<F: Fn(f64) -> [f64; 2]> Watch for Closed<F> {
    fn step(&mut self, piece: &dyn Piece) {
        while self.next < TIMES {
            let t = self.until * (self.next + 1) as f64 / TIMES as f64;
            if t > piece.span().1 {
                break;
            }
            let q = piece.at(t).q;
            let right = (self.solution)(t);
            for i in 0..2 {
                self.worst[i] = self.worst[i].max((q[i] - right[i]).abs());
            }
            self.next += 1;
        }
    }

    fn impact(&mut self, _: Impact) {}

    fn contact(&mut self, _: Contact) {}
}

#[test]
fn a_measured_error_is_the_distance_from_the_closed_form() {
    let (until, model, start) = (7.0, oscillator(), [1.0, 0.5]);
    let study = measure(&*model, &start, &plan(until));
    assert!(study.floor < 1e-14, "{:e}", study.floor);
    assert_eq!(study.samples.len(), 6);
    for sample in study
        .samples
        .iter()
        .filter(|it| it.integrator == Integrator::Dop853)
    {
        let mut closed = Closed {
            until,
            next: 0,
            worst: [0.0; 2],
            solution: |t: f64| [t.cos(), 0.5 * (2.0 * t).cos()],
        };
        let settings = Settings {
            tol: sample.tol,
            ..settings(until)
        };
        let run = model.simulate(&origin(&start), &settings, &mut closed);
        assert!(run.is_ok());
        // Errors are relative to the largest value at the compared times, which is nearly the amplitude.
        let expected = closed.worst[0].max(closed.worst[1] / 0.5);
        assert!(
            (sample.error / expected - 1.0).abs() < 0.02,
            "tol {:e}: {:e} for {expected:e}",
            sample.tol,
            sample.error
        );
    }
}

#[test]
fn runs_that_end_otherwise_are_no_choice() {
    let study = measure(&*systems::ball(), &[1.0], &plan(3.0));
    assert!(study.impacts > 0);
    assert!(study.samples.iter().all(|sample| sample.agrees));
    let mut changed = study.clone();
    changed.impacts += 1;
    for sample in &mut changed.samples {
        sample.agrees = false;
    }
    assert!(matches!(
        changed.choose(1.0),
        Err(NoChoice::OutOfReach { .. })
    ));
    assert!(changed.cheapest().is_empty());
}

#[test]
fn an_error_of_nothing_at_all_ends_no_ladder() {
    // At rest every run is exact.
    let study = measure(&*oscillator(), &[0.0, 0.0], &plan(2.0));
    let adaptive = study.samples.iter();
    let adaptive = adaptive.filter(|it| it.integrator == Integrator::Dop853);
    assert_eq!(adaptive.count(), 3);
    assert!(study.samples.iter().all(|sample| sample.error == 0.0));
}

#[test]
fn the_choice_reaches_what_is_wanted_in_the_least_time() {
    let model = oscillator();
    let wanted = Plan {
        enough: Some(1e-7),
        ..Plan::new(2.0)
    };
    let study = measure(&*model, &[1.0, 0.5], &wanted);
    let choice = study.choose(1e-7).unwrap();
    assert!(choice.error <= 1e-7 && choice.microseconds > 0.0);

    let study = measure(&*model, &[1.0, 0.5], &plan(2.0));
    let error = study.choose(1e-30).unwrap_err().to_string();
    assert!(
        error.starts_with("no run has an error below 1e-30"),
        "{error}"
    );
    let best = study.choose(1e-2).unwrap();
    for sample in study.samples.iter().filter(|sample| sample.error <= 1e-2) {
        assert!(best.microseconds <= 1.05 * sample.microseconds);
    }
}

#[test]
fn of_nearly_equal_times_the_least_work_is_chosen() {
    let mut study = measure(&*oscillator(), &[1.0, 0.5], &plan(2.0));
    for (i, sample) in study.samples.iter_mut().enumerate() {
        (sample.error, sample.work) = (1e-9, 100.0 - i as f64);
        sample.microseconds = 10.0 + i as f64;
    }
    study.samples[1].microseconds = 10.4;
    assert_eq!(study.choose(1e-6).unwrap(), &study.samples[1]);
    study.samples[1].microseconds = 10.6;
    assert_eq!(study.choose(1e-6).unwrap(), &study.samples[0]);
}

#[test]
fn measurements_end_with_their_budget_and_leave_no_case_untimed() {
    let model = oscillator();
    let plan = Plan {
        rounds: 1000,
        budget: std::time::Duration::ZERO,
        least: std::time::Duration::from_millis(20),
        ..plan(2.0)
    };
    let begun = std::time::Instant::now();
    let study = measure(&*model, &[1.0, 0.5], &plan);
    // A thousand rounds take two minutes.
    assert!(begun.elapsed() < std::time::Duration::from_secs(30));
    assert!(study.samples.iter().all(|it| it.microseconds.is_finite()));
}

#[test]
fn the_automatic_choice_follows_from_tolerance_and_work() {
    let chosen = |tol: f64, work: Option<(u32, u32, Option<u32>)>| {
        let work = work.map(|(values, sums, degree)| Work {
            values,
            sums,
            degree,
        });
        Integrator::automatic(tol, work).unwrap()
    };
    let (disk, chain) = ((69, 2, None), (1019, 368, None));
    assert_eq!(chosen(1e-10, Some(disk)), Integrator::Taylor);
    assert_eq!(chosen(1e-10, Some(chain)), Integrator::Dop853);
    // The series of the motion ends.
    assert_eq!(chosen(1e-3, Some((7, 0, Some(2)))), Integrator::Taylor);
    assert_eq!(chosen(1e-10, None), Integrator::Dop853);
    assert!(
        Integrator::automatic(
            0.0,
            Some(Work {
                values: 1,
                sums: 0,
                degree: None
            })
        )
        .is_err()
    );
}

#[test]
fn runs_choose_their_integrator_unless_one_is_given() {
    let folder = Folder::new("automatic");
    let ball = "Ball { coordinates { x; } lagrangian = dot(x)^2/2 - x; impacts { floor: x >= 0; } \
                initial { x = 1; } }";
    let ball = folder.file("ball.dal", ball);
    let integrator = |model: &str, flags: &str| {
        let done = run(&format!("simulate {model} --until 2 --json - {flags}"));
        done.json()["integrator"].as_str().unwrap().to_owned()
    };
    assert_eq!(integrator(&ball, ""), "taylor");
    assert_eq!(integrator(&ball, "--integrator auto --tol 1e-4"), "taylor");
    assert_eq!(integrator(&ball, "--integrator dopri5"), "dopri5");
    let refused = run(&format!("simulate {ball} --step 0.1"));
    assert_eq!(refused.exit, Exit::Refused);
    assert!(refused.errors.contains("--step"), "{}", refused.errors);
    let table = run(&format!("accuracy {ball} --until 2 --budget 0.5"));
    let told = "--integrator auto: taylor from 1e-3 to 1e-15";
    assert!(table.output.contains(told), "{}", table.output);
}

const QUICK: &str = "--rounds 1 --integrator dop853 --integrator gauss4 --patience 0.05";

#[test]
fn it_is_told_as_a_table_as_a_document_and_as_a_picture() {
    let folder = std::env::temp_dir().join(format!("dalembert-accuracy-{}", std::process::id()));
    std::fs::create_dir_all(&folder).unwrap();
    let path = |name: &str| folder.join(name).display().to_string();
    let done = run(&format!(
        "accuracy bouncing_ball --until 3 {QUICK} --wanted 1e-6 --csv {} --plot {}",
        path("a.csv"),
        path("a.svg")
    ));
    assert_eq!(done.exit, Exit::Reached, "{}", done.errors);
    assert!(
        done.output.contains("for an error of 1e-6: --integrator "),
        "{}",
        done.output
    );
    let csv = std::fs::read_to_string(path("a.csv")).unwrap();
    assert!(csv.starts_with("integrator,tol,step,error,ends_as_reference,outcome,"));
    assert!(csv.lines().count() > 13, "{csv}");
    let svg = std::fs::read_to_string(path("a.svg")).unwrap();
    for text in [
        "microseconds per unit of time",
        "error of the positions",
        "dop853",
        "gauss4",
    ] {
        assert!(svg.contains(text), "{text}");
    }
    std::fs::remove_dir_all(&folder).unwrap();

    let document = run(&format!(
        "accuracy bouncing_ball --until 3 {QUICK} --wanted 1e-6 --json -"
    ))
    .json();
    let cases = document["cases"].as_array().unwrap();
    assert!(cases.len() >= 13);
    assert!(document["wanted"]["measured"].as_f64().unwrap() <= 1e-6);
    assert_eq!(document["reference"]["outcome"], "done");
    assert!(!document["cheapest"].as_array().unwrap().is_empty());
}

#[test]
fn what_nothing_reaches_is_said() {
    let done = run(&format!(
        "accuracy oscillator --set k=4 --until 2 {QUICK} --wanted 1e-40"
    ));
    assert_eq!(done.exit, Exit::Other);
    assert!(
        done.output.contains("no run has an error below 1e-40"),
        "{}",
        done.output
    );
}

#[test]
fn a_run_is_verified_against_the_reference() {
    let done =
        run("simulate oscillator --set k=4 --until 7 --integrator dopri5 --tol 1e-4 --verify");
    let line = done
        .output
        .lines()
        .find(|line| line.contains("  error "))
        .unwrap();
    assert!(line.contains("accuracy of the reference: "), "{line}");
    let document =
        run("simulate bouncing_ball --until 3 --tol 1e-4 --verify --samples 2 --json -").json();
    let error = &document["error"];
    assert_eq!(error["ends_as_reference"], true);
    assert!(error["measured"].as_f64().unwrap() < 1e-2);
    assert!(error["floor"].as_f64().unwrap() < 1e-13);
    let plain = run("simulate oscillator --set k=4 --until 7").output;
    assert!(!plain.contains("  error "), "{plain}");
}
