//! Diagnostics: collects all errors of a stage and turns them into compile errors.
//!
//! An error has one text and at least one place. Stable Rust shows one text per place. Help is therefore part of the
//! text, and an error about several declarations becomes one compile error at each of them.

use std::fmt;

use proc_macro2::{Group, Ident, Punct, Spacing, Span, TokenStream, TokenTree};

use crate::spec::STEPS;

/// A range of source code, from its first to its last token.
#[derive(Debug, Clone, Copy)]
pub struct Location {
    /// The first token.
    pub first: Span,
    /// The last token.
    pub last: Span,
}

impl Location {
    /// The location of a single token.
    pub fn of(token: &TokenTree) -> Self {
        Self::from(token.span())
    }

    /// The location from the beginning of `self` to the end of `end`.
    pub fn to(self, end: Self) -> Self {
        Self {
            first: self.first,
            last: end.last,
        }
    }

    /// The opening brace of `group`: the location of an error about something missing in the group.
    pub fn opening(group: &Group) -> Self {
        Self::from(group.span_open())
    }
}

impl From<Span> for Location {
    fn from(span: Span) -> Self {
        Self {
            first: span,
            last: span,
        }
    }
}

/// The errors of a stage, in the order of their detection.
#[derive(Debug, Default)]
pub struct Diagnostics {
    errors: Vec<Diagnostic>,
}

/// An error: its places with their texts. If it is about a refuted claim, also the state that refutes it.
#[derive(Debug)]
pub struct Diagnostic {
    places: Vec<(Location, String)>,
    counterexample: Option<Counterexample>,
}

/// A state that refutes a claim.
#[derive(Debug, Clone, PartialEq)]
pub struct Counterexample {
    /// Names and values of the state, parameters included.
    pub at: Vec<(String, f64)>,
    /// Names and values of the quantities that contradict the claim there.
    pub values: Vec<(String, f64)>,
}

impl Diagnostics {
    /// Number of errors from which [`Diagnostics::error_once`] ignores further ones.
    const MOST: usize = 1000;

    /// An empty collection.
    pub fn new() -> Self {
        Self::default()
    }

    /// True if there are no errors.
    pub fn is_empty(&self) -> bool {
        self.errors.is_empty()
    }

    /// Number of errors.
    pub fn len(&self) -> usize {
        self.errors.len()
    }

    /// Records an error at a place. Help and further places may be added to the returned diagnostic.
    pub fn error(&mut self, at: Location, text: impl Into<String>) -> &mut Diagnostic {
        self.errors.push(Diagnostic {
            places: vec![(at, text.into())],
            counterexample: None,
        });
        let last = self.errors.len() - 1;
        &mut self.errors[last]
    }

    /// Records an error with help, unless an error with the same text and help exists. A mistake in the body of a
    /// family or a definition is found at each of its uses, but reported only once.
    pub fn error_once(&mut self, at: Location, text: impl Into<String>, help: impl fmt::Display) {
        if self.len() >= Self::MOST {
            return;
        }
        let full = with_help(text.into(), help);
        if !self.errors.iter().any(|error| error.message() == full) {
            self.error(at, full);
        }
    }

    /// Appends the errors of another collection.
    pub fn extend(&mut self, others: Self) {
        self.errors.extend(others.errors);
    }

    /// Appends the errors of another collection that are not in this one. Declarations shared by several modes are
    /// checked for each mode, but their mistakes are reported only once.
    pub fn extend_once(&mut self, others: Self) {
        for error in others.errors {
            let text = error.message().to_owned();
            let is_new = !self.errors.iter().any(|error| error.message() == text);
            if is_new {
                self.errors.push(error);
            }
        }
    }

    /// Returns `value` if there are no errors.
    ///
    /// # Errors
    /// The errors, if there are any.
    pub fn finish<T>(self, value: T) -> Result<T, Self> {
        if self.is_empty() {
            Ok(value)
        } else {
            Err(self)
        }
    }

    /// The errors in the order of their detection.
    pub fn iter(&self) -> impl Iterator<Item = &Diagnostic> {
        self.errors.iter()
    }

    /// One `compile_error!` for each place of each error.
    pub fn into_compile_error(self) -> TokenStream {
        let places = self.errors.into_iter().flat_map(|error| error.places);
        places.map(|(at, text)| compile_error(at, &text)).collect()
    }
}

impl Diagnostic {
    /// Adds a help line to the last place of the error.
    pub fn help(&mut self, help: impl fmt::Display) -> &mut Self {
        if let Some((_, text)) = self.places.last_mut() {
            *text = with_help(std::mem::take(text), help);
        }
        self
    }

    /// Adds a place with its own text.
    pub fn also(&mut self, at: Location, text: impl Into<String>) -> &mut Self {
        self.places.push((at, text.into()));
        self
    }

    /// Sets the state that refutes a claim.
    pub fn refuted_by(&mut self, counterexample: Option<Counterexample>) -> &mut Self {
        self.counterexample = counterexample;
        self
    }

    /// The state that refutes a claim, if the error is about one.
    pub fn counterexample(&self) -> Option<&Counterexample> {
        self.counterexample.as_ref()
    }

    /// The text at the first place, help included.
    pub fn message(&self) -> &str {
        self.places.first().map_or("", |(_, text)| text)
    }

    /// All places with their texts; at least one.
    pub fn places(&self) -> &[(Location, String)] {
        &self.places
    }
}

