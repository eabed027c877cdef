//! Expressions in flags, written in the language of models. They become outputs of the model, so that the parser and
//! the compiler of models read them.

use std::borrow::Cow;
use std::fmt::Write as _;

use dalembert::describe::Description;

use crate::entry::Entry;
use crate::error::CliError;
use crate::names;
use crate::state_input::find_model;

/// Relation signs between the sides of an expression; longer ones first.
const SIGNS: [(&str, Sign); 5] = [
    (">=", Sign::AtLeast),
    ("<=", Sign::AtMost),
    (">", Sign::Above),
    ("<", Sign::Below),
    ("=", Sign::Equal),
];

/// Relation between the sides of an expression.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Sign {
    /// `=`
    Equal,
    /// `>`
    Above,
    /// `>=`
    AtLeast,
    /// `<`
    Below,
    /// `<=`
    AtMost,
}

/// An expression of a flag: a number, or a comparison of two.
#[derive(Debug, Clone, PartialEq)]
pub struct Expression {
    flag: &'static str,
    text: String,
    /// Each side with its first column, counted from 0.
    sides: Vec<(usize, String)>,
    sign: Option<Sign>,
}

impl Expression {
    /// Parses an expression into its sides.
    ///
    /// # Errors
    /// An empty side, several comparisons, brackets that do not match, a character that cannot be in an expression.
    pub fn parse(flag: &'static str, text: &str) -> Result<Self, CliError> {
        let text = text.replace(['\n', '\r', '\t'], " ");
        let mut found = Self {
            flag,
            sides: Vec::new(),
            sign: None,
            text,
        };
        found.check_brackets()?;
        let Some((sign, at, length)) = found.find_sign(0) else {
            found.sides = vec![found.side(0, found.text.len())?];
            return Ok(found);
        };
        if let Some((_, second, _)) = found.find_sign(at + length) {
            return Err(found.refuse(second, 1, "one comparison at most is expected"));
        }
        found.sides = vec![
            found.side(0, at)?,
            found.side(at + length, found.text.len())?,
        ];
        found.sign = Some(sign);
        Ok(found)
    }

    /// Splits an equation whose left side is one name into the name and the right side.
    ///
    /// # Errors
    /// An expression that is not such an equation.
    pub fn assigned(mut self) -> Result<(String, Self), CliError> {
        let is_name =
            |side: &str| !names::column(side).contains(['(', '+', '-', '*', '/', '^', ' ']);
        match self.sides.first() {
            Some((_, name)) if self.is_equation() && is_name(name) => {
                let name = name.clone();
                self.sides.remove(0);
                Ok((name, self))
            }
            _ => Err(CliError::value(
                self.flag,
                self.text(),
                "NAME = EXPR, such as y = 2*x",
            )),
        }
    }

    /// The text of the flag.
    pub fn text(&self) -> &str {
        self.text.trim()
    }

    /// True for two sides with `<`, `<=`, `>` or `>=` between them.
    pub fn is_inequality(&self) -> bool {
        self.sign.is_some_and(|sign| sign != Sign::Equal)
    }

    /// True for two sides with an equals sign between them.
    pub fn is_equation(&self) -> bool {
        self.sign == Some(Sign::Equal)
    }

    /// True if an inequality holds where its left side exceeds its right side by `difference`.
    pub fn holds(&self, difference: f64) -> bool {
        match self.sign {
            Some(Sign::Above) => difference > 0.0,
            Some(Sign::AtLeast) => difference >= 0.0,
            Some(Sign::Below) => difference < 0.0,
            Some(Sign::AtMost) => difference <= 0.0,
            Some(Sign::Equal) | None => difference == 0.0,
        }
    }

    /// The first relation sign from this byte on, with its position and its length.
    fn find_sign(&self, from: usize) -> Option<(Sign, usize, usize)> {
        let places = SIGNS.iter().filter_map(|(text, sign)| {
            let at = from + self.text[from..].find(text)?;
            Some((*sign, at, text.len()))
        });
        places.min_by_key(|&(_, at, length)| (at, usize::MAX - length))
    }

    fn side(&self, from: usize, to: usize) -> Result<(usize, String), CliError> {
        let side = &self.text[from..to];
        let trimmed = side.trim_start();
        let start = from + side.len() - trimmed.len();
        match trimmed.trim_end() {
            "" => Err(self.refuse(from, 1, "an expression is missing here")),
            trimmed => Ok((self.column(start), trimmed.to_owned())),
        }
    }

