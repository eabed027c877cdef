//! The models of a text, and its mistakes by line and column.

use std::collections::HashMap;
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

/// Number of times that a message is shown in full.
const SHOWN: usize = 3;

/// Number of lines that are listed for further places with the same message.
const LISTED: usize = 20;

/// Largest number of characters of a line that are shown, and the number of them before the mistake.
const WINDOW: [usize; 2] = [160, 60];

impl fmt::Display for Refused {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        let mut counts: HashMap<&str, usize> = HashMap::new();
        let mut is_first = true;
        for (index, mistake) in self.mistakes.iter().enumerate() {
            let count = counts.entry(mistake.message.as_str()).or_default();
            *count += 1;
            if *count > SHOWN {
                continue;
            }
            let head = if is_first { "" } else { "\n\nerror: " };
            is_first = false;
            write!(f, "{head}")?;
            self.write(f, mistake)?;
            if *count == SHOWN {
                let same = |other: &&Mistake| other.message == mistake.message;
                let others = self.mistakes[index + 1..].iter().filter(same);
                write_others(f, &others.collect::<Vec<_>>())?;
            }
        }
        Ok(())
    }
}

/// Writes the lines of further mistakes with the same message.
fn write_others(f: &mut fmt::Formatter<'_>, mistakes: &[&Mistake]) -> fmt::Result {
    if mistakes.is_empty() {
        return Ok(());
    }
    let places = match mistakes.len() {
        1 => "one more place".to_owned(),
        count => format!("{count} more places"),
    };
    let lines = mistakes.iter().take(LISTED);
    let lines: Vec<String> = lines.map(|it| it.line.to_string()).collect();
    let more = if mistakes.len() > LISTED { ", .." } else { "" };
    let noun = if mistakes.len() > 1 { "lines" } else { "line" };
    write!(
        f,
        "\n       the same in {places}: {noun} {}{more}",
        lines.join(", ")
    )
}

impl Refused {
    /// Writes the message with the line and its place.
    fn write(&self, f: &mut fmt::Formatter<'_>, mistake: &Mistake) -> fmt::Result {
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
        let [most, lead] = WINDOW;
        let length = text.chars().count();
        let first = match length > most {
            true => (column - 1).saturating_sub(lead),
            false => 0,
        };
        let printed = |c: char| match c != '\t' && lexical::is_hidden(c) {
            true => char::REPLACEMENT_CHARACTER,
            false => c,
        };
        let shown: String = text.chars().map(printed).skip(first).take(most).collect();
        let left = if first > 0 { "..." } else { "" };
        let right = if length > first + most { "..." } else { "" };
        let before = shown.chars().take(column - 1 - first);
        let before: String = before.map(|c| if c == '\t' { '\t' } else { ' ' }).collect();
        let width = (*width).min(most - before.chars().count().min(most - 1));
        let mut lines = message.lines();
        writeln!(f, "{}", lines.next().unwrap_or_default())?;
        for line in lines {
            writeln!(f, "       {line}")?;
        }
        writeln!(f, "{margin}--> {}:{line}:{column}", self.name)?;
        writeln!(f, "{margin} |")?;
        writeln!(f, "{number} | {left}{shown}{right}")?;
        let lead = " ".repeat(left.len());
        write!(f, "{margin} | {lead}{before}{}", "^".repeat(width))
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
