//! Evaluates expressions of claims with a separate parser that shares no code with the generator.

use proc_macro2::{Delimiter, TokenStream, TokenTree};

use crate::numeric::Snapshot;

/// Meanings of the names in an expression.
pub struct Scope<'s> {
    /// Names of coordinates.
    pub coordinates: &'s [&'s str],
    /// Names and values of parameters.
    pub parameters: &'s [(&'s str, f64)],
    /// Names and texts of definitions.
    pub definitions: &'s [(String, TokenStream)],
    /// The state.
    pub state: &'s Snapshot,
    /// Index of the coordinate `x` for which `partial(x)` is 1. For other coordinates it is 0.
    pub partial: Option<usize>,
}

/// The value of an expression.
///
/// # Panics
/// On any expression that does not occur in the tested claims.
pub fn value(text: &str, scope: &Scope<'_>) -> f64 {
    let tokens: TokenStream = text.parse().expect("tokens");
    let mut reader = Reader {
        tokens: tokens.into_iter().collect(),
        next: 0,
        scope,
    };
    let value = reader.sum();
    assert_eq!(reader.next, reader.tokens.len(), "{text}");
    value
}

/// The definitions `let NAME = ..;` of a declaration. Families and functions are left out.
pub fn definitions(source: &str) -> Vec<(String, TokenStream)> {
    let tokens: TokenStream = source.parse().expect("tokens");
    let body = tokens.into_iter().find_map(|token| match token {
        TokenTree::Group(group) if group.delimiter() == Delimiter::Brace => Some(group.stream()),
        _ => None,
    });
    let body: Vec<TokenTree> = body.expect("a body").into_iter().collect();
    let is = |token: &TokenTree, text: &str| token.to_string() == text;
    let found = body.windows(3).enumerate().filter_map(|(i, window)| {
        let [first, name, equals] = window else {
            return None;
        };
        (is(first, "let") && is(equals, "=")).then(|| {
            let text = body[i + 3..].iter().take_while(|token| !is(token, ";"));
            (name.to_string(), text.cloned().collect())
        })
    });
    found.collect()
}

struct Reader<'r> {
    tokens: Vec<TokenTree>,
    next: usize,
    scope: &'r Scope<'r>,
}

impl Reader<'_> {
    fn eat(&mut self, sign: char) -> bool {
        let found = matches!(self.tokens.get(self.next), Some(TokenTree::Punct(mark)) if mark.as_char() == sign);
        self.next += usize::from(found);
        found
    }

    fn sum(&mut self) -> f64 {
        let mut sum = self.product();
        loop {
            if self.eat('+') {
                sum += self.product();
            } else if self.eat('-') {
                sum -= self.product();
            } else {
                return sum;
            }
        }
    }

    fn product(&mut self) -> f64 {
        let mut product = self.unary();
        loop {
            if self.eat('*') {
                product *= self.unary();
            } else if self.eat('/') {
                product /= self.unary();
            } else {
                return product;
            }
        }
    }

    fn unary(&mut self) -> f64 {
        if self.eat('-') {
            return -self.unary();
        }
        let base = self.atom();
        match self.eat('^') {
            true => power(base, self.unary()),
            false => base,
        }
    }

    fn atom(&mut self) -> f64 {
        let token = self.tokens[self.next].clone();
        self.next += 1;
        match token {
            TokenTree::Literal(number) => number.to_string().parse().expect("a number"),
            TokenTree::Group(group) => self.inner(group.stream()).sum(),
            TokenTree::Ident(name) => match self.tokens.get(self.next).cloned() {
                Some(TokenTree::Group(group)) if group.delimiter() == Delimiter::Parenthesis => {
                    self.next += 1;
                    self.call(&name.to_string(), group.stream())
                }
                Some(TokenTree::Group(index)) => {
                    self.next += 1;
                    self.name(&format!("{name}.{}", index.stream()))
                }
                _ => self.name(&name.to_string()),
            },
            other => panic!("unexpected `{other}`"),
        }
    }

    fn inner(&self, tokens: TokenStream) -> Reader<'_> {
        Reader {
            tokens: tokens.into_iter().collect(),
            next: 0,
            scope: self.scope,
        }
    }

    fn name(&self, name: &str) -> f64 {
        let state = self.scope.state;
        let parameters = self.scope.parameters;
        if let Some(i) = self.coordinate(name) {
            return state.q[i];
        }
        if let Some((_, value)) = parameters.iter().find(|(known, _)| *known == name) {
            return *value;
        }
        if let Some((_, text)) = self
            .scope
            .definitions
            .iter()
            .find(|(known, _)| known == name)
        {
            return self.inner(text.clone()).sum();
        }
        match name {
            "energy" => state.energy,
            "t" => state.t,
            "pi" => std::f64::consts::PI,
            unknown => panic!("unknown name `{unknown}`"),
        }
    }

    fn coordinate(&self, name: &str) -> Option<usize> {
        self.scope
            .coordinates
            .iter()
            .position(|known| *known == name)
    }

    fn call(&self, function: &str, argument: TokenStream) -> f64 {
        let state = self.scope.state;
        let coordinate = || {
            let name = argument.to_string();
            let name = match name.split_once('[') {
                Some((family, index)) => {
                    format!("{}.{}", family.trim(), index.trim_matches([' ', ']']))
                }
                None => name,
            };
            self.coordinate(&name).expect("a coordinate")
        };
        let value = || self.inner(argument.clone()).sum();
        match function {
            "dot" => state.qdot[coordinate()],
            "momentum" => state.p[coordinate()],
            "partial" => f64::from(u8::from(self.scope.partial == Some(coordinate()))),
            "sin" => value().sin(),
            "cos" => value().cos(),
            "exp" => value().exp(),
            "ln" => value().ln(),
            "sqrt" => value().sqrt(),
            "abs" => value().abs(),
            unknown => panic!("unknown function `{unknown}`"),
        }
    }
}

fn power(base: f64, exponent: f64) -> f64 {
    if exponent.fract() == 0.0 {
        base.powi(exponent as i32)
    } else {
        base.powf(exponent)
    }
}
