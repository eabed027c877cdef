//! The text of a declaration, and the tokens of its header.

use proc_macro2::{Delimiter, Group, TokenStream, TokenTree};

use super::super::cursor::tokens_of;

/// The tokens without invisible groups. A visibility that `macro_rules` passes on arrives in such a group.
pub(super) fn flatten_header(tokens: TokenStream) -> Vec<TokenTree> {
    let mut flat = Vec::new();
    for token in tokens {
        match token {
            TokenTree::Group(group) if group.delimiter() == Delimiter::None => {
                flat.extend(flatten_header(group.stream()))
            }
            other => flat.push(other),
        }
    }
    flat
}

/// The lines of the text of one `#[doc = ".."]`.
pub(super) fn doc_lines(text: &TokenTree) -> Vec<String> {
    let literal = syn::parse2::<syn::LitStr>(TokenStream::from(text.clone()));
    let text = literal.map(|literal| literal.value()).unwrap_or_default();
    text.split('\n')
        .map(|line| line.strip_prefix(' ').unwrap_or(line).trim_end().to_owned())
        .collect()
}

/// The source text of the declaration, or its tokens where the source text is not available.
pub(super) fn text(documentation: &[String], visibility: &str, name: &str, body: &Group) -> String {
    let mut text = String::new();
    for line in documentation {
        text.push_str(&format!("/// {line}").trim_end().replace('\r', ""));
        text.push('\n');
    }
    if !visibility.is_empty() {
        text.push_str(visibility);
        text.push(' ');
    }
    text.push_str(name);
    text.push(' ');
    text.push_str(&body_text(body));
    text
}

/// A hash of the name and the tokens (FNV-1a). Blanks, comments and documentation do not count.
pub(super) fn hash(name: &str, body: &Group) -> u64 {
    let mut hash = Hash(0xcbf2_9ce4_8422_2325);
    hash.add(name);
    hash.add_tokens(body.stream());
    hash.0
}

struct Hash(u64);

impl Hash {
    fn add(&mut self, text: &str) {
        // A byte that no text contains separates the tokens.
        for byte in text.bytes().chain([0xff]) {
            self.0 = (self.0 ^ u64::from(byte)).wrapping_mul(0x0100_0000_01b3);
        }
    }

    fn add_tokens(&mut self, tokens: TokenStream) {
        let mut tokens = tokens.into_iter().peekable();
        while let Some(token) = tokens.next() {
            match &token {
                TokenTree::Punct(sign) if sign.as_char() == '#' => {
                    if tokens.next_if(is_documentation).is_none() {
                        self.add("#");
                    }
                }
                TokenTree::Group(group) => {
                    let [open, close] = match group.delimiter() {
                        Delimiter::Parenthesis => ["(", ")"],
                        Delimiter::Brace => ["{", "}"],
                        Delimiter::Bracket => ["[", "]"],
                        Delimiter::None => ["", ""],
                    };
                    self.add(open);
                    self.add_tokens(group.stream());
                    self.add(close);
                }
                other => self.add(&other.to_string()),
            }
        }
    }
}

/// True for `[doc = ".."]`.
fn is_documentation(token: &TokenTree) -> bool {
    match token {
        TokenTree::Group(group) => {
            let first = group.stream().into_iter().next();
            matches!(first, Some(TokenTree::Ident(word)) if word == "doc")
        }
        _ => false,
    }
}

/// The text of the braces and everything between them. Inside of a `macro_rules`, a span covers the macro instead of
/// the model; the text is therefore used only if it has the same tokens.
fn body_text(body: &Group) -> String {
    let tokens = visible(TokenTree::from(body.clone()).into()).to_string();
    let written = body.span().source_text().map(|text| dedent(&text));
    let same = |text: &String| {
        let read: Result<TokenStream, _> = text.parse();
        read.is_ok_and(|read| without_blanks(&read.to_string()) == without_blanks(&tokens))
    };
    written.filter(same).unwrap_or(tokens)
}

/// The tokens with parentheses in place of invisible groups, which text cannot show.
fn visible(tokens: TokenStream) -> TokenStream {
    let show = |token: TokenTree| match token {
        TokenTree::Group(group) => {
            let delimiter = match group.delimiter() {
                Delimiter::None => Delimiter::Parenthesis,
                other => other,
            };
            let mut shown = Group::new(delimiter, visible(group.stream()));
            shown.set_span(group.span());
            TokenTree::from(shown)
        }
        other => other,
    };
    tokens_of(tokens).into_iter().map(show).collect()
}

fn without_blanks(text: &str) -> String {
    text.chars()
        .filter(|character| !character.is_whitespace())
        .collect()
}

/// Removes the indentation of the last line from all lines after the first.
fn dedent(text: &str) -> String {
    let Some((_, last)) = text.rsplit_once('\n') else {
        return text.to_owned();
    };
    let margin = &last[..last.len() - last.trim_start().len()];
    let lines = text
        .lines()
        .map(|line| line.strip_prefix(margin).unwrap_or(line));
    lines.collect::<Vec<_>>().join("\n")
}
