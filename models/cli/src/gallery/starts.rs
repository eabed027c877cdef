//! Runs that start near each other, as a cloud of their positions at one time in the plane of the declared view.

use dalembert_driver::{AnyModel, Contact, Impact, OffConstraint, Piece, Watch};

use super::Starts;
use crate::args::{SimulateArgs, StateArgs};
use crate::command::simulate::{Prepared, prepare};
use crate::entry::Entry;
use crate::error::CliError;
use crate::plot::{self, Drawn, cloud};
use crate::state_input::{build_run, initial_state};

/// Makes the runs and draws their positions.
///
/// # Errors
/// Invalid flags, a state that is refused, a model without a view of two coordinates with a region.
pub fn draw(
    models: &[Entry],
    args: &SimulateArgs,
    starts: &Starts,
    title: &str,
) -> Result<Drawn, CliError> {
    let model = build_run(models, &args.run)?;
    let prepared = prepare(model.as_ref(), args)?;
    let middle = final_position(model.as_ref(), &prepared)?;
    let mut points = Vec::new();
    for member in 0..starts.members {
        let state = StateArgs {
            initial: starts.changes(member),
            q: None,
            qdot: None,
            p: None,
            off_constraint: OffConstraint::Error,
        };
        let prepared = Prepared {
            origin: initial_state(model.as_ref(), &state)?,
            ..prepared.clone()
        };
        points.extend(final_position(model.as_ref(), &prepared)?);
    }
    let reached = format!(
        "{} of {} runs at t = {}",
        points.len(),
        starts.members,
        prepared.settings.until
    );
    let svg = cloud::draw(&cloud::Cloud {
        table: &plot::Table {
            model: model.as_ref(),
            q: &prepared.origin.q,
        },
        title,
        subtitle: &reached,
        points: &points,
        middle,
    });
    Ok(Drawn {
        svg: svg.map_err(|reason| CliError::picture(&args.plot, reason))?,
        outcome: reached,
    })
}

/// The position in the view at the end of a run; `None` if the run ends early.
fn final_position(model: &dyn AnyModel, prepared: &Prepared) -> Result<Option<[f64; 2]>, CliError> {
    let ending = model
        .simulate(&prepared.origin, &prepared.settings, &mut Unwatched)
        .map_err(|refusal| CliError::refused(model, &refusal))?;
    Ok(ending.last.view.filter(|_| ending.reached))
}

struct Unwatched;

impl Watch for Unwatched {
    fn step(&mut self, _piece: &dyn Piece) {}
    fn hears(&mut self, _impact: &Impact<()>) -> bool {
        false
    }

    fn impact(&mut self, _impact: Impact) {}
    fn contact(&mut self, _contact: Contact) {}
}

impl Starts {
    /// The start of a member, in the syntax of `--initial`.
    fn changes(&self, member: u32) -> Vec<String> {
        let scattered = self.scatter.iter().enumerate();
        scattered
            .map(|(index, (name, middle, deviation))| {
                let counter = u64::from(member) * self.scatter.len() as u64 + index as u64;
                let share = 2.0 * uniform(self.seed, counter) - 1.0;
                format!("{name}={:?}", middle + deviation * share)
            })
            .collect()
    }
}

/// A uniformly distributed number in [0, 1), determined by seed and counter.
///
/// # References
/// The generator SplitMix64: G. Steele, D. Lea and C. Flood, Fast splittable pseudorandom number generators, 2014.
fn uniform(seed: u64, counter: u64) -> f64 {
    const GOLDEN: u64 = 0x9e37_79b9_7f4a_7c15;
    let mixed = |mut z: u64| {
        z = (z ^ (z >> 30)).wrapping_mul(0xbf58_476d_1ce4_e5b9);
        z = (z ^ (z >> 27)).wrapping_mul(0x94d0_49bb_1331_11eb);
        z ^ (z >> 31)
    };
    let start = mixed(seed.wrapping_mul(GOLDEN));
    let bits = mixed(start.wrapping_add((counter + 1).wrapping_mul(GOLDEN)));
    (bits >> 11) as f64 / (1_u64 << 53) as f64
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn members_are_scattered_within_the_deviation_and_evenly() {
        let starts = Starts {
            flags: String::new(),
            members: 1000,
            scatter: vec![("x", 10.0, 0.5), ("y", 0.0, 1.0)],
            seed: 1,
        };
        let mut sums = [0.0; 2];
        for member in 0..starts.members {
            for (index, change) in starts.changes(member).iter().enumerate() {
                let (name, value) = change.split_once('=').unwrap();
                let value: f64 = value.parse().unwrap();
                let (expected, middle, deviation) = starts.scatter[index];
                assert_eq!(name, expected);
                assert!((value - middle).abs() <= deviation);
                sums[index] += (value - middle) / deviation;
            }
        }
        // The mean of 1000 such numbers has a standard deviation of 0.018.
        assert!(
            sums.iter().all(|sum| (sum / 1000.0).abs() < 0.06),
            "{sums:?}"
        );
        assert_ne!(starts.changes(0), starts.changes(1));
    }

    #[test]
    fn seeds_give_other_numbers() {
        assert_ne!(uniform(1, 0), uniform(2, 0));
        assert_eq!(uniform(1, 7), uniform(1, 7));
    }
}
