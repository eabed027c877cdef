//! Mistakes in brackets, comments, quotes and characters, which end the reading of a text before there are tokens.

use std::ops::Range;

/// Characters that are not part of the language, with the text to write instead.
const MEANT: [(char, &str); 18] = [
    ('\u{2212}', "-"),
    ('\u{2010}', "-"),
    ('\u{2013}', "-"),
    ('\u{2014}', "-"),
    ('\u{d7}', "*"),
    ('\u{22c5}', "*"),
    ('\u{2217}', "*"),
    ('\u{f7}', "/"),
    ('\u{2215}', "/"),
    ('\u{b2}', "^2"),
    ('\u{b3}', "^3"),
    ('\u{2070}', "^0"),
    ('\u{b9}', "^1"),
    ('\u{221a}', "sqrt(..)"),
    ('\u{2264}', "<="),
    ('\u{2265}', ">="),
    ('\u{21d2}', "=>"),
    ('\u{221e}', "inf"),
];

/// Characters of other notations, with the help for them.
const EXPLAINED: [(char, &str); 3] = [
    ('\'', "the velocity of `theta` is written `dot(theta)`"),
    (
        '\\',
        "names and functions are written without it: `dot(theta)`, `sqrt(x)`",
    ),
    (
        '\u{b0}',
        "angles are in radians: 30 degrees are `30*pi/180`",
    ),
];

