//! Advice on frequent slips: tokens of other notations.

use proc_macro2::{Delimiter, TokenTree};

use super::ast::{Scalar, Word};
use super::cursor::{Cursor, Read, Refused, token_text, tokens_of};
use super::keyword::{LAWS, PIECEWISE, foreign_function, is_function};
use crate::diagnostics::Location;

/// Comparison and logical operators, which no expression contains.
const COMPARISONS: [&str; 10] = ["<=", ">=", "==", "!=", "<", ">", "&&", "||", "&", "|"];

/// Modules of other languages before which functions are written: `np.sin(x)`.
const MODULES: [&str; 6] = ["np", "numpy", "math", "Math", "sp", "sympy"];

/// The notation of numbers, for messages.
pub(super) const NUMBERS: &str = "numbers are written `12`, `0.5`, `1.25e-7`";

impl Cursor<'_> {
    /// Refuses tokens after a complete declaration or expression.
    pub(super) fn end(&mut self) -> Read<()> {
        if self.is_at_end() {
            return Ok(());
        }
        if let Some(sign) = self.comparison() {
            let text = format!("`{sign}` is not differentiable and not part of an expression");
            return Err(self.refuse_operator(sign, text, PIECEWISE));
        }
        if self.is_operator(".") {
            return Err(self.point());
        }
        if self.is_operator("..") || self.is_operator("..=") {
            let help = "an interval is written `(a, b)`, a range `i in 1..=N`";
            return Err(self.refuse(self.here(), "unexpected `..`", help));
        }
        if self.is_operator(",") {
            return Err(self.comma());
        }
        if self.is_operator("->") {
            let help = "the law of a surface is written `=> LAW`";
            return Err(self.refuse_operator("->", "unexpected `->`", help));
        }
        Err(self.unexpected("expected `;` or an operator", ""))
    }

    /// The next token as a comparison or logical operator.
    pub(super) fn comparison(&self) -> Option<&'static str> {
        COMPARISONS.into_iter().find(|sign| self.is_operator(sign))
    }

    /// Refuses an expression that follows another without an operator.
    pub(super) fn missing_operator(&mut self) -> Refused {
        if self.is_word("and") || self.is_word("or") {
            let help = "several conditions are written `when a > 0 when b > 0`";
            return self.unexpected("expected `when`", help);
        }
        if self.is_word("if") || self.is_word("else") {
            let help = format!("{PIECEWISE}, and their conditions are written `when g > 0`");
            return self.unexpected("an expression has no cases", &help);
        }
        if let Some((law, _)) = LAWS.into_iter().find(|(law, _)| self.is_word(law)) {
            return self.unexpected("expected `=>`", &format!("write `=> {law}`"));
        }
        if matches!(self.peek_second(), Some(TokenTree::Punct(punct)) if matches!(punct.as_char(), ':' | '='))
        {
            return self.refuse(self.last(), "expected `;`", "end the declaration with `;`");
        }
        let next = self.peek().map_or_else(String::new, token_text);
        let help = "write `*` for a product, or `;` to end the declaration";
        self.refuse(
            self.here(),
            format!("missing operator before `{next}`"),
            help,
        )
    }

    /// Refuses tokens that cannot begin an expression.
    pub(super) fn missing_expression(&mut self) -> Refused {
        if self.is_operator("+") {
            return self.refuse(self.here(), "there is no unary plus", "leave the sign out");
        }
        if let (true, Some(digits @ TokenTree::Literal(_))) =
            (self.is_operator("."), self.peek_second())
        {
            let at = self.here().to(Location::of(digits));
            let help = format!("write `0.{digits}`");
            return self.refuse(at, "a digit stands before the point", &help);
        }
        if self.is_operator("|") {
            return self.unexpected(
                "expected an expression",
                "the absolute value is written `abs(x)`",
            );
        }
        self.unexpected("expected an expression", "")
    }

    /// Refuses a function whose arguments are not in parentheses.
    pub(super) fn missing_parentheses(&mut self, function: &Word) -> Refused {
        const TEXT: &str = "function call needs parentheses";
        let name = &function.text;
        match self.peek() {
            Some(token @ (TokenTree::Ident(_) | TokenTree::Literal(_))) => {
                let help = format!("write `{name}({})`", token_text(token));
                self.refuse(Location::of(token), TEXT, &help)
            }
            Some(TokenTree::Group(group)) if group.delimiter() == Delimiter::Bracket => {
                let at = self.here();
                let tokens = tokens_of(group.stream());
                let Ok(argument) = self.inside(&tokens, group).whole_scalar() else {
                    return Refused;
                };
                self.refuse(at, TEXT, &format!("write `{name}({argument})`"))
            }
            Some(TokenTree::Punct(punct)) if punct.as_char() == '^' => {
                let help = format!("the power of a function is written `{name}(x)^2`");
                self.refuse(function.at, TEXT, &help)
            }
            _ => {
                let help = format!("write `{name}(..)`");
                self.refuse(function.at, format!("`{name}` is a function"), &help)
            }
        }
    }

    /// Refuses a point: `q.1`, `x.dot`, `1.e5`.
    pub(super) fn point(&mut self) -> Refused {
        let before = self.previous().map(token_text).unwrap_or_default();
        let help = match (self.previous(), self.peek_second()) {
            (Some(TokenTree::Literal(_)), _) => NUMBERS.to_owned(),
            (Some(TokenTree::Ident(_)), Some(TokenTree::Literal(member))) => {
                format!("a member of a family is written `{before}[{member}]`")
            }
            (_, Some(TokenTree::Ident(function))) => {
                let function = function.to_string();
                match foreign_function(&function) {
                    _ if is_function(&function) && MODULES.contains(&before.as_str()) => {
                        format!("write `{function}(..)`")
                    }
                    _ if is_function(&function) => format!("write `{function}({before})`"),
                    Some(instead) => instead.to_owned(),
                    None => "a function is written `sin(x)`".to_owned(),
                }
            }
            _ => "a member of a family is written `theta[3]`".to_owned(),
        };
        self.refuse(self.here(), "unexpected `.`", &help)
    }

    /// Refuses a comma after a complete entry. It stands for `;`, or for a decimal point.
    fn comma(&mut self) -> Refused {
        let help = match (self.previous(), self.peek_second()) {
            (Some(TokenTree::Literal(whole)), Some(TokenTree::Literal(decimals))) => {
                format!("a decimal number is written `{whole}.{decimals}`")
            }
            _ => "every entry ends with `;`".to_owned(),
        };
        self.unexpected("expected `;`", &help)
    }

    /// Refuses `(x, y)` as a factor.
    pub(super) fn comma_in_parentheses(&mut self) -> Refused {
        let help = "one expression stands in parentheses; `(x, y)` is written only for the `path` of a view";
        self.unexpected("expected `)`", help)
    }

    /// Refuses `1..3`. Both ends of a range belong to it.
    pub(super) fn open_range(&mut self, low: &Scalar) -> Refused {
        let dots = self.eat_operator("..").unwrap_or_else(|| self.last());
        let Ok(high) = self.scalar() else {
            return Refused;
        };
        let help = format!("both ends belong to a range: write `{low}..={high}`");
        self.refuse(dots, "expected `..=`, found `..`", &help)
    }
}
