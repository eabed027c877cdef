//! Closed loops: texts whose inputs follow laws.

use std::fmt;
use std::ops::Range;

use proc_macro2::{Delimiter, TokenStream, TokenTree};

use crate::source::{self, Refused};

/// Reasons for which a feedback loop cannot be closed.
#[derive(Debug, Clone, PartialEq)]
pub enum FeedbackError {
    /// The text has no models, or is not a text of the language.
    Text(Refused),
    /// The declaration has no such input.
    Unknown {
        /// The name in front of the law.
        given: String,
        /// The declared inputs.
        declared: Vec<String>,
    },
    /// An input with two laws.
    Again(String),
    /// A law that is not one expression.
    Expression {
        /// The input.
        input: String,
        /// The text of the law.
        law: String,
    },
}

impl fmt::Display for FeedbackError {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        match self {
            Self::Text(refused) => refused.fmt(f),
            Self::Unknown { given, declared } if declared.is_empty() => {
                write!(f, "no input `{given}`: the model has no inputs")
            }
            Self::Unknown { given, declared } => {
                let declared = declared.join("`, `");
                write!(f, "no input `{given}`; the inputs are `{declared}`")
            }
            Self::Again(input) => write!(f, "input `{input}` has two laws"),
            Self::Expression { input, law } => write!(
                f,
                "`{law}` is no law for `{input}`: write one expression of time, coordinates, velocities and parameters, \
                 such as `-4*x - dot(x)`"
            ),
        }
    }
}

impl std::error::Error for FeedbackError {}

/// The text with inputs of its first model replaced by laws, each a pair of an input and an expression of time,
/// coordinates, velocities, parameters and definitions. An input of a family is written `thrust[2]`, or
/// `thrust[i in 1..=2]` with a law in `i`.
///
/// The result declares the same model without these inputs: `let u = law;` takes the place of `u`. A closed loop is a
/// declaration like any other, with power series, derivatives across impacts and certified runs. A `cost` is removed if
/// no input is left.
///
/// ```
/// use dalembert::erased::{Bounded, Erased};
/// use dalembert::{StateVector, System, VectorField};
///
/// let cart = "Cart { coordinates { x; } inputs { u; } lagrangian = dot(x)^2/2; forces { push: u*d(x); } }";
/// let closed = dalembert_jit::close("cart", cart, &[("u", "-4*x - dot(x)")])?;
/// let models = dalembert_jit::load("cart", &closed)?;
/// let cart = Erased::<4>::of(&models[0].form).expect("room for two numbers");
/// let state = cart.state(0.0, &Bounded::all(1, 0.5), &Bounded::all(1, 1.0)).expect("a state");
/// let mut rate = cart.zero_state();
/// cart.rate(0.0, &state, &mut rate).expect("a rate");
/// assert_eq!(StateVector::as_slice(&rate), [1.0, -3.0]);
/// # Ok::<(), Box<dyn std::error::Error>>(())
/// ```
///
/// # Errors
/// [`FeedbackError`]. Mistakes inside of a law are reported when the result is loaded.
pub fn close(name: &str, text: &str, laws: &[(&str, &str)]) -> Result<String, FeedbackError> {
    super::in_thread(|| close_here(name, text, laws))
}

fn close_here(name: &str, text: &str, laws: &[(&str, &str)]) -> Result<String, FeedbackError> {
    // Places of tokens do not count a byte order mark.
    let text = text.strip_prefix('\u{feff}').unwrap_or(text);
    let mut refused = Refused::new(name, text);
    let models = source::models(&mut refused).map_err(FeedbackError::Text)?;
    let sections = Sections::of(models.into_iter().next().unwrap_or_default());
    for (index, (input, law)) in laws.iter().enumerate() {
        if laws[..index].iter().any(|(other, _)| other == input) {
            return Err(FeedbackError::Again((*input).to_owned()));
        }
        if !is_expression(law) {
            return Err(FeedbackError::Expression {
                input: (*input).to_owned(),
                law: (*law).to_owned(),
            });
        }
        let entries = sections.inputs.iter().flat_map(|block| &block.entries);
        if !entries.clone().any(|entry| entry.name == word(input)) {
            return Err(FeedbackError::Unknown {
                given: (*input).to_owned(),
                declared: entries.map(|entry| entry.name.clone()).collect(),
            });
        }
    }
    Ok(applied(text, &sections.edits(laws)))
}

