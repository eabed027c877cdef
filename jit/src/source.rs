//! The models of a text, and its mistakes by line and column.

use std::fmt;
use std::ops::Range;

use dalembert_codegen::diagnostics::{Counterexample, Diagnostics, Location};
use dalembert_codegen::{self as codegen};
use proc_macro2::{Ident, LexError, Span, TokenStream, TokenTree};

use crate::lexical;

/// Mistakes in a text.
#[derive(Debug, Clone, PartialEq)]
pub struct Refused {
    name: String,
    text: String,
    mistakes: Vec<Mistake>,
}

/// A mistake.
#[derive(Debug, Clone, PartialEq)]
pub struct Mistake {
    /// Description of the mistake, and advice.
    pub message: String,
    /// The line, from 1 on.
    pub line: usize,
    /// The first column, from 1 on, in characters.
    pub column: usize,
    /// Number of columns in this line that belong to the mistake.
    pub width: usize,
    /// The state that refutes a claim, if there is one.
    pub counterexample: Option<Counterexample>,
}

impl Refused {
    /// No mistakes yet.
    pub(crate) fn new(name: &str, text: &str) -> Self {
        // A comment ends with its line, also in a text whose lines end in carriage returns alone.
        let text = match text.contains('\n') {
            true => text.to_owned(),
            false => text.replace('\r', "\n"),
        };
        Self {
            name: name.to_owned(),
            text,
            mistakes: Vec::new(),
        }
    }

    /// The mistakes, in the order in which they were found.
    pub fn mistakes(&self) -> &[Mistake] {
        &self.mistakes
    }

    pub(crate) fn add(&mut self, diagnostics: &Diagnostics) {
        for error in diagnostics.iter() {
            for (location, message) in error.places() {
                let counterexample = error.counterexample().cloned();
                self.mistakes.push(Mistake {
                    counterexample,
                    ..self.at(location, message)
                });
            }
        }
    }

    /// The value if there are no mistakes.
    pub(crate) fn or<T>(self, value: T) -> Result<T, Self> {
        match self.mistakes.is_empty() {
            true => Ok(value),
            false => Err(self),
        }
    }

    /// A mistake at these bytes of one line.
    fn within(&self, bytes: Range<usize>, message: String) -> Mistake {
        let before = &self.text[..bytes.start];
        let begin = before.rfind('\n').map_or(0, |end| end + 1);
        Mistake {
            message,
            line: before.matches('\n').count() + 1,
            column: before[begin..].chars().count() + 1,
            width: self.text[bytes].chars().count().max(1),
            counterexample: None,
        }
    }

    fn at(&self, location: &Location, message: &str) -> Mistake {
        let (start, end) = (location.first.start(), location.last.end());
        let line = self.text.lines().nth(start.line.saturating_sub(1));
        let length = line.map_or(0, |line| line.chars().count());
        let last = match end.line == start.line {
            true => end.column,
            false => length,
        };
        Mistake {
            message: message.to_owned(),
            line: start.line,
            column: start.column + 1,
            width: last.saturating_sub(start.column).max(1),
            counterexample: None,
        }
    }
}

impl fmt::Display for Refused {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        for (index, mistake) in self.mistakes.iter().enumerate() {
            if index > 0 {
                write!(f, "\n\n")?;
            }
            let Mistake {
                message,
                line,
                column,
                width,
                ..
            } = mistake;
            let number = line.to_string();
            let margin = " ".repeat(number.len());
            let text = self.text.lines().nth(line - 1).unwrap_or_default();
            let before: String = text
                .chars()
                .take(column - 1)
                .map(|c| if c == '\t' { '\t' } else { ' ' })
                .collect();
            let mut lines = message.lines();
            let head = if index > 0 { "error: " } else { "" };
            writeln!(f, "{head}{}", lines.next().unwrap_or_default())?;
            for line in lines {
                writeln!(f, "       {line}")?;
            }
            writeln!(f, "{margin}--> {}:{line}:{column}", self.name)?;
            writeln!(f, "{margin} |")?;
            writeln!(f, "{number} | {text}")?;
            write!(f, "{margin} | {before}{}", "^".repeat(*width))?;
        }
        Ok(())
    }
}

impl std::error::Error for Refused {}

/// The tokens of each model, up to its block in braces.
pub(crate) fn models(refused: &mut Refused) -> Result<Vec<TokenStream>, Refused> {
    let tokens: TokenStream = match refused.text.parse() {
        Ok(tokens) => tokens,
        Err(error) => {
            let mistake = match lexical::fault(&refused.text) {
                Some((bytes, message)) => refused.within(bytes, message),
                None => {
                    let error: LexError = error;
                    refused.at(
                        &Location::from(error.span()),
                        "not a text of the language: a quote or a character is wrong here",
                    )
                }
            };
            refused.mistakes.push(mistake);
            return Err(refused.clone());
        }
    };
    let models = codegen::models_of(tokens);
    if models.is_empty() {
        let mistake = refused.at(
            &Location::from(Span::call_site()),
            "no model here\nwrite one, such as `Pendulum { coordinates { theta: angle; } lagrangian = dot(theta)^2/2 + cos(theta); }`",
        );
        refused.mistakes.push(Mistake {
            line: 1,
            column: 1,
            ..mistake
        });
        return Err(refused.clone());
    }
    let mut names: Vec<Ident> = Vec::new();
    for model in &models {
        let Some(name) = name_of(model) else {
            continue;
        };
        if names.contains(&name) {
            let text = format!("a second model `{name}` in this text\nrename one of them");
            let mistake = refused.at(&Location::from(name.span()), &text);
            refused.mistakes.push(mistake);
        }
        names.push(name);
    }
    match refused.mistakes.is_empty() {
        true => Ok(models),
        false => Err(refused.clone()),
    }
}

/// The last word in front of the block of a model.
fn name_of(model: &TokenStream) -> Option<Ident> {
    let words = model.clone().into_iter().filter_map(|token| match token {
        TokenTree::Ident(word) => Some(word),
        _ => None,
    });
    words.last()
}
