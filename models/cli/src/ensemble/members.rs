//! The members of an ensemble from flags, and the metadata that identify them.

use std::ops::Range;

use dalembert::describe::Description;
use dalembert_driver::AnyModel;
use dalembert_driver::ensemble::{Members, Quantity, Source, Values};
use serde_json::{Value, json};

use super::fingerprint::fingerprint;
use super::vary::{self, Asked, Varied};
use crate::args::StateArgs;
use crate::error::CliError;
use crate::state_input;

/// The members of `--vary`, `--members` and `--random`.
///
/// # Errors
/// An error of one of the flags.
pub fn varied(
    flags: &[String],
    members: Option<u64>,
    seed: Option<u64>,
    description: &Description,
) -> Result<Members, CliError> {
    let asked = Asked {
        members,
        random: seed.is_some(),
    };
    let varied: Result<Vec<Varied>, CliError> = flags
        .iter()
        .map(|text| vary::parse(text, description, asked))
        .collect();
    let varied = varied?;
    for (index, (name, quantity, _)) in varied.iter().enumerate() {
        if varied[..index]
            .iter()
            .any(|(_, other, _)| other == quantity)
        {
            return Err(CliError::value("--vary", name, "every name once"));
        }
    }
    let count = count(&varied, asked)?;
    Ok(Members::product(varied, seed, count))
}

/// Refuses to vary velocities if the start is given by momenta, and components that the mode of the start lacks.
///
/// # Errors
/// [`CliError::Usage`], [`CliError::Unknown`], or an error of the flags of the state.
pub fn check_start(
    members: &Members,
    model: &dyn AnyModel,
    args: &StateArgs,
) -> Result<(), CliError> {
    for (name, quantity) in members.names().iter().zip(members.quantities()) {
        let present = quantity.check_present(model, name);
        present.map_err(|unknown| CliError::Unknown {
            place: "--vary, --from".to_owned(),
            unknown,
        })?;
    }
    let moved = |quantity: &Quantity| matches!(quantity, Quantity::Velocity(_));
    let has_momenta = state_input::beginning(model, args)?.has_momenta();
    match has_momenta && members.quantities().iter().any(moved) {
        true => Err(CliError::Usage(
            "--p gives momenta, and velocities are varied: give --qdot",
        )),
        false => Ok(()),
    }
}

/// The equally spaced values of each quantity, as both ends and their number; `None` for other values.
pub fn spaced(members: &Members) -> Vec<Option<([f64; 2], u64)>> {
    match members.source() {
        Source::Product { values, .. } => values.iter().map(Values::spaced).collect(),
        Source::Listed { .. } => vec![None; members.quantities().len()],
    }
}

/// Metadata that identify the members.
pub fn metadata(members: &Members) -> Value {
    let (count, names) = (members.count(), members.names());
    match members.source() {
        Source::Listed { rows, .. } => {
            let bits: Vec<u8> = rows.iter().flat_map(|value| value.to_le_bytes()).collect();
            json!({ "count": count, "names": names, "listed": fingerprint(&bits) })
        }
        Source::Product { values, seed } => {
            let varied = names.iter().zip(values);
            let varied: Vec<Value> = varied.map(|(name, values)| spell(name, values)).collect();
            json!({ "count": count, "varied": varied, "seed": seed })
        }
    }
}

/// Number of members that the flags specify.
fn count(varied: &[Varied], asked: Asked) -> Result<u64, CliError> {
    let mut factors = varied.iter().map(|(.., values)| values.count());
    let product = factors.try_fold(1_u64, u64::checked_mul);
    let product = product.ok_or(CliError::Usage(
        "--vary: the number of members exceeds 2^64",
    ))?;
    match (asked.random, asked.members) {
        (true, None) => Err(CliError::Usage("--random needs --members N")),
        (true, Some(_)) if varied.is_empty() => Err(CliError::Usage(
            "--random needs --vary, which names the quantities to draw",
        )),
        (true, Some(count)) => Ok(count),
        (false, Some(count)) if varied.is_empty() && count > 1 => Err(CliError::Usage(
            "--members: all members are equal; vary a quantity with --vary, or give --from",
        )),
        (false, Some(count)) if count != product => Err(CliError::value(
            "--members",
            count.to_string(),
            format!("{product}, the product of the counts of --vary"),
        )),
        (false, _) => Ok(product),
    }
}

fn spell(name: &str, values: &Values) -> Value {
    match values {
        Values::Spaced { ends, count } => json!({ "name": name, "ends": ends, "count": count }),
        Values::List(values) => json!({ "name": name, "values": values }),
        Values::Uniform(ends) => json!({ "name": name, "uniform": ends }),
        Values::Normal { mean, deviation } => {
            json!({ "name": name, "mean": mean, "deviation": deviation })
        }
    }
}

/// A shard: a block of members.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub struct Shard {
    /// Its index, from 1.
    pub index: u64,
    /// Number of shards.
    pub of: u64,
}

impl Shard {
    /// The only shard, with all members.
    pub const WHOLE: Self = Self { index: 1, of: 1 };

    /// Parses `I/N`.
    ///
    /// # Errors
    /// [`CliError::Value`] if the text is not `I/N`, or I is not in 1..=N.
    pub fn parse(text: &str) -> Result<Self, CliError> {
        let parsed = text.split_once('/').and_then(|(index, of)| {
            Some(Self {
                index: index.trim().parse().ok()?,
                of: of.trim().parse().ok()?,
            })
        });
        parsed
            .filter(|shard| (1..=shard.of).contains(&shard.index))
            .ok_or_else(|| CliError::value("--shard", text, "I/N with I from 1 to N, such as 3/8"))
    }

    /// The members of the shard. Shards differ by at most one member in size.
    pub fn range(self, count: u64) -> Range<u64> {
        let bound =
            |index: u64| (u128::from(count) * u128::from(index) / u128::from(self.of)) as u64;
        bound(self.index - 1)..bound(self.index)
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn shards_follow_each_other_without_gap() {
        for (count, of) in [(10, 3), (2, 5), (0, 2), (u64::MAX, 7)] {
            let ranges: Vec<_> = (1..=of)
                .map(|index| Shard { index, of }.range(count))
                .collect();
            assert_eq!(ranges[0].start, 0);
            assert_eq!(ranges[of as usize - 1].end, count);
            assert!(ranges.windows(2).all(|pair| pair[0].end == pair[1].start));
        }
    }
}
