//! Expansion of families of modes or transitions: the value of the index replaces its name.

use proc_macro2::{Delimiter, Group, Literal, TokenStream, TokenTree};

use super::super::ast::{Binder, Word};
use super::super::cursor::tokens_of;
use super::{documentation_length, entry_length, split};
use crate::diagnostics::{Diagnostics, Location};

/// An index with its value in one member of a family.
pub(super) struct Bound<'a> {
    /// The name of the family.
    pub(super) family: &'a Word,
    /// The name of the index.
    pub(super) index: &'a Word,
    /// Value.
    pub(super) member: usize,
}

/// Visibility of the index at a place. A binding of the same name hides it.
#[derive(Clone, Copy, PartialEq, Eq)]
enum Sight {
    Seen,
    Hidden,
}

impl<'a> Bound<'a> {
    pub(super) fn new(family: &'a Word, binder: &'a Binder, member: usize) -> Self {
        Self {
            family,
            index: &binder.name,
            member,
        }
    }

    /// `[k]` in place of the brackets with the range.
    pub(super) fn brackets(&self, range: &TokenTree) -> TokenTree {
        let value = self.value(range);
        regrouped(Delimiter::Bracket, range, vec![value])
    }

    /// Contents of the braces of a mode, with the index replaced.
    pub(super) fn declarations(
        &self,
        tokens: &[TokenTree],
        diagnostics: &mut Diagnostics,
    ) -> Vec<TokenTree> {
        split(tokens)
            .flat_map(|declaration| self.entry(declaration, diagnostics))
            .collect()
    }

    /// A declaration without braces, or an entry of one with braces. The declared name must differ from the index.
    pub(super) fn entry(
        &self,
        tokens: &[TokenTree],
        diagnostics: &mut Diagnostics,
    ) -> Vec<TokenTree> {
        let begin = documentation_length(tokens);
        let is_let = matches!(tokens.get(begin), Some(TokenTree::Ident(word)) if *word == "let");
        let begin = begin + usize::from(is_let);
        let Some(name) = tokens.get(begin) else {
            return tokens.to_vec();
        };
        if self.is_index(name) {
            let text = format!(
                "`{}` is the index of `{}` here",
                self.index.text, self.family.text
            );
            diagnostics.error_once(Location::of(name), text, "choose another name");
            return tokens.to_vec();
        }
        let rest = &tokens[begin + 1..];
        let hides = rest.iter().any(|token| self.is_bound_in(token))
            || is_let && matches!(rest.first(), Some(token) if self.is_argument_in(token));
        let sight = match hides {
            true => Sight::Hidden,
            false => Sight::Seen,
        };
        let mut written = tokens[..=begin].to_vec();
        written.extend(self.tokens(rest, sight, diagnostics));
        written
    }

    /// Entries with the index replaced. Each of them ends with `;`.
    fn entries(&self, tokens: &[TokenTree], diagnostics: &mut Diagnostics) -> Vec<TokenTree> {
        let mut written = Vec::new();
        let mut rest = tokens;
        while !rest.is_empty() {
            let length = (entry_length(rest) + 1).min(rest.len());
            let (entry, others) = rest.split_at(length);
            written.extend(self.entry(entry, diagnostics));
            rest = others;
        }
        written
    }

    fn tokens(
        &self,
        tokens: &[TokenTree],
        sight: Sight,
        diagnostics: &mut Diagnostics,
    ) -> Vec<TokenTree> {
        let mut written = Vec::new();
        for (position, token) in tokens.iter().enumerate() {
            let before = position.checked_sub(1).map(|before| &tokens[before]);
            written.push(self.token(token, before, sight, diagnostics));
        }
        written
    }

    fn token(
        &self,
        token: &TokenTree,
        before: Option<&TokenTree>,
        sight: Sight,
        diagnostics: &mut Diagnostics,
    ) -> TokenTree {
        let TokenTree::Group(group) = token else {
            return match sight == Sight::Seen && self.is_index(token) {
                true => self.value(token),
                false => token.clone(),
            };
        };
        if !self.occurs_in(group) {
            return token.clone();
        }
        let inside = tokens_of(group.stream());
        let is_sum = matches!(before, Some(TokenTree::Ident(word)) if *word == "sum");
        let written = match group.delimiter() {
            Delimiter::Brace if sight == Sight::Seen => self.entries(&inside, diagnostics),
            Delimiter::Brace => inside.clone(),
            Delimiter::Bracket if self.binds(&inside) => {
                self.range(&inside, inside.len(), diagnostics)
            }
            Delimiter::Parenthesis if is_sum && sight == Sight::Seen && self.binds(&inside) => {
                self.range(&inside, range_length(&inside), diagnostics)
            }
            _ => self.tokens(&inside, sight, diagnostics),
        };
        regrouped(group.delimiter(), token, written)
    }

    /// The first `length` tokens, `i in a..=b`, bind another index of the same name. This index can occur only in the
    /// ends `a` and `b`.
    fn range(
        &self,
        tokens: &[TokenTree],
        length: usize,
        diagnostics: &mut Diagnostics,
    ) -> Vec<TokenTree> {
        let (name, rest) = tokens.split_at(2);
        let (ends, body) = rest.split_at(length - 2);
        let ends = self.tokens(ends, Sight::Seen, diagnostics);
        [name, &ends, body].concat()
    }

    fn is_index(&self, token: &TokenTree) -> bool {
        matches!(token, TokenTree::Ident(word) if *word == self.index.text)
    }

    fn occurs_in(&self, group: &Group) -> bool {
        tokens_of(group.stream()).iter().any(|token| match token {
            TokenTree::Group(inner) => self.occurs_in(inner),
            other => self.is_index(other),
        })
    }

    /// True if tokens begin with `i in`.
    fn binds(&self, tokens: &[TokenTree]) -> bool {
        matches!(tokens, [name, TokenTree::Ident(word), ..] if self.is_index(name) && *word == "in")
    }

    /// True if a token is brackets with `i in a..=b`, or parentheses that contain such brackets:
    /// `dot(theta[i in 1..=N])`.
    fn is_bound_in(&self, token: &TokenTree) -> bool {
        let TokenTree::Group(group) = token else {
            return false;
        };
        let inside = tokens_of(group.stream());
        match group.delimiter() {
            Delimiter::Bracket => self.binds(&inside),
            Delimiter::Parenthesis => inside.iter().any(|token| self.is_bound_in(token)),
            Delimiter::Brace | Delimiter::None => false,
        }
    }

    /// True if a token is parentheses with an argument of the name of the index.
    fn is_argument_in(&self, token: &TokenTree) -> bool {
        matches!(token, TokenTree::Group(group) if group.delimiter() == Delimiter::Parenthesis
            && tokens_of(group.stream()).iter().any(|token| self.is_index(token)))
    }

    /// The value of the index, with the span of the replaced token.
    fn value(&self, token: &TokenTree) -> TokenTree {
        let mut value = Literal::usize_unsuffixed(self.member);
        value.set_span(token.span());
        value.into()
    }
}

/// Number of tokens of the range of a sum.
fn range_length(tokens: &[TokenTree]) -> usize {
    let is_end =
        |token: &TokenTree| matches!(token, TokenTree::Punct(punct) if punct.as_char() == ':');
    tokens.iter().position(is_end).unwrap_or(tokens.len())
}

/// A group with the tokens `inside`, and the span of the replaced token.
fn regrouped(delimiter: Delimiter, token: &TokenTree, inside: Vec<TokenTree>) -> TokenTree {
    let mut group = Group::new(delimiter, inside.into_iter().collect::<TokenStream>());
    group.set_span(token.span());
    group.into()
}