    /// The column of a byte, counted from 0.
    fn column(&self, byte: usize) -> usize {
        self.text[..byte].chars().count()
    }

    /// Refuses unmatched brackets, and characters that would end the declaration of the output or begin a comment.
    fn check_brackets(&self) -> Result<(), CliError> {
        let mut open = Vec::new();
        for (at, letter) in self.text.char_indices() {
            match letter {
                '(' | '[' => open.push((at, letter)),
                ')' | ']' => {
                    let first = if letter == ')' { '(' } else { '[' };
                    match open.pop() {
                        Some((_, opened)) if opened == first => {}
                        _ => return Err(self.refuse(at, 1, "this bracket closes none")),
                    }
                }
                ';' | '{' | '}' | '"' | '\'' | '/' if self.is_wrong(at) => {
                    let reason = format!("`{letter}` cannot be in an expression here");
                    return Err(self.refuse(at, 1, &reason));
                }
                _ => {}
            }
        }
        match open.first() {
            Some(&(at, _)) => Err(self.refuse(at, 1, "this bracket is not closed")),
            None => Ok(()),
        }
    }

    /// True unless the character is the slash of a division: `//` and `/*` begin comments.
    fn is_wrong(&self, at: usize) -> bool {
        let rest = &self.text[at..];
        !rest.starts_with('/') || rest.starts_with("//") || rest.starts_with("/*")
    }

    /// The error that marks `width` characters of the expression from a byte on.
    fn refuse(&self, byte: usize, width: usize, reason: &str) -> CliError {
        self.refuse_at(self.column(byte), width, reason)
    }

    fn refuse_at(&self, column: usize, width: usize, reason: &str) -> CliError {
        let marks = "^".repeat(width.max(1));
        CliError::Input {
            place: self.flag.to_owned(),
            reason: format!(
                "{reason}\n  | {}\n  | {}{marks}",
                self.text,
                " ".repeat(column)
            ),
        }
    }

    /// The line that declares the expression as an output of this name: the difference of its sides.
    fn line(&self, name: &str) -> Line {
        let (mut text, mut places) = (format!("{name}: "), Vec::new());
        for (index, (column, side)) in self.sides.iter().enumerate() {
            text += if index > 0 { " - (" } else { "(" };
            places.push((text.chars().count(), *column));
            text += side;
            text.push(')');
        }
        text.push(';');
        Line { text, places }
    }
}

/// A line that declares an output.
struct Line {
    text: String,
    /// The first column of each side, in the line and in the flag.
    places: Vec<(usize, usize)>,
}

impl Line {
    /// The column in the flag that belongs to a column in the line.
    fn column(&self, column: usize) -> usize {
        let before = self.places.iter().rev().find(|(from, _)| *from <= column);
        before.map_or(0, |(from, first)| first + column - from)
    }
}

/// The names and the expressions of `--output`.
///
/// # Errors
/// A flag that is not `NAME = EXPR`, a name that is not a word or is given twice.
pub fn named_outputs(flags: &[String]) -> Result<Vec<(String, Expression)>, CliError> {
    let mut named: Vec<(String, Expression)> = Vec::new();
    for flag in flags {
        let (name, expression) = Expression::parse("--output", flag)?.assigned()?;
        let is_word = name.starts_with(|letter: char| letter.is_ascii_alphabetic())
            && name
                .chars()
                .all(|letter| letter.is_ascii_alphanumeric() || letter == '_');
        if !is_word || named.iter().any(|(known, _)| *known == name) {
            let expected =
                "NAME = EXPR, where NAME is a word of letters, digits and `_` that is given once";
            return Err(CliError::value("--output", flag, expected));
        }
        named.push((name, expression));
    }
    Ok(named)
}

