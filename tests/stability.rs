//! The hard cases of `dalembert stability`: each holds, or is marked as pending and does not hold.

use dalembert_cli::suite::{Case, Verdict, every_integrator, examine};
use dalembert_stability as stability;

/// Examines cases one by one, prints their measurements, and asserts that none fails.
fn assert_hold(cases: impl Iterator<Item = Case>) {
    let mut failed = Vec::new();
    for case in cases {
        let finding = examine(&case, every_integrator());
        let words = format!(
            "{} {}: {}",
            case.id,
            finding.verdict.name(),
            finding.measured
        );
        println!("{words} ({:.2} s)", finding.elapsed.as_secs_f64());
        if finding.verdict == Verdict::Fail {
            failed.push(words);
        }
    }
    assert!(failed.is_empty(), "{failed:#?}");
}

fn section(letter: &str, nightly: bool) -> impl Iterator<Item = Case> {
    let cases = stability::all().into_iter();
    cases.filter(move |case| case.section() == letter && case.nightly == nightly)
}

macro_rules! sections {
    ($($quick:ident $long:ident $letter:literal)*) => {$(
        #[test]
        fn $quick() {
            assert_hold(section($letter, false));
        }

        #[test]
        #[ignore = "nightly: long runs"]
        fn $long() {
            assert_hold(section($letter, true));
        }
    )*};
}

sections! {
    impacts_are_located long_impacts_are_located "A"
    accumulations_end_runs long_accumulations_end_runs "B"
    laws_and_corners long_laws_and_corners "C"
    constraints_and_conditioning long_constraints_and_conditioning "D"
    scales_and_arithmetic long_scales_and_arithmetic "E"
    long_runs longest_runs "F"
    derivatives_and_orbits long_derivatives_and_orbits "G"
    bad_input long_bad_input "H"
}

#[test]
fn every_row_has_a_case_with_a_number_of_its_own_and_a_bound() {
    let cases = stability::all();
    for pair in cases.windows(2) {
        assert!(pair[0].id < pair[1].id, "{} and {}", pair[0].id, pair[1].id);
    }
    let rows = [
        ("A", 22),
        ("B", 14),
        ("C", 20),
        ("D", 18),
        ("E", 15),
        ("F", 17),
        ("G", 12),
        ("H", 11),
    ];
    // Rows that are not about runs have no case here.
    let elsewhere = ["E07", "G01", "G02", "G03", "G04", "G05", "G06", "G07"];
    for (section, count) in rows {
        for number in 1..=count {
            let id = format!("{section}{number:02}");
            let found = cases.iter().any(|case| case.id == id);
            assert!(found || elsewhere.contains(&id.as_str()), "{id} is missing");
        }
    }
    for case in &cases {
        assert!(
            !case.title.is_empty() && !case.right.is_empty() && !case.bound.is_empty(),
            "{}",
            case.id
        );
        let runs = !matches!(case.run, dalembert_cli::suite::Run::Absent);
        assert!(
            runs || case.pending.is_some(),
            "{} neither runs nor is pending",
            case.id
        );
    }
}
