//! Result of a claim: proved with a certificate, refuted with a witness, or left open with the reason.

use std::fmt;

use super::potential::Potential;
use super::sample::Sample;
use crate::diagnostics::Counterexample;
use crate::spec::ItemId;

/// A claim and its verdict.
#[derive(Debug, Clone, PartialEq)]
pub struct Finding {
    /// The claim as written.
    pub claim: String,
    /// True if an open answer is accepted.
    pub is_assumed: bool,
    /// Place of the declaration.
    pub item: ItemId,
    /// The verdict on the claim.
    pub verdict: Verdict,
    /// Further results: a momentum equation, the effect of impacts on the volume.
    pub remarks: Vec<String>,
    /// The density in closed form that a proof is about.
    pub density: Option<ClosedForm>,
}

/// A density `exp(G) mu_C` in closed form.
#[derive(Debug, Clone, PartialEq)]
pub struct ClosedForm {
    /// `G`
    pub potential: Potential,
    /// The dependent velocities, one for each constraint: the columns of [`Term::DependentDeterminant`](super::Term).
    pub dependent: Vec<usize>,
}

/// Verdict on a claim.
#[derive(Debug, Clone, PartialEq)]
pub enum Verdict {
    /// The claim holds.
    Proved(Certificate),
    /// The claim fails.
    Refuted(Witness),
    /// Neither was shown.
    Undecided(String),
}

/// Proof of a claim.
#[derive(Debug, Clone, PartialEq)]
pub struct Certificate {
    /// Proved statement, a sentence.
    pub shown: String,
    /// Number of random points at which it was tested.
    pub points: usize,
    /// The primes of these points.
    pub primes: Vec<u64>,
    /// Upper bound of the probability that it is wrong; 0 for a proof without random points.
    pub error: f64,
    /// The seed of the points.
    pub seed: u64,
    /// A state that proves the statement, if one does.
    pub at: Option<Sample>,
}

impl Certificate {
    /// The certificate of a proof that takes no random points.
    pub(super) fn without_chance(shown: String, seed: u64) -> Self {
        Self {
            shown,
            points: 0,
            primes: Vec::new(),
            error: 0.0,
            seed,
            at: None,
        }
    }

    /// Adds points, primes and error probabilities of another proof on which this one depends.
    pub(super) fn rest_on(&mut self, other: &Self) {
        self.points += other.points;
        self.error += other.error;
        self.primes.extend(&other.primes);
        self.primes.sort_unstable();
        self.primes.dedup();
    }
}

/// Reason for which a claim fails, with a point at which it can be checked by hand.
#[derive(Debug, Clone, PartialEq)]
pub struct Witness {
    /// Statement that contradicts the claim.
    pub reason: String,
    /// The point, if one is needed.
    pub sample: Option<Sample>,
    /// Names and values computed there.
    pub values: Vec<(String, f64)>,
    /// Advice on a claim that holds instead.
    pub help: String,
}

impl Finding {
    /// True if the finding lets the build continue.
    pub fn is_accepted(&self) -> bool {
        match &self.verdict {
            Verdict::Proved(_) => true,
            Verdict::Refuted(_) => false,
            Verdict::Undecided(_) => self.is_assumed,
        }
    }

