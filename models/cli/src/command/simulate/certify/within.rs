//! Ranges of `--certify-within`.

use dalembert::describe::Assumption;
use dalembert::numbers::Interval;
use dalembert_driver::{AnyModel, Beginning, Form};

use crate::args::CertifyArgs;
use crate::error::CliError;
use crate::{names, scalar};

const FLAG: &str = "--certify-within";

/// Largest absolute value of a factor in an end, and of its reciprocal: products of four such factors neither overflow
/// nor vanish.
const LARGEST: f64 = 1e30;

/// Ranges by the kind of their quantities.
#[derive(Debug, Default)]
pub(super) struct Within {
    pub parameters: Vec<(usize, Interval)>,
    pub positions: Vec<(usize, Interval)>,
    /// Ranges of velocities or quasi-velocities.
    pub rates: Vec<(usize, Interval)>,
    /// All ranges, in the order of the flags.
    pub named: Vec<(String, [f64; 2])>,
}

impl Within {
    /// Parses the ranges. Sets each parameter to the middle of its range.
    ///
    /// # Errors
    /// An unknown name, ends that are not numbers, a range that contradicts the declaration of a parameter.
    pub(super) fn parse(
        model: &mut dyn AnyModel,
        form: Form,
        args: &CertifyArgs,
    ) -> Result<Self, CliError> {
        let mut within = Self::default();
        for text in &args.certify_within {
            within.add(model, form, text)?;
        }
        Ok(within)
    }

    fn add(&mut self, model: &mut dyn AnyModel, form: Form, text: &str) -> Result<(), CliError> {
        let description = model.description();
        if !description.modes.is_empty() {
            return Err(CliError::Usage(
                "--certify-within: a model with modes is certified from a single start only; leave out the ranges",
            ));
        }
        let (name, value) = names::assignment(FLAG, text, "NAME=LO..HI")?;
        let name = &*names::column(name);
        let coordinates: Vec<&str> = names::coordinates(description).collect();
        let velocities: Vec<String> = coordinates.iter().map(|one| names::velocity(one)).collect();
        let is_reduced = form == Form::Reduced;
        let is_start =
            coordinates.contains(&name) || velocities.iter().any(|velocity| velocity == name);
        let is_bound = !description.constraints.is_empty() && !is_reduced;
        if is_start && is_bound {
            return Err(CliError::Usage(
                "--certify-within: the constraints determine the start of a model without reduced form; only parameters may have ranges",
            ));
        }
        let rates: Vec<&str> = match (is_reduced, description.is_first_order) {
            (true, _) => description.quasi_velocities.to_vec(),
            (false, true) => Vec::new(),
            (false, false) => velocities.iter().map(String::as_str).collect(),
        };
        let starts = if is_bound { &[][..] } else { &coordinates };
        let rates = if is_bound { &[][..] } else { &rates };
        let parameters = description
            .parameters
            .iter()
            .map(|parameter| parameter.name);
        let accepted = starts.iter().chain(rates).copied().chain(parameters);
        let what = match is_reduced {
            true => "coordinate, quasi-velocity or parameter",
            false => "coordinate, velocity or parameter",
        };
        let index = names::find(FLAG, what, name, accepted)?;
        let range = range(name, value)?;
        self.named.push((name.to_owned(), [range.lo, range.hi]));
        let after = starts.len() + rates.len();
        if index < starts.len() {
            self.positions.push((index, range));
        } else if index < after {
            self.rates.push((index - starts.len(), range));
        } else {
            let index = index - after;
            let assumption = description.parameters[index].assumption;
            let is_split = assumption == Assumption::NonZero && !range.excludes_zero();
            if is_split || !assumption.holds(range.lo) || !assumption.holds(range.hi) {
                let expected = format!("a range of values {assumption}");
                return Err(CliError::value(format!("{FLAG} {name}"), value, expected));
            }
            model.set_parameter(index, range.middle());
            self.parameters.push((index, range));
        }
        Ok(())
    }

