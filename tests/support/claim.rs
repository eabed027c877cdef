//! Declarations whose claims are replaced, and results of claims: verdicts, and the numbers in messages.

use dalembert_codegen::claims::{Finding, Verdict, examine};
use dalembert_codegen::{mechanics, model, spec};
use dalembert_emit::try_expand;
use proc_macro2::{Delimiter, Group, TokenStream, TokenTree};

use crate::numeric::Numeric;

/// A declaration with its claims taken out.
#[derive(Debug, Clone)]
pub struct Declaration {
    before: TokenStream,
    body: Vec<TokenTree>,
    /// The claims about the model itself as written, without semicolons.
    pub claims: Vec<String>,
}

impl Declaration {
    /// Takes the claims out of a declaration.
    ///
    /// # Panics
    /// If it is not a declaration.
    pub fn of(source: &str) -> Self {
        let tokens: TokenStream = source.parse().expect("tokens");
        let mut before: Vec<TokenTree> = tokens.into_iter().collect();
        let Some(TokenTree::Group(body)) = before.pop() else {
            panic!("a declaration ends with its body");
        };
        let mut declaration = Self {
            before: before.into_iter().collect(),
            body: Vec::new(),
            claims: Vec::new(),
        };
        let mut entries = body.stream().into_iter();
        while let Some(token) = entries.next() {
            if !matches!(&token, TokenTree::Ident(word) if word == "claims") {
                declaration.body.push(token);
                continue;
            }
            match entries.next() {
                Some(TokenTree::Group(claims)) => {
                    declaration.claims.extend(entries_of(claims.stream()))
                }
                // Claims about a scene stay in place: `claims for free { .. }`.
                Some(other) => declaration.body.extend([token, other]),
                None => {}
            }
        }
        declaration
    }

    /// The declaration with one claim on a line of its own, and the number of that line.
    pub fn claiming(&self, claim: &str) -> (String, usize) {
        let body = Group::new(Delimiter::Brace, self.body.iter().cloned().collect());
        let body = body.to_string();
        let open = body.trim_end().strip_suffix('}').expect("a body");
        let head = format!("{} {open}\nclaims {{\n", self.before);
        let line = head.lines().count() + 1;
        (format!("{head}{claim};\n}}\n}}"), line)
    }

    /// The finding on a claim.
    pub fn verdict(&self, claim: &str) -> Finding {
        verdict(&self.claiming(claim).0)
    }
}

/// The entries of a section as text. Each ends with a semicolon, which is left out.
fn entries_of(tokens: TokenStream) -> Vec<String> {
    let mut entries = vec![TokenStream::new()];
    for token in tokens {
        if matches!(&token, TokenTree::Punct(sign) if sign.as_char() == ';') {
            entries.push(TokenStream::new());
        } else {
            entries.last_mut().expect("an entry").extend([token]);
        }
    }
    entries.pop();
    entries.iter().map(TokenStream::to_string).collect()
}

/// The finding on the only claim of a declaration.
///
/// # Panics
/// If the declaration is refused before its claim is examined.
pub fn verdict(source: &str) -> Finding {
    let spec = spec::parse(source.parse().expect("tokens")).expect(source);
    let mut model = model::check(&spec).expect(source);
    let derivation = mechanics::derive(&mut model);
    let mut findings = examine(&mut model, &derivation).findings;
    assert_eq!(findings.len(), 1, "{source}");
    findings.remove(0)
}

/// The only message of a refused declaration, and the first and last line it points at.
///
/// # Panics
/// If the declaration is accepted, or has another number of messages.
pub fn refusal(source: &str) -> (String, [usize; 2]) {
    let Err(refused) = try_expand(source.parse().expect("tokens")) else {
        panic!("accepted: {source}");
    };
    assert_eq!(refused.len(), 1, "{refused:?}");
    let diagnostic = refused.iter().next().expect("a message");
    let (at, text) = &diagnostic.places()[0];
    (text.clone(), [at.first.start().line, at.last.end().line])
}

