//! A cursor over the tokens of one declaration: the next token, and the place where a token is missing.

use proc_macro2::{Delimiter, Group, Ident, Spacing, TokenStream, TokenTree};

use super::ast::Word;
use super::keyword;
use super::limits::NAME_LENGTH;
use crate::diagnostics::{Diagnostics, Location};

/// Signals that an error was recorded and that this declaration is not read any further.
#[derive(Debug)]
pub(super) struct Refused;

/// The result of reading a part of a declaration.
pub(super) type Read<T> = Result<T, Refused>;

/// Reads the tokens of one declaration or one group from left to right.
pub(super) struct Cursor<'a> {
    tokens: &'a [TokenTree],
    next: usize,
    last: Location,
    /// Number of nested exponents; see [`super::limits::NESTING`].
    pub(super) exponents: usize,
    pub(super) diagnostics: &'a mut Diagnostics,
}

impl<'a> Cursor<'a> {
    /// A cursor before `tokens`; `before` is the place of an error if there are none.
    pub(super) fn new(
        tokens: &'a [TokenTree],
        before: Location,
        diagnostics: &'a mut Diagnostics,
    ) -> Self {
        Self {
            tokens,
            next: 0,
            last: before,
            exponents: 0,
            diagnostics,
        }
    }

    /// A cursor over the tokens inside of a group.
    pub(super) fn inside<'b>(&'b mut self, tokens: &'b [TokenTree], group: &Group) -> Cursor<'b> {
        Cursor {
            tokens,
            next: 0,
            last: Location::opening(group),
            exponents: self.exponents,
            diagnostics: self.diagnostics,
        }
    }