    /// Sets positions of the start to the middles of their ranges, and velocities if the form is not reduced.
    ///
    /// # Errors
    /// Ranges of velocities together with momenta.
    pub(super) fn begin(&self, form: Form, beginning: &mut Beginning) -> Result<(), CliError> {
        for &(index, range) in &self.positions {
            beginning.set_position(index, range.middle());
        }
        if form == Form::Reduced {
            return Ok(());
        }
        if !self.rates.is_empty() && beginning.has_momenta() {
            return Err(CliError::Usage(
                "--certify-within: ranges of velocities need --qdot in place of --p",
            ));
        }
        for &(index, range) in &self.rates {
            beginning.set_velocity(index, range.middle());
        }
        Ok(())
    }
}

/// Parses `LO..HI`. Ends that are not doubles are moved outward.
fn range(name: &str, text: &str) -> Result<Interval, CliError> {
    let ends = || {
        let (lo, hi) = text.split_once("..")?;
        let is_clear = !hi.starts_with('.') && !hi.contains("..");
        let range = Interval::new(end(lo, f64::next_down)?, end(hi, f64::next_up)?);
        (is_clear && range.lo <= range.hi).then_some(range)
    };
    ends().ok_or_else(|| {
        let expected = "LO..HI with LO not above HI, such as 0.99..1.01 or -pi/2..pi/2";
        CliError::value(format!("{FLAG} {name}"), text, expected)
    })
}

/// Parses an end, and moves it outward by a bound of its rounding error.
fn end(text: &str, further: fn(f64) -> f64) -> Option<f64> {
    let text = text.trim();
    let value = scalar::parse(text).ok()?;
    let factors = || text.split(['*', '/']).map(str::trim);
    let is_decimal = !text.contains("pi") && factors().count() == 1;
    if is_decimal && is_exact(text, value) {
        return Some(value);
    }
    let moves = match is_decimal {
        true => 1,
        // Each factor and each product is rounded.
        false => 4 * factors().count(),
    };
    let is_moderate = |factor: &str| {
        scalar::parse(factor).is_ok_and(|factor| {
            let size = factor.abs();
            size == 0.0 || (1.0 / LARGEST..=LARGEST).contains(&size)
        })
    };
    let is_short = factors().count() <= 4 && factors().all(is_moderate);
    if !is_decimal && !is_short {
        return None;
    }
    let moved = (0..moves).fold(value, |value, _| further(value));
    moved.is_finite().then_some(moved)
}

/// True if a decimal is exactly a double.
fn is_exact(text: &str, value: f64) -> bool {
    let digits = |text: &str| {
        let text = text.trim_start_matches(['+', '-']);
        let (whole, rest) = text.split_once('.').unwrap_or((text, ""));
        let (whole, rest) = (whole.trim_start_matches('0'), rest.trim_end_matches('0'));
        format!("{whole}.{rest}")
    };
    // The decimal expansion of a double ends after at most 1074 digits.
    digits(text) == digits(&format!("{value:.1074}"))
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn ends_that_are_no_doubles_are_moved_outward() {
        let ends = |text| {
            let range = range("x", text).unwrap_or(Interval::WHOLE);
            [range.lo, range.hi]
        };
        assert_eq!(ends("0.5..1"), [0.5, 1.0]);
        assert_eq!(ends("-02.50..+3."), [-2.5, 3.0]);
        assert_eq!(ends("0.1..0.1"), [0.1_f64.next_down(), 0.1_f64.next_up()]);
        let [lo, hi] = ends("-pi/2..pi/2");
        assert!(lo < -std::f64::consts::FRAC_PI_2 && hi > std::f64::consts::FRAC_PI_2);
        assert!(hi - lo < 1.000_001 * std::f64::consts::PI);
    }

    #[test]
    fn what_is_no_range_is_refused() {
        for text in [
            "",
            "1",
            "2..1",
            "1..",
            "..1",
            "0...1",
            "1..x",
            "1..inf",
            "1e200*1e-200*1..2",
        ] {
            assert!(range("x", text).is_err(), "{text}");
        }
    }
}