    /// The verdict as one word.
    pub fn word(&self) -> &'static str {
        match &self.verdict {
            Verdict::Proved(_) => "proved",
            Verdict::Refuted(_) => "refuted",
            Verdict::Undecided(_) if self.is_assumed => "assumed",
            Verdict::Undecided(_) => "undecided",
        }
    }

    /// Grounds as text: the certificate, the witness or the reason.
    pub fn grounds(&self) -> String {
        match &self.verdict {
            Verdict::Proved(certificate) => certificate.to_string(),
            Verdict::Refuted(witness) => witness.to_string(),
            Verdict::Undecided(reason) => reason.clone(),
        }
    }

    /// The state that refutes the claim, if one was found.
    pub fn counterexample(&self) -> Option<Counterexample> {
        let Verdict::Refuted(witness) = &self.verdict else {
            return None;
        };
        let sample = witness.sample.as_ref()?;
        Some(Counterexample {
            at: sample.values.clone(),
            values: witness.values.clone(),
        })
    }

    /// The finding as a remark in the documentation of the model.
    pub fn note(&self) -> String {
        let mut note = format!("`{}` is {}: {}", self.claim, self.word(), self.grounds());
        for remark in &self.remarks {
            note += "; ";
            note += remark;
        }
        note
    }

    /// The remarks, each on a line of its own.
    fn lines(&self) -> String {
        self.remarks
            .iter()
            .map(|remark| format!("\n{remark}"))
            .collect()
    }

    /// The message of a claim that is not accepted, and its help.
    pub fn refusal(&self) -> Option<(String, String)> {
        match &self.verdict {
            _ if self.is_accepted() => None,
            Verdict::Proved(_) => None,
            Verdict::Refuted(witness) => {
                let text = format!("`{}` is refuted: {witness}{}", self.claim, self.lines());
                Some((text, witness.help.clone()))
            }
            Verdict::Undecided(reason) => {
                let text = format!("`{}` is undecided: {reason}{}", self.claim, self.lines());
                let help = format!("write `assume {};` to go on without a proof", self.claim);
                Some((text, help))
            }
        }
    }
}

impl fmt::Display for Certificate {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        write!(f, "{}", self.shown)?;
        if self.points == 0 {
            return Ok(());
        }
        let primes = match self.primes.as_slice() {
            [only] => format!("the prime {only}"),
            [first, rest @ ..] => format!("{} primes, the least {first}", rest.len() + 1),
            [] => "no prime".to_owned(),
        };
        write!(
            f,
            "; tested at {} random points modulo {primes}, seed {:#018x}",
            self.points, self.seed
        )?;
        if self.error > 0.0 {
            write!(
                f,
                ", chance of error below {}",
                bound(self.error.max(1e-300))
            )
        } else {
            write!(f, ", no chance of error")
        }
    }
}

/// The least number with one digit that is not below a positive number.
fn bound(value: f64) -> String {
    let nearest = format!("{value:.0e}");
    match (nearest.parse::<f64>(), nearest.split_once('e')) {
        (Ok(number), Some((digit, exponent))) if number < value => match digit {
            "9" => format!("1e{}", exponent.parse().map_or(0, |power: i32| power + 1)),
            _ => format!(
                "{}e{exponent}",
                digit.parse().map_or(9, |digit: i32| digit + 1)
            ),
        },
        _ => nearest,
    }
}

impl fmt::Display for Witness {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        write!(f, "{}", self.reason)?;
        for (name, value) in &self.values {
            write!(f, "\n{name} = {}", digits(*value))?;
        }
        match &self.sample {
            Some(sample) if !sample.values.is_empty() => write!(f, "\nat {}", sample.text()),
            _ => Ok(()),
        }
    }
}

/// Twelve significant digits, for comparison by hand. Decimal notation omits zeros at the end.
pub(crate) fn digits(value: f64) -> String {
    if value == 0.0 {
        return "0".to_owned();
    }
    let exponent = value.abs().log10().floor();
    if (-4.0..9.0).contains(&exponent) {
        let decimals = (11.0 - exponent).max(0.0) as usize;
        let text = format!("{value:.decimals$}");
        match text.contains('.') {
            true => text.trim_end_matches('0').trim_end_matches('.').to_owned(),
            false => text,
        }
    } else {
        format!("{value:.11e}")
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn bounds_of_errors_are_rounded_up() {
        assert_eq!(bound(3.4e-17), "4e-17");
        assert_eq!(bound(3.6e-17), "4e-17");
        assert_eq!(bound(9.1e-17), "1e-16");
        assert_eq!(bound(5e-17), "5e-17");
    }

    #[test]
    fn numbers_are_written_with_twelve_digits_and_no_more() {
        assert_eq!(digits(-0.393_159_046_028_225), "-0.393159046028");
        assert_eq!(digits(2.0), "2");
        assert_eq!(digits(0.0), "0");
        assert_eq!(digits(1e-9), "1.00000000000e-9");
        assert_eq!(digits(1200.5), "1200.5");
    }
}
