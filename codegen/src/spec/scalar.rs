//! The expression grammar, by precedence climbing over tokens:
//!
//! ```text
//! sum     = product (("+" | "-") product)*
//! product = unary (("*" | "/" | "%") unary)*
//! unary   = "-"* power
//! power   = atom ("^" unary)?            right-associative, tighter than unary minus
//! atom    = number | name | name[sum] | name(sum, ..) | sum(i in a..=b: e) | (sum)
//! ```
//!
//! Rust's own grammar reads `^` as exclusive or, with a lower precedence than `+`. This grammar differs. An invisible
//! group, made by `macro_rules`, is an atom.

use proc_macro2::{Delimiter, Group, Ident, TokenTree};

use super::ast::{Binder, Operator, Scalar, ScalarKind, Word};
use super::cursor::{Cursor, Read, tokens_of};
use super::keyword;
use super::limits::NESTING;
use crate::diagnostics::Location;

impl Cursor<'_> {
    /// Reads the longest expression at the current position.
    pub(super) fn scalar(&mut self) -> Read<Scalar> {
        let sum = self.sum()?;
        match self.peek() {
            Some(TokenTree::Ident(word)) if *word == "when" || *word == keyword::OTHERWISE => {
                Ok(sum)
            }
            Some(TokenTree::Ident(_) | TokenTree::Literal(_)) => Err(self.missing_operator()),
            Some(TokenTree::Group(group)) if group.delimiter() != Delimiter::Brace => {
                Err(self.missing_operator())
            }
            _ => Ok(sum),
        }
    }

    /// Reads an expression that must take all remaining tokens.
    pub(super) fn whole_scalar(&mut self) -> Read<Scalar> {
        let scalar = self.scalar()?;
        self.end()?;
        Ok(scalar)
    }

    fn sum(&mut self) -> Read<Scalar> {
        let start = self.here();
        let mut terms = vec![(false, self.product()?)];
        loop {
            let negative = match self.peek() {
                Some(TokenTree::Punct(punct)) if punct.as_char() == '+' => false,
                Some(TokenTree::Punct(punct))
                    if punct.as_char() == '-' && !self.is_operator("->") =>
                {
                    true
                }
                _ => break,
            };
            self.bump();
            terms.push((negative, self.product()?));
        }
        Ok(single(
            terms,
            |(_, only)| only,
            ScalarKind::Sum,
            start.to(self.last()),
        ))
    }

    fn product(&mut self) -> Read<Scalar> {
        let start = self.here();
        let mut factors = vec![(Operator::Times, self.unary()?)];
        while let Some(operator) = self.product_operator()? {
            factors.push((operator, self.unary()?));
        }
        Ok(single(
            factors,
            |(_, only)| only,
            ScalarKind::Product,
            start.to(self.last()),
        ))
    }

    /// Takes `*`, `/` or `%` if it is next.
    fn product_operator(&mut self) -> Read<Option<Operator>> {
        let Some(TokenTree::Punct(punct)) = self.peek() else {
            return Ok(None);
        };
        let operator = match punct.as_char() {
            '*' => Operator::Times,
            '/' => Operator::Over,
            '%' => Operator::Modulo,
            _ => return Ok(None),
        };
        self.bump();
        let start = self.last();
        if matches!(self.peek(), Some(TokenTree::Punct(punct)) if operator == Operator::Times && punct.as_char() == '*')
        {
            let at = start.to(self.here());
            return Err(self.refuse(at, "no `**` operator", "a power is written `x^2`"));
        }
        Ok(Some(operator))
    }

    fn unary(&mut self) -> Read<Scalar> {
        let start = self.here();
        let mut negative = false;
        while matches!(self.peek(), Some(TokenTree::Punct(punct)) if punct.as_char() == '-') {
            self.bump();
            negative = !negative;
        }
        let power = self.power()?;
        if !negative {
            return Ok(power);
        }
        let at = start.to(self.last());
        Ok(Scalar {
            kind: ScalarKind::Negative(Box::new(power)),
            at,
        })
    }

    fn power(&mut self) -> Read<Scalar> {
        let start = self.here();
        let base = self.atom()?;
        if !matches!(self.peek(), Some(TokenTree::Punct(punct)) if punct.as_char() == '^') {
            return Ok(base);
        }
        self.bump();
        self.exponents += 1;
        if self.exponents > NESTING {
            let text = format!("exponents are nested more than {NESTING} deep");
            return Err(self.refuse(self.last(), text, "name the inner parts with `let`"));
        }
        let exponent = self.unary()?;
        self.exponents -= 1;
        let at = start.to(self.last());
        Ok(Scalar {
            kind: ScalarKind::Power(Box::new(base), Box::new(exponent)),
            at,
        })
    }

    fn atom(&mut self) -> Read<Scalar> {
        match self.peek() {
            Some(TokenTree::Literal(literal)) => {
                self.bump();
                self.literal(literal)
            }
            Some(TokenTree::Ident(ident)) => {
                self.bump();
                self.named(ident)
            }
            Some(TokenTree::Group(group)) => {
                match group.delimiter() {
                    Delimiter::Parenthesis | Delimiter::None => self.parenthesised(group),
                    Delimiter::Bracket => Err(self
                        .unexpected("expected an expression", "group with parentheses: `( .. )`")),
                    Delimiter::Brace => Err(self.unexpected("expected an expression", "")),
                }
            }
            _ => Err(self.missing_expression()),
        }
    }

    fn parenthesised(&mut self, group: &Group) -> Read<Scalar> {
        self.bump();
        let tokens = tokens_of(group.stream());
        let mut inside = self.inside(&tokens, group);
        let inner = inside.scalar()?;
        if inside.is_operator(",") {
            return Err(inside.comma_in_parentheses());
        }
        inside.end()?;
        Ok(Scalar {
            kind: inner.kind,
            at: Location::from(group.span()),
        })
    }

    /// An expression that begins with a name.
    fn named(&mut self, ident: &Ident) -> Read<Scalar> {
        let name = self.word(ident)?;
        if matches!(name.text.as_str(), "if" | "match" | "else") {
            let text = format!("an expression has no cases, found `{}`", name.text);
            return Err(self.refuse(name.at, text, keyword::PIECEWISE));
        }
        if let Some(group) = self.eat_group(Delimiter::Parenthesis) {
            let tokens = tokens_of(group.stream());
            let kind = self.inside(&tokens, group).call(name.clone())?;
            return Ok(Scalar {
                kind,
                at: name.at.to(self.last()),
            });
        }
        if keyword::is_function(&name.text) {
            return Err(self.missing_parentheses(&name));
        }
        if let Some(group) = self.eat_group(Delimiter::Bracket) {
            let tokens = tokens_of(group.stream());
            let index = self.inside(&tokens, group).whole_scalar()?;
            let at = name.at.to(self.last());
            return Ok(Scalar {
                kind: ScalarKind::Member(name, Box::new(index)),
                at,
            });
        }
        Ok(Scalar {
            kind: ScalarKind::Name(name.text),
            at: name.at,
        })
    }

    /// The contents of the parentheses after a name.
    fn call(&mut self, function: Word) -> Read<ScalarKind> {
        if function.text == "sum" {
            let form = "sum(i in 1..=N: e)";
            let binder = self.binder(form)?;
            self.expect_operator(":", form)?;
            let body = self.whole_scalar()?;
            return Ok(ScalarKind::SumOver(binder, Box::new(body)));
        }
        Ok(ScalarKind::Call(function, self.list()?))
    }

    /// Expressions separated by commas, up to the end.
    pub(super) fn list(&mut self) -> Read<Vec<Scalar>> {
        let mut list = Vec::new();
        while !self.is_at_end() {
            list.push(self.scalar()?);
            if self.eat_operator(",").is_none() {
                self.end()?;
            }
        }
        Ok(list)
    }

    /// `i in a..=b`
    pub(super) fn binder(&mut self, form: &str) -> Read<Binder> {
        let name = self.new_name("an index")?;
        if !self.eat_word("in") {
            return Err(self.unexpected("expected `in`", &format!("write `{form}`")));
        }
        let low = Box::new(self.scalar()?);
        if self.is_operator("..") {
            return Err(self.open_range(&low));
        }
        self.expect_operator("..=", form)?;
        let high = Box::new(self.scalar()?);
        Ok(Binder { name, low, high })
    }
}

/// The only part, or an expression of all parts.
fn single<T>(
    mut parts: Vec<T>,
    only: fn(T) -> Scalar,
    kind: fn(Vec<T>) -> ScalarKind,
    at: Location,
) -> Scalar {
    match parts.pop() {
        Some(part) if parts.is_empty() => only(part),
        Some(part) => {
            parts.push(part);
            Scalar {
                kind: kind(parts),
                at,
            }
        }
        None => Scalar {
            kind: kind(parts),
            at,
        },
    }
}