/// The help for a character that is not part of the language; `None` for any other.
fn help(character: char) -> Option<String> {
    let found = |list: &[(char, &'static str)]| {
        let mut entries = list.iter();
        entries.find_map(|&(known, text)| (known == character).then_some(text))
    };
    let explained = found(&EXPLAINED).map(|text| format!("\n{text}"));
    let meant = || found(&MEANT).map(|meant| format!("\nwrite `{meant}`"));
    let foreign = || is_foreign(character).then(String::new);
    explained.or_else(meant).or_else(foreign)
}

/// The first mistake: its bytes, and what is wrong.
pub(crate) fn fault(text: &str) -> Option<(Range<usize>, String)> {
    let mut open: Vec<(usize, char)> = Vec::new();
    // The first `{` whose `}` begins a line that stands further left: one between them may be missing.
    let mut suspect: Option<usize> = None;
    let mut rest = text.char_indices().peekable();
    while let Some((at, character)) = rest.next() {
        let bytes = at..at + character.len_utf8();
        let next = rest.peek().map(|(_, next)| *next);
        match character {
            '/' if next == Some('/') => while rest.next_if(|(_, c)| *c != '\n').is_some() {},
            '/' if next == Some('*') => match after_comment(&text[at..]) {
                Some(length) => while rest.next_if(|(next, _)| *next < at + length).is_some() {},
                None => return Some((at..at + 2, "this comment is not closed by `*/`".to_owned())),
            },
            '"' => {
                let mut is_escaped = false;
                let closed = rest.any(|(_, c)| {
                    let ends = c == '"' && !is_escaped;
                    is_escaped = c == '\\' && !is_escaped;
                    ends
                });
                if !closed {
                    return Some((bytes, "this quote is not closed".to_owned()));
                }
            }
            '(' | '[' | '{' => open.push((at, character)),
            ')' | ']' | '}' => match open.pop() {
                Some((begin, '{')) if character == '}' => {
                    let starts_line = line_before(text, at).trim().is_empty();
                    let is_outer = starts_line && indent(text, at) < indent(text, begin);
                    suspect = suspect.or(is_outer.then_some(begin));
                }
                None => return Some((bytes, format!("`{character}` closes no bracket"))),
                Some((_, bracket))
                    if closing(bracket) != character
                        && !open.iter().any(|(_, other)| closing(*other) == character) =>
                {
                    return Some((bytes, format!("`{character}` closes no bracket")));
                }
                Some((_, bracket)) if closing(bracket) == character => {}
                Some((begin, bracket)) => {
                    let line = text[..at].matches('\n').count() + 1;
                    let missing = closing(bracket);
                    let fault = format!(
                        "`{bracket}` is not closed before `{character}` in line {line}\nwrite the missing `{missing}`"
                    );
                    return Some((begin..begin + 1, fault));
                }
            },
            _ => {
                if let Some(help) = help(character) {
                    let code = format!("U+{:04X}", u32::from(character));
                    let shown = match is_hidden(character) {
                        true => code,
                        false => format!("`{character}` ({code})"),
                    };
                    let fault = format!("the character {shown} is not part of the language{help}");
                    return Some((bytes, fault));
                }
            }
        }
    }
    let (begin, bracket) = open.pop()?;
    let begin = suspect.filter(|_| bracket == '{').unwrap_or(begin);
    let missing = closing(bracket);
    let fault = format!("`{bracket}` is not closed\nwrite the missing `{missing}`");
    Some((begin..begin + 1, fault))
}

/// True for a character that a terminal acts on, such as one that begins a sequence or changes the direction of the text.
pub(crate) fn is_hidden(character: char) -> bool {
    character.is_control() || character.escape_debug().to_string().starts_with("\\u")
}

/// The line up to a place.
fn line_before(text: &str, at: usize) -> &str {
    text[..at].rsplit('\n').next().unwrap_or_default()
}

/// The white space at the start of the line of a place.
fn indent(text: &str, at: usize) -> usize {
    let line = line_before(text, at);
    line.len() - line.trim_start().len()
}

/// The bracket that closes another one.
fn closing(bracket: char) -> char {
    match bracket {
        '(' => ')',
        '[' => ']',
        _ => '}',
    }
}

/// The length of the comment with which a text begins; comments may contain others.
fn after_comment(text: &str) -> Option<usize> {
    let (mut depth, mut at) = (0, 0);
    loop {
        let rest = &text[at..];
        let inner = rest.find("/*");
        let end = rest.find("*/")?;
        match inner {
            Some(inner) if inner < end => (depth, at) = (depth + 1, at + inner + 2),
            _ => (depth, at) = (depth - 1, at + end + 2),
        }
        if depth == 0 {
            return Some(at);
        }
    }
}

/// True for a character that is part of no token.
fn is_foreign(character: char) -> bool {
    !character.is_ascii() && !character.is_alphanumeric() && !character.is_whitespace()
        || matches!(character, '\\' | '`')
        || character.is_ascii_control() && !character.is_ascii_whitespace()
}

#[cfg(test)]
mod tests {
    use super::fault;

    #[test]
    fn the_bracket_that_is_not_closed_is_shown() {
        let told = |text: &str| {
            let (bytes, words) = fault(text).expect("a mistake");
            (text[bytes].to_owned(), words)
        };
        let (at, words) = told("P { let a = (x + 1;\n }");
        assert_eq!(at, "(");
        assert!(words.contains("before `}` in line 2"), "{words}");
        assert!(told("P { x; ").1.contains("`{` is not closed"));
        let text = "P {\n    a { x; }\n    b { y;\n    c { z; }\n}\n";
        let (bytes, _) = fault(text).expect("a mistake");
        assert_eq!(bytes.start, text.find("{ y").expect("the bracket of `b`"));
        assert_eq!(told("P { let a = x); }").0, ")");
        assert!(told("P { x; }}").1.contains("`}` closes no bracket"));
        assert!(told("P { /* x /* y */ }").1.contains("comment"));
        assert!(told("P { x\u{2212}y }").1.contains("write `-`"));
        assert!(told("P { x\u{b2} }").1.contains("write `^2`"));
        assert!(told("P { x \u{1f600} y }").1.contains("U+1F600"));
        assert!(told("P { theta'^2 }").1.contains("is written `dot(theta)`"));
        assert!(told("P { \\dot{x} }").1.contains("written without it"));
        assert!(told("P { 30\u{b0} }").1.contains("`30*pi/180`"));
    }

    #[test]
    fn a_text_without_such_mistakes_has_none() {
        let text = "// (\n/* { /* ( */ */ Ball { \u{3b8}; \u{901f}\u{5ea6}; let a = [(x)]; /// \u{2212}\n } \"(\\\"\"";
        assert_eq!(fault(text), None);
    }
}