/// Without flags, all models; else only the model of this name, with the outputs of `--output` added.
///
/// # Errors
/// A flag that is not `NAME = EXPR`, and the errors of [`add_to`].
pub fn with_outputs<'m>(
    models: &'m [Entry],
    model: &str,
    flags: &[String],
) -> Result<Cow<'m, [Entry]>, CliError> {
    if flags.is_empty() {
        return Ok(Cow::Borrowed(models));
    }
    let named = named_outputs(flags)?;
    let entry = find_model(models, model)?;
    if let Some((name, expression)) = named
        .iter()
        .find(|(name, _)| is_column(entry.description(), name))
    {
        return Err(CliError::value(
            "--output",
            expression.text(),
            format!("another name, such as {name}_2: tables have a column `{name}`"),
        ));
    }
    let named: Vec<(String, &Expression)> = named
        .iter()
        .map(|(name, expression)| (name.clone(), expression))
        .collect();
    Ok(Cow::Owned(vec![add_named(entry, &named)?]))
}

/// True if tables of runs have a column of this name without any output.
fn is_column(description: &Description, name: &str) -> bool {
    ["event", "mode", "energy_error"].contains(&name)
        || names::is_quantity(description, name)
        || names::coordinates(description).any(|coordinate| names::momentum(coordinate) == name)
}

/// The model with the expressions as additional outputs after its own, in their order.
///
/// # Errors
/// An expression that the model does not accept, with a mark at the mistake; a model without a text.
pub fn add_to(entry: &Entry, expressions: &[&Expression]) -> Result<Entry, CliError> {
    let numbered = expressions.iter().enumerate();
    let named: Vec<(String, &Expression)> = numbered
        .map(|(index, expression)| (format!("flag_{index}"), *expression))
        .collect();
    add_named(entry, &named)
}

/// The model with the expressions as additional outputs of these names, after its own.
fn add_named(entry: &Entry, named: &[(String, &Expression)]) -> Result<Entry, CliError> {
    let source = &entry.description().source;
    let Some((body, _)) = source.rsplit_once('}') else {
        return Err(CliError::Usage(
            "expressions need the text of the model, and this one has none; declare an output, or a surface",
        ));
    };
    let lines = named.iter().map(|(name, expression)| expression.line(name));
    let lines: Vec<Line> = lines.collect();
    let mut text = body.trim_end().to_owned();
    text += "\noutputs {\n";
    let first = text.lines().count() + 1;
    for line in &lines {
        let _ = writeln!(text, "{}", line.text);
    }
    text += "}\n}\n";
    let loaded = dalembert_jit::load_without_claims(entry.name(), &text).map_err(|refused| {
        let mistake = refused.mistakes().first().cloned();
        let found = mistake.and_then(|mistake| {
            let index = mistake.line.checked_sub(first)?;
            let (line, (_, expression)) = (lines.get(index)?, named.get(index)?);
            let column = line.column(mistake.column - 1);
            Some(expression.refuse_at(column, mistake.width, &mistake.message))
        });
        found.unwrap_or(CliError::Declaration(refused))
    })?;
    let entries: Vec<Entry> = loaded.iter().map(Entry::loaded).collect();
    let all = entries.iter().map(Entry::name);
    let index = names::find("MODEL", "model", entry.name(), all)?;
    entries[index].check_size()?;
    Ok(entries[index].clone())
}

#[cfg(test)]
mod tests {
    use super::*;

    fn refused(text: &str) -> String {
        let error = Expression::parse("--fail", text).expect_err("no expression");
        error.to_string()
    }

    #[test]
    fn sides_keep_their_columns() {
        let found = Expression::parse("--fail", " theta >=  pi/2 ").unwrap();
        assert!(found.is_inequality() && !found.is_equation());
        let line = found.line("o");
        assert_eq!(line.text, "o: (theta) - (pi/2);");
        // The columns of `theta` and of `2`.
        assert_eq!([line.column(4), line.column(17)], [1, 14]);
        assert!(found.holds(0.0) && !found.holds(-0.1) && !found.holds(f64::NAN));
        let number = Expression::parse("--class", "x + 1").unwrap();
        assert_eq!(number.line("o").text, "o: (x + 1);");
        assert!(!number.is_inequality() && !number.is_equation());
    }

    #[test]
    fn mistakes_are_shown_at_their_place() {
        assert_eq!(
            refused("x > 1 > y"),
            "--fail: one comparison at most is expected\n  | x > 1 > y\n  |       ^"
        );
        assert!(refused("x >").contains("missing"));
        assert!(refused("").contains("missing"));
        assert!(refused("(x").ends_with("  | (x\n  | ^"));
        assert!(refused("x) ; y: (z").contains("closes none"));
        assert!(refused("x; y").contains("`;` cannot"));
        assert!(refused("x // y").contains("`/` cannot"));
    }
}