/// The error for a model whose algebra exceeded its budget at a place.
pub(crate) fn too_many_steps(at: Location) -> Diagnostics {
    let mut diagnostics = Diagnostics::new();
    let text = format!("the algebra takes more than {STEPS} steps; it was given up here");
    let help = "use fewer terms and factors, or fewer coordinates that depend on each other";
    diagnostics.error(at, text).help(help);
    diagnostics
}

/// The error for `#[global]` before a model with modes.
pub fn global_of_modes(at: Location) -> Diagnostics {
    let mut diagnostics = Diagnostics::new();
    diagnostics
        .error(at, "the modes of a model always have their global forms")
        .help("leave out `#[global]`");
    diagnostics
}

/// The text with a help line. An empty help adds nothing.
fn with_help(text: String, help: impl fmt::Display) -> String {
    let help = help.to_string();
    if help.is_empty() {
        text
    } else {
        format!("{text}\nhelp: {help}")
    }
}

/// `::core::compile_error! { text }` with spans such that the compiler underlines `at`.
fn compile_error(at: Location, text: &str) -> TokenStream {
    let punct = |character, spacing| {
        let mut punct = Punct::new(character, spacing);
        punct.set_span(at.first);
        TokenTree::from(punct)
    };
    let mut message = proc_macro2::Literal::string(text);
    message.set_span(at.last);
    let mut body = Group::new(
        proc_macro2::Delimiter::Brace,
        TokenTree::from(message).into(),
    );
    body.set_span(at.last);
    [
        punct(':', Spacing::Joint),
        punct(':', Spacing::Alone),
        Ident::new("core", at.first).into(),
        punct(':', Spacing::Joint),
        punct(':', Spacing::Alone),
        Ident::new("compile_error", at.first).into(),
        punct('!', Spacing::Alone),
        body.into(),
    ]
    .into_iter()
    .collect()
}

/// The candidate most similar to `name`: at most one edit per three letters (rounded up), and fewer edits than the
/// candidate has letters. `None` if no candidate is that similar.
pub fn nearest<'a>(name: &str, candidates: impl IntoIterator<Item = &'a str>) -> Option<&'a str> {
    let limit = name.chars().count().div_ceil(3);
    let near = candidates
        .into_iter()
        .map(|candidate| (edit_distance(name, candidate), candidate));
    near.filter(|(distance, candidate)| *distance <= limit && *distance < candidate.chars().count())
        .min_by_key(|(distance, _)| *distance)
        .map(|(_, candidate)| candidate)
}

/// Number of insertions, deletions, replacements and swaps of adjacent letters that turn one word into the other. Upper
/// and lower case count as equal.
fn edit_distance(left: &str, right: &str) -> usize {
    let left: Vec<char> = left.to_lowercase().chars().collect();
    let right: Vec<char> = right.to_lowercase().chars().collect();
    let mut before_last = Vec::new();
    let mut last: Vec<usize> = (0..=right.len()).collect();
    for (i, a) in left.iter().enumerate() {
        let mut row = vec![i + 1];
        for (j, b) in right.iter().enumerate() {
            let replaced = last[j] + usize::from(a != b);
            let mut least = replaced.min(last[j + 1] + 1).min(row[j] + 1);
            if i > 0 && j > 0 && *a == right[j - 1] && left[i - 1] == *b {
                least = least.min(before_last_at(&before_last, j - 1) + 1);
            }
            row.push(least);
        }
        before_last = std::mem::replace(&mut last, row);
    }
    last[right.len()]
}

/// The entry of the row before the last. It exists wherever the algorithm reads it.
fn before_last_at(row: &[usize], index: usize) -> usize {
    row.get(index).copied().unwrap_or(usize::MAX - 1)
}

/// The words in backticks as a list: `` `a`, `b` and `c` ``.
pub fn listed<'a>(words: impl IntoIterator<Item = &'a str>) -> String {
    let quoted: Vec<String> = words.into_iter().map(|word| format!("`{word}`")).collect();
    match quoted.split_last() {
        None => String::new(),
        Some((only, [])) => only.clone(),
        Some((last, rest)) => format!("{} and {last}", rest.join(", ")),
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn the_nearest_name_is_within_one_edit_for_three_letters() {
        assert_eq!(nearest("thta", ["x", "theta", "phi"]), Some("theta"));
        assert_eq!(nearest("sinn", ["sin", "sinh", "cos"]), Some("sin"));
        assert_eq!(nearest("tehta", ["theta"]), Some("theta"));
        assert_eq!(nearest("banana", ["x", "theta"]), None);
        assert_eq!(nearest("y", ["x"]), None);
    }

    #[test]
    fn every_place_becomes_a_compile_error() {
        let mut diagnostics = Diagnostics::new();
        let here = Location::from(Span::call_site());
        diagnostics
            .error(here, "`x` declared again")
            .help("choose another name")
            .also(here, "first declared here");
        let text = diagnostics.into_compile_error().to_string();
        assert_eq!(text.matches("compile_error").count(), 2);
        assert!(text.contains("help: choose another name"));
    }

    #[test]
    fn the_same_mistake_is_told_once() {
        let mut diagnostics = Diagnostics::new();
        let here = Location::from(Span::call_site());
        diagnostics.error_once(here, "unknown name `a`", "");
        diagnostics.error_once(here, "unknown name `a`", "");
        assert_eq!(diagnostics.len(), 1);
    }
}
