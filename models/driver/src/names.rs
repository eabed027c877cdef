//! Names of a model's quantities, and their lookup.

use std::fmt::{self, Write as _};

use dalembert::describe::Description;

use crate::ensemble::row::OUTPUT;

/// A name that is not among the accepted ones.
#[derive(Debug, Clone, PartialEq, Eq)]
pub struct Unknown {
    /// Kind of the named thing: `parameter`, `surface`.
    pub what: &'static str,
    /// The mode of the model in which names are accepted, if only those of one mode are.
    pub mode: Option<&'static str>,
    /// The name that was given.
    pub given: String,
    /// The accepted names.
    pub accepted: Vec<String>,
}

impl fmt::Display for Unknown {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        let Self {
            what,
            mode,
            given,
            accepted,
        } = self;
        write!(f, "unknown {what} `{given}`")?;
        if let Some(mode) = mode {
            write!(f, " in mode `{mode}`, in which the motion starts")?;
        }
        f.write_str(&hints(given, accepted))
    }
}

impl std::error::Error for Unknown {}

/// The position of `given` among `accepted`. A name of the language, such as `dot(theta[2])`, stands for its [`column()`].
///
/// # Errors
/// [`Unknown`] if `given` is not among them.
pub fn find<'a>(
    what: &'static str,
    given: &str,
    accepted: impl Iterator<Item = &'a str> + Clone,
) -> Result<usize, Unknown> {
    let place = |given: &str| accepted.clone().position(|name| name == given);
    place(given)
        .or_else(|| place(&column(given)))
        .ok_or_else(|| Unknown {
            what,
            mode: None,
            given: given.to_owned(),
            accepted: accepted.map(str::to_owned).collect(),
        })
}

/// The name of a coordinate's velocity: `x_dot`, `theta_dot.3`.
pub fn velocity(coordinate: &str) -> String {
    match coordinate.split_once('.') {
        Some((family, member)) => format!("{family}_dot.{member}"),
        None => format!("{coordinate}_dot"),
    }
}

/// The name of a coordinate's momentum: `p_x`, `p_theta.3`.
pub fn momentum(coordinate: &str) -> String {
    format!("p_{coordinate}")
}

/// The name of a column for a name of the language: `theta_dot.2` for `dot(theta[2])`, `p_x` for `momentum(x)`,
/// `theta.2` for `theta[2]`. Any other name is itself.
pub fn column(given: &str) -> String {
    let given = given.trim();
    let of = |function: &str| {
        let rest = given.strip_prefix(function)?.trim_start();
        let inner = rest.strip_prefix('(')?.strip_suffix(')')?;
        Some(member(inner.trim()))
    };
    if let Some(coordinate) = of("dot") {
        velocity(&coordinate)
    } else if let Some(coordinate) = of("momentum") {
        momentum(&coordinate)
    } else {
        member(given)
    }
}

/// `theta.2` for the member `theta[2]` of a family.
fn member(name: &str) -> String {
    let split = name.strip_suffix(']').and_then(|name| name.split_once('['));
    match split.map(|(family, index)| (family.trim(), index.trim())) {
        Some((family, index)) if index.parse::<u64>().is_ok() => format!("{family}.{index}"),
        _ => name.to_owned(),
    }
}

/// The columns of the outputs in tables of runs, in order: their names, or `out.NAME` for those with the name of another
/// column.
pub fn outputs(description: &Description) -> impl Iterator<Item = String> {
    description.outputs.iter().map(|output| {
        match OTHER_COLUMNS.contains(output) || is_quantity(description, output) {
            true => format!("{OUTPUT}{output}"),
            false => (*output).to_owned(),
        }
    })
}

/// The column of a table of runs for something that is no quantity of the model: this name, or `run.NAME` if a quantity that
/// a table of members may have is called so.
pub fn of_run(description: &Description, name: &str) -> String {
    match is_quantity(description, name) {
        true => format!("run.{name}"),
        false => name.to_owned(),
    }
}

/// True for the name of a coordinate, a velocity or a parameter: tables of members have such columns.
pub fn is_quantity(description: &Description, name: &str) -> bool {
    let mut parameters = description.parameters.iter();
    parameters.any(|parameter| parameter.name == name)
        || coordinates(description)
            .any(|coordinate| coordinate == name || velocity(coordinate) == name)
}

/// Columns of tables of runs that belong to no quantity of the model's own.
const OTHER_COLUMNS: [&str; 4] = ["t", "energy", "mode", "event"];

/// The names of the coordinates, in order.
pub fn coordinates(description: &Description) -> impl Iterator<Item = &'static str> + Clone {
    description
        .coordinates
        .iter()
        .map(|coordinate| coordinate.name)
}

/// The names of the surfaces, in order.
pub fn surfaces(description: &Description) -> impl Iterator<Item = &'static str> + Clone {
    description.surfaces.iter().map(|surface| surface.name)
}

/// Text with the nearest accepted name, if one is near, and all accepted names.
fn hints(given: &str, accepted: &[String]) -> String {
    let mut text = String::new();
    if let Some(nearest) = nearest(given, accepted) {
        let _ = write!(text, "; did you mean `{nearest}`?");
    }
    match accepted {
        [] => text.push_str("; there are none"),
        names => {
            let _ = write!(text, "\n  accepted: {}", names.join(", "));
        }
    }
    text
}

/// The accepted name nearest to `given`, unless more than a third of its letters differ.
fn nearest<'a>(given: &str, accepted: &'a [String]) -> Option<&'a String> {
    let lower = given.to_lowercase();
    let distance = |name: &String| strsim::damerau_levenshtein(&lower, &name.to_lowercase());
    let best = accepted.iter().min_by_key(|name| distance(name))?;
    (distance(best) <= lower.chars().count().div_ceil(3)).then_some(best)
}

#[cfg(test)]
mod tests {
    use super::*;

    fn unknown(given: &str, accepted: &[&str]) -> String {
        let found = find("model", given, accepted.iter().copied());
        found.expect_err("no such name").to_string()
    }

    #[test]
    fn a_near_name_is_suggested_and_all_are_listed() {
        let text = unknown("roling_disk", &["pendulum", "rolling_disk"]);
        assert_eq!(
            text,
            "unknown model `roling_disk`; did you mean `rolling_disk`?\n  accepted: pendulum, rolling_disk"
        );
    }

    #[test]
    fn names_of_the_language_are_found() {
        let cases = [
            ("dot(theta)", "theta_dot"),
            (" dot( theta[12] ) ", "theta_dot.12"),
            ("theta[ 2 ]", "theta.2"),
            ("momentum(x[1])", "p_x.1"),
            ("x_dot.3", "x_dot.3"),
            ("sin(x)", "sin(x)"),
            ("x[i]", "x[i]"),
        ];
        for (given, expected) in cases {
            assert_eq!(column(given), expected);
        }
        let accepted = ["x.1", "x.2", "x_dot.1", "x_dot.2"];
        let place = |given| find("velocity", given, accepted.into_iter()).ok();
        assert_eq!(place("dot(x[2])"), Some(3));
        assert_eq!(place("x[2]"), Some(1));
        assert_eq!(place("dot(y[2])"), None);
        // A name that is accepted as it is comes first.
        assert_eq!(
            find("name", "dot(x)", ["x_dot", "dot(x)"].into_iter()),
            Ok(1)
        );
    }

    #[test]
    fn a_far_name_is_not_suggested() {
        assert_eq!(
            unknown("zzz", &["pendulum"]),
            "unknown model `zzz`\n  accepted: pendulum"
        );
        assert_eq!(unknown("zzz", &[]), "unknown model `zzz`; there are none");
    }
}
