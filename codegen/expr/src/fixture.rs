//! Fixture of tests: reads expressions from text in the usual notation of arithmetic.

use crate::{Assumption, ExprId, Function, Pool, Rational, SymbolId};

/// A pool with named symbols.
pub(crate) struct Fixture {
    pub(crate) pool: Pool,
    names: Vec<(String, SymbolId)>,
}

impl Fixture {
    /// Real symbols `x y z a b t theta phi dot(x) dot(y)`, positive `m l k g`, nonnegative `w`, nonzero `n`.
    pub(crate) fn new() -> Self {
        let mut fixture = Self {
            pool: Pool::new(),
            names: Vec::new(),
        };
        for name in ["x", "y", "z", "a", "b", "t"] {
            fixture.declare(name, name, Assumption::None);
        }
        for (name, latex) in [("theta", r"\theta"), ("phi", r"\phi")] {
            fixture.declare(name, latex, Assumption::None);
        }
        for (name, latex) in [("dot(x)", r"\dot{x}"), ("dot(y)", r"\dot{y}")] {
            fixture.declare(name, latex, Assumption::None);
        }
        for name in ["m", "l", "k", "g"] {
            fixture.declare(name, name, Assumption::Positive);
        }
        fixture.declare("w", "w", Assumption::NonNegative);
        fixture.declare("n", "n", Assumption::NonZero);
        fixture
    }

    fn declare(&mut self, name: &str, latex: &str, assumption: Assumption) {
        let symbol = self.pool.symbol(name, latex, assumption);
        self.names.push((name.into(), symbol));
    }

    pub(crate) fn symbol(&self, name: &str) -> SymbolId {
        self.names
            .iter()
            .find(|(known, _)| known == name)
            .unwrap()
            .1
    }

    pub(crate) fn read(&mut self, text: &str) -> ExprId {
        let text: String = text.split_whitespace().collect();
        let mut reader = Reader {
            rest: &text,
            fixture: self,
        };
        let id = reader.sum();
        assert_eq!(reader.rest, "", "not read to the end: {text}");
        id
    }

    pub(crate) fn read_all<const N: usize>(&mut self, texts: [&str; N]) -> [ExprId; N] {
        texts.map(|text| self.read(text))
    }

    /// The text of an expression that was read and built.
    pub(crate) fn echo(&mut self, text: &str) -> String {
        let id = self.read(text);
        self.pool.text(id)
    }
}

struct Reader<'a> {
    rest: &'a str,
    fixture: &'a mut Fixture,
}

impl Reader<'_> {
    fn eat(&mut self, token: &str) -> bool {
        match self.rest.strip_prefix(token) {
            Some(rest) => {
                self.rest = rest;
                true
            }
            None => false,
        }
    }

    fn sum(&mut self) -> ExprId {
        let mut sum = self.product();
        loop {
            let next = if self.eat("+") {
                Pool::add
            } else if self.eat("-") {
                Pool::sub
            } else {
                return sum;
            };
            let product = self.product();
            sum = next(&mut self.fixture.pool, sum, product);
        }
    }

    fn product(&mut self) -> ExprId {
        if self.eat("-") {
            let product = self.product();
            return self.fixture.pool.neg(product);
        }
        let mut product = self.power();
        loop {
            let next = if self.eat("*") {
                Pool::mul
            } else if self.eat("/") {
                Pool::div
            } else {
                return product;
            };
            let factor = self.power();
            product = next(&mut self.fixture.pool, product, factor);
        }
    }

    fn power(&mut self) -> ExprId {
        let base = self.atom();
        if !self.eat("^") {
            return base;
        }
        let negative = self.eat("-");
        let exponent = self.power();
        let exponent = self.fixture.pool.as_number(exponent).unwrap().clone();
        self.fixture
            .pool
            .pow(base, if negative { -exponent } else { exponent })
    }

    fn atom(&mut self) -> ExprId {
        if self.eat("(") {
            let inner = self.sum();
            assert!(self.eat(")"));
            return inner;
        }
        let end = self
            .rest
            .find(|c: char| !c.is_alphanumeric() && c != '.')
            .unwrap_or(self.rest.len());
        let (word, rest) = self.rest.split_at(end);
        self.rest = rest;
        if word == "dot" {
            let (argument, rest) = self.rest.split_at(3);
            self.rest = rest;
            let symbol = self.fixture.symbol(&format!("dot{argument}"));
            return self.fixture.pool.variable(symbol);
        }
        if self.eat("(") {
            return self.call(word);
        }
        match Rational::from_decimal(word) {
            Some(value) => self.fixture.pool.number(value),
            None if word == "pi" => self.fixture.pool.pi(),
            None => {
                let symbol = self.fixture.symbol(word);
                self.fixture.pool.variable(symbol)
            }
        }
    }

    fn call(&mut self, name: &str) -> ExprId {
        let first = self.sum();
        let second = self.eat(",").then(|| self.sum());
        assert!(self.eat(")"));
        match (name, second) {
            ("atan2", Some(x)) => self.fixture.pool.atan2(first, x),
            ("sqrt", None) => self.fixture.pool.sqrt(first),
            _ => self
                .fixture
                .pool
                .call(Function::from_name(name).unwrap(), first),
        }
    }
}