/// Result of a claim.
#[derive(Debug, Clone, Copy, PartialEq)]
pub enum Outcome {
    /// Proved.
    Proved,
    /// Refuted; the message contains this text.
    Refuted(&'static str),
    /// Left open; the reason contains this text.
    Undecided(&'static str),
    /// Refused before it is examined; the message contains this text.
    Refused(&'static str),
}

/// Checks the result of one claim about a model with these declarations.
///
/// # Panics
/// If the result differs.
#[track_caller]
pub fn check(declarations: &str, claim: &str, expected: Outcome) {
    let source = format!("Sample {{ {declarations} claims {{ {claim}; }} }}");
    if let Outcome::Refused(text) = expected {
        let (message, _) = refusal(&source);
        assert!(message.contains(text), "{claim}: {message}");
        return;
    }
    let finding = verdict(&source);
    let matches = match (&finding.verdict, expected) {
        (Verdict::Proved(_), Outcome::Proved) => true,
        (Verdict::Refuted(witness), Outcome::Refuted(text)) => witness.to_string().contains(text),
        (Verdict::Undecided(reason), Outcome::Undecided(text)) => reason.contains(text),
        _ => false,
    };
    assert!(
        matches,
        "{claim}: expected {expected:?}, found {}",
        finding.note()
    );
}

/// The numbers of a message.
#[derive(Debug, Clone, PartialEq)]
pub struct Witness {
    /// Computed values such as `delta = -0.39`: names and values in order.
    pub values: Vec<(String, f64)>,
    /// State and parameters such as `at x = 0.36, m = 2`: names and values in order.
    pub at: Vec<(String, f64)>,
}

impl Witness {
    /// Reads the values of a message, and the state; `None` if it shows no values.
    ///
    /// # Panics
    /// If a number cannot be read.
    pub fn of(message: &str) -> Option<Self> {
        // Lines with an example are read by `example`.
        let is_value = |line: &&str| {
            let number = line.rsplit_once(" = ");
            let is_number = number.is_some_and(|(_, value)| value.parse::<f64>().is_ok());
            is_number && !line.starts_with("for example ")
        };
        let lines = message.lines().skip(1);
        let place = message.lines().find_map(|line| line.strip_prefix("at "));
        let values: Vec<_> = lines
            .take_while(|line| !line.starts_with("at "))
            .filter(is_value)
            .map(pair)
            .collect();
        let at = place.map_or(Vec::new(), pairs);
        (!values.is_empty()).then_some(Self { values, at })
    }

    /// Reads the example of a message, a state at which the terms of a rate cancel; `None` if it has none.
    ///
    /// # Panics
    /// If a number cannot be read.
    pub fn example(message: &str) -> Option<Self> {
        let mut lines = message.lines();
        let line = lines.find_map(|line| line.strip_prefix("for example "))?;
        let (values, at) = line.rsplit_once(" at ").expect("a place");
        let [values, at] = [values, at].map(pairs);
        Some(Self { values, at })
    }

    /// A value by its name.
    ///
    /// # Panics
    /// If there is no such value.
    pub fn value(&self, name: &str) -> f64 {
        let found = self.values.iter().find(|(known, _)| known == name);
        found.unwrap_or_else(|| panic!("no `{name}` in {self:?}")).1
    }

    /// Sets the parameters of a system to those of the message, and returns time, positions and velocities; quantities
    /// that the message does not show are 0.
    pub fn place(&self, system: &mut dyn Numeric) -> (f64, Vec<f64>, Vec<f64>) {
        let names: Vec<&str> = system
            .description()
            .coordinates
            .iter()
            .map(|coordinate| coordinate.name)
            .collect();
        let (mut t, mut q) = (0.0, vec![0.0; names.len()]);
        let mut qdot = q.clone();
        for (name, value) in &self.at {
            let velocity = name
                .strip_prefix("dot(")
                .and_then(|rest| rest.strip_suffix(')'));
            let position = |name: &str| names.iter().position(|known| *known == name);
            if let Some(i) = velocity.and_then(position) {
                qdot[i] = *value;
            } else if let Some(i) = position(name) {
                q[i] = *value;
            } else if name == "t" {
                t = *value;
            } else {
                assert!(system.set(name, *value), "unknown `{name}`");
            }
        }
        (t, q, qdot)
    }
}

/// Name and value of `name = 1.5`.
fn pair(text: &str) -> (String, f64) {
    let (name, value) = text.rsplit_once(" = ").expect("a name and a value");
    (name.to_owned(), value.parse().expect("a number"))
}

/// Names and values of `x = 1.5, dot(x) = -2`. Names may contain commas.
fn pairs(text: &str) -> Vec<(String, f64)> {
    let mut found = Vec::new();
    let mut open = String::new();
    for piece in text.split(", ") {
        open += piece;
        let value = open.rsplit_once(" = ").map(|(_, value)| value);
        match value.is_some_and(|value| value.parse::<f64>().is_ok()) {
            true => found.push(pair(&std::mem::take(&mut open))),
            false => open += ", ",
        }
    }
    assert!(open.is_empty(), "{text}");
    found
}