    /// The next token.
    pub(super) fn peek(&self) -> Option<&'a TokenTree> {
        self.tokens.get(self.next)
    }

    /// The token behind the next one.
    pub(super) fn peek_second(&self) -> Option<&'a TokenTree> {
        self.tokens.get(self.next + 1)
    }

    /// The token read last.
    pub(super) fn previous(&self) -> Option<&'a TokenTree> {
        self.tokens.get(self.next.checked_sub(1)?)
    }

    /// Takes the next token.
    pub(super) fn bump(&mut self) -> Option<&'a TokenTree> {
        let token = self.tokens.get(self.next)?;
        self.next += 1;
        self.last = Location::of(token);
        Some(token)
    }

    /// True if all tokens were read.
    pub(super) fn is_at_end(&self) -> bool {
        self.next >= self.tokens.len()
    }

    /// The tokens that were not read yet.
    pub(super) fn remaining(&self) -> &'a [TokenTree] {
        self.tokens.get(self.next..).unwrap_or_default()
    }

    /// Takes `length` tokens and the `;` behind them. False if the `;` is missing.
    pub(super) fn take(&mut self, length: usize) -> (&'a [TokenTree], bool) {
        let (taken, rest) = self.remaining().split_at(length);
        self.next += length + usize::from(!rest.is_empty());
        (taken, !rest.is_empty())
    }

    /// The place of the token read last.
    pub(super) fn last(&self) -> Location {
        self.last
    }

    /// The place of the next token, or of the last one at the end.
    pub(super) fn here(&self) -> Location {
        self.peek().map_or(self.last, Location::of)
    }

    /// True if the next tokens are these punctuation marks, as one operator and not the beginning of a longer one.
    pub(super) fn is_operator(&self, operator: &str) -> bool {
        let length = operator.chars().count();
        let matches = operator.chars().enumerate().all(|(offset, expected)| {
            matches!(self.tokens.get(self.next + offset), Some(TokenTree::Punct(punct))
                if punct.as_char() == expected && (offset + 1 == length || punct.spacing() == Spacing::Joint))
        });
        matches && !self.goes_on(self.next + length - 1)
    }

    /// True if the mark at `index` and the next one form a longer operator of comparison or range.
    fn goes_on(&self, index: usize) -> bool {
        let Some(TokenTree::Punct(punct)) = self.tokens.get(index) else {
            return false;
        };
        let Some(TokenTree::Punct(next)) = self.tokens.get(index + 1) else {
            return false;
        };
        punct.spacing() == Spacing::Joint
            && matches!(
                (punct.as_char(), next.as_char()),
                ('=' | '<' | '>' | '!', '=') | ('=', '>') | ('.', '.' | '=')
            )
    }

    /// Records an error at the operator that comes next.
    pub(super) fn refuse_operator(
        &mut self,
        operator: &str,
        text: impl Into<String>,
        help: &str,
    ) -> Refused {
        let last = self.tokens.get(self.next + operator.chars().count() - 1);
        let at = self.here().to(last.map_or(self.last, Location::of));
        self.refuse(at, text, help)
    }

    /// Takes the operator if it comes next, and returns its place.
    pub(super) fn eat_operator(&mut self, operator: &str) -> Option<Location> {
        if !self.is_operator(operator) {
            return None;
        }
        let start = self.here();
        for _ in operator.chars() {
            self.bump();
        }
        Some(start.to(self.last))
    }

    /// Takes the operator, which must come next.
    pub(super) fn expect_operator(&mut self, operator: &str, form: &str) -> Read<Location> {
        match self.eat_operator(operator) {
            Some(at) => Ok(at),
            None => Err(self.unexpected(
                &format!("expected `{operator}`"),
                &format!("write `{form}`"),
            )),
        }
    }

    /// True if the next token is this word.
    pub(super) fn is_word(&self, word: &str) -> bool {
        matches!(self.peek(), Some(TokenTree::Ident(ident)) if *ident == word)
    }

    /// Takes the word if it comes next.
    pub(super) fn eat_word(&mut self, word: &str) -> bool {
        let found = self.is_word(word);
        if found {
            self.bump();
        }
        found
    }

    /// Takes the group if one with these brackets comes next.
    pub(super) fn eat_group(&mut self, delimiter: Delimiter) -> Option<&'a Group> {
        match self.peek() {
            Some(TokenTree::Group(group)) if group.delimiter() == delimiter => {
                self.bump();
                Some(group)
            }
            _ => None,
        }
    }

    /// Takes a name, which must come next and may be any word.
    pub(super) fn name(&mut self, what: &str) -> Read<Word> {
        match self.peek() {
            Some(TokenTree::Ident(ident)) => {
                self.bump();
                self.word(ident)
            }
            _ => Err(self.unexpected(&format!("expected {what}"), "")),
        }
    }

    /// Takes a name that is about to be declared: reserved words are refused.
    pub(super) fn new_name(&mut self, what: &str) -> Read<Word> {
        let name = self.name(what)?;
        if let Some(reason) = keyword::reserved(&name.text) {
            let text = format!("`{}` is {reason}", name.text);
            self.diagnostics.error(name.at, text).help(format!(
                "choose another name, for example `{}_1`",
                name.text.trim_start_matches("r#")
            ));
        }
        Ok(name)
    }

    /// The identifier as a word, if it is not too long.
    pub(super) fn word(&mut self, ident: &Ident) -> Read<Word> {
        let text = ident.to_string();
        let at = Location::from(ident.span());
        let letters = text.chars().count();
        if letters > NAME_LENGTH {
            let start: String = text.chars().take(12).collect();
            let message =
                format!("the name `{start}..` has {letters} letters; the limit is {NAME_LENGTH}");
            self.diagnostics
                .error(at, message)
                .help("choose a shorter name");
            return Err(Refused);
        }
        Ok(Word { text, at })
    }

    /// Records an error at the next token, or at the last one if the next is `;` or missing.
    pub(super) fn unexpected(&mut self, expected: &str, help: &str) -> Refused {
        match self.peek() {
            Some(token) if !self.is_operator(";") => {
                let text = format!("{expected}, found `{}`", token_text(token));
                self.refuse(Location::of(token), text, help)
            }
            _ => self.refuse(self.last, expected, help),
        }
    }

    /// Records an error.
    pub(super) fn refuse(&mut self, at: Location, text: impl Into<String>, help: &str) -> Refused {
        let error = self.diagnostics.error(at, text);
        if !help.is_empty() {
            error.help(help);
        }
        Refused
    }
}

/// The tokens of a stream. An invisible group around a single token, left by `macro_rules`, is taken off.
pub(super) fn tokens_of(stream: TokenStream) -> Vec<TokenTree> {
    stream.into_iter().map(without_invisible_group).collect()
}

fn without_invisible_group(mut token: TokenTree) -> TokenTree {
    loop {
        let TokenTree::Group(group) = &token else {
            return token;
        };
        if group.delimiter() != Delimiter::None {
            return token;
        }
        let mut inner = group.stream().into_iter();
        match (inner.next(), inner.next()) {
            (Some(only), None) => token = only,
            _ => return token,
        }
    }
}

/// A token in the form of messages: groups without their content, long names cut.
pub(super) fn token_text(token: &TokenTree) -> String {
    let text = match token {
        TokenTree::Group(group) => match group.delimiter() {
            Delimiter::Parenthesis => "(..)".to_owned(),
            Delimiter::Brace => "{..}".to_owned(),
            Delimiter::Bracket => "[..]".to_owned(),
            Delimiter::None => group.stream().to_string(),
        },
        other => other.to_string(),
    };
    if text.chars().count() <= 24 {
        text
    } else {
        text.chars().take(22).chain("..".chars()).collect()
    }
}
