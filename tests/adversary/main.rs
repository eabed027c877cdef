//! Random declarations that are likely to reveal a wrong proof or a wrong refutation. Their answers are known by
//! construction.
//!
//! | family | contents |
//! |---|---|
//! | `potential` | drags from a known potential; some have a period, a curl in a box, or a curl of 1e-15 |
//! | `leaf` | curves that wind towards a circle at some position, or towards none |
//! | `quantity` | forces that are 0 by an identity, act only in a box, or are far below rounding errors |
//! | `systems` | known systems in other coordinates |
//! | `gauge` | translations of Lagrangians with an added form, exact or not |
//! | `exceptional` | a parameter whose default may be an exceptional value, at which no density exists |
//! | `wall` | impacts on a part of a curve |
//!
//! The quick test uses fixed seeds. `ADVERSARY_SEED` sets the first seed, and `ADVERSARY_CASES` the number of cases. A
//! wrong verdict is printed with its declaration.

mod draw;
mod families;
mod function;

use std::collections::BTreeMap;

use dalembert_codegen::claims::Verdict;
use dalembert_tests::claim::verdict;
use dalembert_tests::sampling::asked;

use draw::Draw;
use families::{Case, case};

/// Bound on the fraction of all cases that are decidable and stay open.
const OPEN: f64 = 0.05;

/// Verdicts on cases of one family.
#[derive(Debug, Default)]
struct Tally {
    right: usize,
    open: usize,
    /// Open cases that are decidable.
    missed: usize,
}

/// Counts the verdict on a case. Fails if the verdict is wrong.
fn judged(seed: u64, case: &Case, tally: &mut Tally) -> Result<(), String> {
    let source = format!(
        "Case{seed} {{ {} claims {{ {}; }} }}",
        case.declarations, case.claim
    );
    let finding = verdict(&source);
    let is_right = match finding.verdict {
        Verdict::Proved(_) => case.is_true,
        Verdict::Refuted(_) => !case.is_true,
        Verdict::Undecided(_) => {
            tally.open += 1;
            tally.missed += usize::from(case.is_decidable);
            return Ok(());
        }
    };
    tally.right += 1;
    match is_right {
        true => Ok(()),
        false => Err(format!("seed {seed}: {source}\n{}", finding.note())),
    }
}

/// Judges this many cases, unless the environment sets another number, and prints the counts of the verdicts.
fn judge(cases: u64) {
    let first = asked("ADVERSARY_SEED", 0);
    let cases = asked("ADVERSARY_CASES", cases);
    let mut tallies: BTreeMap<&str, Tally> = BTreeMap::new();
    let mut wrong = Vec::new();
    for seed in first..first + cases {
        let case = case(&mut Draw::new(seed));
        let tally = tallies.entry(case.family).or_default();
        wrong.extend(judged(seed, &case, tally).err());
    }
    println!("{cases} declarations from seed {first} on");
    for (family, tally) in &tallies {
        println!(
            "{family:12} {:6} right, {:5} open, {:5} of them decidable",
            tally.right, tally.open, tally.missed
        );
    }
    assert!(
        wrong.is_empty(),
        "{} wrong:\n{}",
        wrong.len(),
        wrong.join("\n")
    );
    let missed: usize = tallies.values().map(|tally| tally.missed).sum();
    let part = missed as f64 / cases as f64;
    println!("{:.2} % undecided though decidable", 100.0 * part);
    assert!(part < OPEN, "{missed} of {cases} are undecided");
}

#[test]
fn no_verdict_is_wrong() {
    judge(400);
}

#[test]
#[ignore = "nightly: minutes of claims"]
fn no_verdict_of_twenty_thousand_is_wrong() {
    judge(20_000);
}