/// The name in front of an index.
fn word(input: &str) -> &str {
    input.split('[').next().unwrap_or(input).trim()
}

/// True for one or more tokens without a semicolon outside of brackets.
fn is_expression(law: &str) -> bool {
    let tokens: Result<TokenStream, _> = law.parse();
    tokens.is_ok_and(|tokens| {
        let mut tokens = tokens.into_iter().peekable();
        tokens.peek().is_some()
            && tokens.all(
                |token| !matches!(&token, TokenTree::Punct(operator) if operator.as_char() == ';'),
            )
    })
}

/// The sections of a declaration that a law changes.
#[derive(Default)]
struct Sections {
    /// The sections `inputs { .. }`.
    inputs: Vec<Block>,
    /// Byte ranges of the sections `cost { .. }`.
    costs: Vec<Range<usize>>,
}

/// A section with its entries.
struct Block {
    bytes: Range<usize>,
    entries: Vec<Entry>,
}

/// An entry such as `thrust[2];`.
struct Entry {
    name: String,
    bytes: Range<usize>,
}

impl Sections {
    /// The sections at the top of a declaration.
    fn of(model: TokenStream) -> Self {
        let mut sections = Self::default();
        let Some(TokenTree::Group(body)) = model.into_iter().last() else {
            return sections;
        };
        let tokens: Vec<TokenTree> = body.stream().into_iter().collect();
        for pair in tokens.windows(2) {
            let [TokenTree::Ident(section), TokenTree::Group(group)] = pair else {
                continue;
            };
            if group.delimiter() != Delimiter::Brace {
                continue;
            }
            let bytes = section.span().byte_range().start..group.span().byte_range().end;
            if section == "inputs" {
                let entries = entries(group.stream());
                sections.inputs.push(Block { bytes, entries });
            } else if section == "cost" {
                sections.costs.push(bytes);
            }
        }
        sections
    }

    /// The changes of the text, in its order.
    fn edits(&self, laws: &[(&str, &str)]) -> Vec<(Range<usize>, String)> {
        let is_closed = |entry: &Entry| laws.iter().any(|(input, _)| word(input) == entry.name);
        let mut edits = Vec::new();
        for block in &self.inputs {
            let definitions: Vec<String> = laws
                .iter()
                .filter(|(input, _)| block.entries.iter().any(|entry| entry.name == word(input)))
                .map(|(input, law)| format!("let {input} = {law};"))
                .collect();
            let definitions = definitions.join(" ");
            if block.entries.iter().all(is_closed) {
                edits.push((block.bytes.clone(), definitions));
                continue;
            }
            let closed = block.entries.iter().filter(|entry| is_closed(entry));
            edits.extend(closed.map(|entry| (entry.bytes.clone(), String::new())));
            if !definitions.is_empty() {
                let end = block.bytes.end;
                edits.push((end..end, format!(" {definitions}")));
            }
        }
        let mut entries = self.inputs.iter().flat_map(|block| &block.entries);
        if entries.all(is_closed) {
            edits.extend(
                self.costs
                    .iter()
                    .map(|bytes| (bytes.clone(), String::new())),
            );
        }
        edits.sort_by_key(|(bytes, _)| bytes.start);
        edits
    }
}

/// The entries of `inputs { .. }`, with their doc comments.
fn entries(tokens: TokenStream) -> Vec<Entry> {
    let tokens: Vec<TokenTree> = tokens.into_iter().collect();
    let ends = |token: &TokenTree| matches!(token, TokenTree::Punct(operator) if operator.as_char() == ';');
    let entry = |tokens: &[TokenTree]| {
        let name = tokens.iter().find_map(|token| match token {
            TokenTree::Ident(name) => Some(name.to_string()),
            _ => None,
        });
        let [start, end] = [tokens.first()?, tokens.last()?].map(|token| token.span().byte_range());
        Some(Entry {
            name: name?,
            bytes: start.start..end.end,
        })
    };
    tokens.split_inclusive(ends).filter_map(entry).collect()
}

/// The text with parts replaced. The parts are in order and do not overlap.
fn applied(text: &str, edits: &[(Range<usize>, String)]) -> String {
    let mut result = String::new();
    let mut done = 0;
    for (bytes, replacement) in edits {
        result.push_str(&text[done..bytes.start]);
        result.push_str(replacement);
        done = bytes.end;
    }
    result.push_str(&text[done..]);
    result
}
