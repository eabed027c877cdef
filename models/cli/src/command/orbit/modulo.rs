//! `orbit --modulo`: symmetries up to which an orbit closes, and coordinates that drift if a symmetry is not given.

use dalembert::OrbitError;
use dalembert_codegen::report::{ReportError, Symmetry, symmetries};
use dalembert_driver::{AnyModel, Generator, Origin, Search, Symmetries};

use crate::args::OrbitArgs;
use crate::error::CliError;
use crate::names;

/// Smallest change of a coordinate in one return that counts as drift, relative to values above 1.
const DRIFT: f64 = 1e-6;

/// Largest number of drifting coordinates for which all sums of their fields are tried.
const TOGETHER: u32 = 6;

/// Coordinates that change from return to return although the motion does not depend on them.
pub(super) struct Drift {
    /// Names and changes in the first return.
    pub changes: Vec<(String, f64)>,
    /// The value of `--modulo`.
    pub fields: String,
}

/// The symmetries of the flag, if it is given.
///
/// # Errors
/// A field that is not a proved symmetry; fields that do not generate a group; a field that depends on the parameter of
/// `--continue`.
pub(super) fn group(
    model: &dyn AnyModel,
    args: &OrbitArgs,
) -> Result<Option<Symmetries>, CliError> {
    let Some(fields) = &args.modulo else {
        return Ok(None);
    };
    let found = proved(model, args, fields);
    let found = found.map_err(|error| CliError::Modulo(error.to_string()))?;
    let continued = args.branch.range.as_deref().unwrap_or_default();
    let continued = continued.split('=').next().unwrap_or_default().trim();
    if let Some(field) = found
        .iter()
        .find(|field| field.parameters.iter().any(|name| name == continued))
    {
        let text = format!(
            "`{}` depends on `{continued}`, which --continue changes: the group has to be the same all along a branch",
            field.text
        );
        return Err(CliError::Modulo(text));
    }
    let generators = found.iter().map(|field| generator(model, field));
    Symmetries::of(generators.collect())
        .map(Some)
        .map_err(|error| CliError::Modulo(error.to_string()))
}

/// Proves that the listed fields are symmetries at the model's parameter values, and returns them.
fn proved(
    model: &dyn AnyModel,
    args: &OrbitArgs,
    fields: &str,
) -> Result<Vec<Symmetry>, ReportError> {
    let description = model.description();
    let names = description
        .parameters
        .iter()
        .map(|parameter| parameter.name);
    let values: Vec<(&str, f64)> = names
        .enumerate()
        .map(|(index, name)| (name, model.parameter(index)))
        .collect();
    let scene = Some(args.model.scene.as_str()).filter(|scene| *scene != "all");
    symmetries(&description.source, scene, fields, &values)
}

/// A symmetry with its coefficients in the order of the model's coordinates.
fn generator(model: &dyn AnyModel, field: &Symmetry) -> Generator {
    let names: Vec<&str> = names::coordinates(model.description()).collect();
    let places: Vec<Option<usize>> = names
        .iter()
        .map(|name| field.coordinates.iter().position(|known| known == name))
        .collect();
    let entry = |row: Option<usize>, column: Option<usize>| match (row, column) {
        (Some(row), Some(column)) => field.linear[row][column],
        _ => 0.0,
    };
    let rows = places.iter().map(|row| {
        let entries = places.iter().map(|column| entry(*row, *column));
        entries.collect()
    });
    Generator {
        name: field.text.clone(),
        linear: rows.collect(),
        constant: (places.iter())
            .map(|row| row.map_or(0.0, |row| field.constant[row]))
            .collect(),
        keeps_momentum: field.keeps_momentum,
    }
}

/// The coordinates that drift in the first return of a search that did not converge, if translations along them are
/// proved symmetries.
pub(super) fn drift(
    model: &dyn AnyModel,
    args: &OrbitArgs,
    origin: &Origin,
    search: &Search,
    missed: &OrbitError,
) -> Option<Drift> {
    // A drift may make the search fail with any of the other errors.
    if matches!(missed, OrbitError::DependsOnTime) || search.modulo.is_some() {
        return None;
    }
    let [first, next] = model.returned(origin, search).ok()??.ok()?;
    let description = model.description();
    let names: Vec<&str> = names::coordinates(description).collect();
    let change = |index: usize| next.q[index] - first.q[index];
    let drifts =
        |index: &usize| change(*index).abs() > DRIFT * f64::max(1.0, first.q[*index].abs());
    let drifting: Vec<usize> = (0..names.len()).filter(drifts).collect();
    let is_proved = |fields: &str| proved(model, args, fields).is_ok();
    let field = |index: &usize| format!("partial({})", names[*index]);
    let mut fields = Vec::new();
    let mut moved: Vec<usize> = Vec::new();
    for index in &drifting {
        if is_proved(&field(index)) {
            fields.push(field(index));
            moved.push(*index);
        }
    }
    if fields.is_empty() && !description.modes.is_empty() && drifting.len() <= TOGETHER as usize {
        // The coordinates of other modes drift together with those of this one, so every sum contains their fields.
        let absent = (0..names.len()).filter(|index| first.q[*index].is_nan());
        let absent: Vec<String> = absent.map(|index| field(&index)).collect();
        let sums = 1..1_usize << drifting.len();
        let chosen = |sum: usize| {
            let numbered = drifting.iter().enumerate();
            numbered
                .filter(move |(bit, _)| sum >> bit & 1 == 1)
                .map(|(_, index)| *index)
        };
        let text = |sum: usize| {
            let terms: Vec<String> = chosen(sum).map(|index| field(&index)).collect();
            [terms, absent.clone()].concat().join(" + ")
        };
        let sum = sums.into_iter().find(|sum| is_proved(&text(*sum)))?;
        fields.push(text(sum));
        moved.extend(chosen(sum));
    }
    let changes = moved
        .iter()
        .map(|index| (names[*index].to_owned(), change(*index)));
    let changes: Vec<_> = changes.collect();
    (!changes.is_empty()).then(|| Drift {
        changes,
        fields: fields.join(", "),
    })
}

impl Drift {
    /// The reason and the remedy in words.
    pub fn remarks(&self) -> [(&'static str, String); 2] {
        let changes = self.changes.iter();
        let changes: Vec<String> = changes
            .map(|(name, change)| format!("`{name}` changes by {change:.6} in a return"))
            .collect();
        let them = if self.changes.len() > 1 { "them" } else { "it" };
        let reason = format!(
            "{}, and the motion does not depend on {them}",
            changes.join(", ")
        );
        [
            ("reason", reason),
            ("try", format!("--modulo \"{}\"", self.fields)),
        ]
    }
}
