//! Prints the errors of refused models as `rustc` does, without a compiler: takes the text of a Rust file and returns
//! the errors of every `model!` in it.

use dalembert_codegen::diagnostics::{Diagnostic, Location};
use proc_macro2::{TokenStream, TokenTree};

/// Errors of every `model!` in `text`, as `rustc` prints them for the file `path`: message and help, place, underlined
/// source line at full length. The text is empty if every model is accepted.
///
/// # Errors
/// The reason why these errors need a compiler: the text does not consist of tokens, or an error is at no token or
/// extends over several lines.
pub fn rendered(path: &str, text: &str) -> Result<String, String> {
    let tokens: TokenStream = text
        .parse()
        .map_err(|error| format!("{path} does not consist of tokens: {error}"))?;
    let mut errors = Vec::new();
    for declaration in declarations(tokens) {
        let Err(refused) = dalembert_emit::try_expand(declaration) else {
            continue;
        };
        for (at, message) in refused.iter().flat_map(Diagnostic::places) {
            let error = titled(message) + &underlined(path, text, *at)?;
            // The compiler prints an error once.
            if !errors.contains(&error) {
                errors.push(error);
            }
        }
    }
    Ok(errors.join("\n"))
}

/// Bodies of all invocations `model! { .. }`, nested ones included, in the order of the text.
fn declarations(tokens: TokenStream) -> Vec<TokenStream> {
    let mut found = Vec::new();
    let (mut before_last, mut last) = (String::new(), String::new());
    for token in tokens {
        if let TokenTree::Group(group) = &token {
            if before_last == "model" && last == "!" {
                found.push(group.stream());
            } else {
                found.extend(declarations(group.stream()));
            }
        }
        before_last = std::mem::replace(&mut last, token.to_string());
    }
    found
}

/// The message under its title `error: `, which indents all further lines.
fn titled(message: &str) -> String {
    let title = "error: ";
    let indented = format!("\n{}", " ".repeat(title.len()));
    format!("{title}{}\n", message.replace('\n', &indented))
}

/// The place and its source line, with a caret under every letter of `at`.
fn underlined(path: &str, text: &str, at: Location) -> Result<String, String> {
    if at.first.byte_range().is_empty() {
        return Err(format!("an error of {path} is at no token"));
    }
    let (start, end) = (at.first.start(), at.last.end());
    let line = start.line;
    if line != end.line {
        return Err(format!("{path}:{line}: an error ends in line {}", end.line));
    }
    let source = text.lines().nth(line - 1).unwrap_or_default();
    let column = start.column + 1;
    let margin = " ".repeat(line.to_string().len());
    let before = " ".repeat(start.column);
    let carets = "^".repeat((end.column - start.column).max(1));
    Ok(format!(
        "{margin}--> {path}:{line}:{column}\n{margin} |\n{line} | {source}\n{margin} | {before}{carets}\n"
    ))
}

/// Errors that `rustc` printed, with source lines at full length. `rustc` shortens a long line to the part around the
/// underline, between dots. The line of `text` replaces that part, and the underline moves with it.
pub fn with_whole_lines(errors: &str, text: &str) -> String {
    let mut lines = String::new();
    let mut shift = 0;
    for line in errors.lines() {
        if let Some((whole, letters)) = whole_line(line, text) {
            lines += &whole;
            shift = letters;
        } else if let Some((margin, underline)) = line.split_once(" | ") {
            lines += &format!("{margin} | {}{underline}", " ".repeat(shift));
            shift = 0;
        } else {
            lines += line;
        }
        lines.push('\n');
    }
    lines
}

/// The whole of a source line that is printed as `NUMBER | PART`, and the letters by which `PART` moves in it.
fn whole_line(printed: &str, text: &str) -> Option<(String, usize)> {
    let (number, shown) = printed.split_once(" | ")?;
    let index = number.parse::<usize>().ok()?.checked_sub(1)?;
    let source = text.lines().nth(index)?;
    let dots = "...";
    let end = shown.strip_prefix(dots);
    let shown = end.unwrap_or(shown);
    let middle = shown.strip_suffix(dots);
    let part = middle.unwrap_or(shown);
    let start = match middle {
        Some(_) => source.find(part)?,
        None => source.rfind(part)?,
    };
    let is_start = end.is_some() || start == 0;
    let is_end = middle.is_some() || start + part.len() == source.len();
    let shift = match end {
        Some(_) => source[..start].chars().count().checked_sub(dots.len())?,
        None => 0,
    };
    (is_start && is_end).then(|| (format!("{number} | {source}"), shift))
}
