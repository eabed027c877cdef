//! `orbit --modulo xi1, xi2, ..`: vector fields with a proof that they are symmetries of a model, its surfaces and
//! their maps.

use std::cell::RefCell;
use std::collections::BTreeSet;

use dalembert_expr::{ExprId, SymbolId};
use proc_macro2::{TokenStream, TokenTree};

use super::request::{Asked, Whole};
use super::{ReportError, tokens};
use crate::claims::{Fields, check_equivariance};
use crate::model::Model;

/// A symmetry whose flow is affine in the coordinates: `dq/ds = linear q + constant`.
#[derive(Debug, Clone, PartialEq)]
pub struct Symmetry {
    /// The field as written.
    pub text: String,
    /// Names of the coordinates of all modes.
    pub coordinates: Vec<String>,
    /// Derivative of the field: N rows of N.
    pub linear: Vec<Vec<f64>>,
    /// The field at the origin, N entries.
    pub constant: Vec<f64>,
    /// Names of the parameters that the field depends on.
    pub parameters: Vec<String>,
    /// True if the momentum of the field is proved to be conserved, also at surfaces.
    pub keeps_momentum: bool,
}

impl Symmetry {
    /// The field 0.
    fn of_none(text: String) -> Self {
        Self {
            text,
            coordinates: Vec::new(),
            linear: Vec::new(),
            constant: Vec::new(),
            parameters: Vec::new(),
            keeps_momentum: true,
        }
    }

    /// Index of a coordinate. A new coordinate is added.
    fn index(&mut self, name: &str) -> usize {
        if let Some(known) = self.coordinates.iter().position(|known| known == name) {
            return known;
        }
        self.coordinates.push(name.to_owned());
        self.linear.iter_mut().for_each(|row| row.push(0.0));
        let length = self.coordinates.len();
        self.linear.push(vec![0.0; length]);
        self.constant.push(0.0);
        length - 1
    }
}

/// Proves that the vector fields in a list, written as in claims, are symmetries at the given values of parameters.
/// `part` names a scene. In a model with modes, each mode uses the terms whose `partial(..)` name its coordinates.
///
/// # Errors
/// [`ReportError`] for a field without such a proof, with the place where the proof fails, and for a flow that is not
/// affine.
pub fn symmetries(
    source: &str,
    part: Option<&str>,
    fields: &str,
    parameters: &[(&str, f64)],
) -> Result<Vec<Symmetry>, ReportError> {
    Asked::check_list(fields, "partial(x), partial(y)")?;
    tokens(fields)?;
    let written = parts(fields);
    if written.iter().any(String::is_empty) {
        let help = "write fields such as `partial(x)`, separated by commas";
        return Err(Asked::refusal("a field is missing", help));
    }
    let known = RefCell::new(BTreeSet::new());
    let whole = Whole::of(source, part, &|coordinates| {
        known.borrow_mut().extend(coordinates.iter().cloned());
        let claims = written.iter().map(|field| claim(field, coordinates));
        claims.collect()
    })?;
    let known = known.into_inner();
    let unknown = (written.iter().filter(|_| !known.is_empty()))
        .flat_map(|field| named(&tokens(field).unwrap_or_default()))
        .find(|name| !known.contains(name));
    if let Some(name) = unknown {
        let text = format!("`{name}` is not a coordinate of any mode");
        return Err(Asked::refusal(text, ""));
    }
    let mut found = Vec::new();
    for (index, text) in written.iter().enumerate() {
        found.push(symmetry(&whole, index, text, parameters)?);
    }
    Ok(found)
}

/// Splits a list at its commas outside of brackets.
fn parts(list: &str) -> Vec<String> {
    let (mut parts, mut depth) = (vec![String::new()], 0);
    for letter in list.chars() {
        depth += match letter {
            '(' | '[' => 1,
            ')' | ']' => -1,
            _ => 0,
        };
        match parts.last_mut() {
            Some(part) if letter != ',' || depth > 0 => part.push(letter),
            _ => parts.push(String::new()),
        }
    }
    parts.iter().map(|part| part.trim().to_owned()).collect()
}

/// A claim of symmetry with those terms of a field whose `partial(..)` name only the given coordinates, or with all
/// terms if `coordinates` is empty. `None` if no term is left.
fn claim(field: &str, coordinates: &[String]) -> Option<String> {
    let kept = match (field.parse(), coordinates) {
        (Ok(tokens), [_, ..]) => restricted(tokens, coordinates),
        _ => field.to_owned(),
    };
    (!kept.is_empty()).then(|| format!("symmetry: {kept}"))
}

/// The terms of a sum whose `partial(..)` name given coordinates only.
fn restricted(tokens: TokenStream, coordinates: &[String]) -> String {
    let mut terms: Vec<Vec<TokenTree>> = vec![Vec::new()];
    for token in tokens {
        let is_sign =
            matches!(&token, TokenTree::Punct(sign) if ['+', '-'].contains(&sign.as_char()));
        if let (true, Some(last)) = (is_sign, terms.last())
            && last
                .iter()
                .any(|token| !matches!(token, TokenTree::Punct(_)))
        {
            terms.push(Vec::new());
        }
        terms
            .last_mut()
            .into_iter()
            .for_each(|last| last.push(token.clone()));
    }
    let is_known = |term: &[TokenTree]| {
        let term = TokenStream::from_iter(term.iter().cloned());
        named(&term).iter().all(|name| coordinates.contains(name))
    };
    let kept = terms.iter().filter(|term| is_known(term));
    let kept: TokenStream = kept.flatten().cloned().collect();
    kept.to_string()
}

/// The coordinates `x` of all `partial(x)` in a sum.
fn named(tokens: &TokenStream) -> Vec<String> {
    let tokens: Vec<TokenTree> = tokens.clone().into_iter().collect();
    let mut names = Vec::new();
    for (index, token) in tokens.iter().enumerate() {
        let TokenTree::Group(group) = token else {
            continue;
        };
        match index.checked_sub(1).map(|before| &tokens[before]) {
            Some(TokenTree::Ident(name)) if name == "partial" => {
                names.push(group.stream().to_string().replace(' ', ""));
            }
            _ => names.extend(named(&group.stream())),
        }
    }
    names
}

/// The field with this index, with the proof on every mode.
fn symmetry(
    whole: &Whole,
    index: usize,
    text: &str,
    parameters: &[(&str, f64)],
) -> Result<Symmetry, ReportError> {
    let models: Vec<&Model> = whole.modes.iter().map(|mode| &mode.model).collect();
    let fields: Vec<Vec<ExprId>> = (whole.modes.iter())
        .map(|mode| mode.fields[index].clone())
        .collect();
    let all = Fields {
        others: if models.len() > 1 { &models } else { &[] },
        fields: &fields,
    };
    let mut found = Symmetry::of_none(text.to_owned());
    for (number, mode) in whole.modes.iter().enumerate() {
        let refuse = |reason: String| {
            let place = match &mode.name {
                Some(name) => format!("mode `{name}`, "),
                None => String::new(),
            };
            let text = format!("`{}` is not a proved symmetry: {place}{reason}", found.text);
            Asked::refusal(text, "")
        };
        let mut model = mode.model.clone();
        let kept = check_equivariance(&mut model, &mode.derivation, &all, number, 0);
        found.keeps_momentum &= kept.map_err(refuse)?;
        if let Err(name) = add(&mut found, &mut model, &fields[number], parameters) {
            let text = format!(
                "`{}`: its flow is not affine in the coordinates, because the factor of `partial({name})` is not affine in them with constant coefficients",
                found.text
            );
            return Err(Asked::refusal(
                text,
                "use translations, rotations and their sums, such as `partial(x)` and `x*partial(y) - y*partial(x)`; write the model in coordinates in which the symmetry is one of these",
            ));
        }
    }
    Ok(found)
}

/// Adds matrix and constant of a field on one mode.
///
/// # Errors
/// The coordinate whose component is not affine.
fn add(
    found: &mut Symmetry,
    model: &mut Model,
    field: &[ExprId],
    parameters: &[(&str, f64)],
) -> Result<(), String> {
    let symbols: Vec<SymbolId> = model.coordinates.iter().map(|one| one.q).collect();
    let names: Vec<String> = (model.coordinates.iter())
        .map(|one| one.name.display.clone())
        .collect();
    let places: Vec<usize> = names.iter().map(|name| found.index(name)).collect();
    let zero = model.pool.zero();
    let origin: Vec<(SymbolId, ExprId)> = symbols.iter().map(|q| (*q, zero)).collect();
    let mut moving = symbols.clone();
    moving.push(model.time);
    for (component, row) in field.iter().zip(&places) {
        let slopes: Vec<ExprId> = symbols
            .iter()
            .map(|q| {
                let slope = model.pool.diff(*component, *q);
                model.pool.simplify(slope)
            })
            .collect();
        if slopes
            .iter()
            .any(|slope| model.pool.depends_on_any(*slope, &moving))
        {
            return Err(found.coordinates[*row].clone());
        }
        let constant = model.pool.substitute(*component, &origin);
        let mut roots = slopes;
        roots.push(constant);
        for parameter in &model.parameters {
            let name = &parameter.name.display;
            let is_used = roots
                .iter()
                .any(|root| model.pool.depends_on(*root, parameter.symbol));
            if is_used && !found.parameters.contains(name) {
                found.parameters.push(name.clone());
            }
        }
        let value = |symbol: SymbolId| {
            let named = model.parameters.iter().find(|one| one.symbol == symbol);
            let named = named.and_then(|one| {
                parameters
                    .iter()
                    .find(|(name, _)| *name == one.name.display)
            });
            named.map_or(f64::NAN, |(_, value)| *value)
        };
        let values = model.pool.eval(&roots, &value);
        for (value, column) in values.iter().zip(&places) {
            found.linear[*row][*column] = *value;
        }
        found.constant[*row] = values[symbols.len()];
    }
    Ok(())
}
