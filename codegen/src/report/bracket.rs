//! `derive --bracket f,g` and `--jacobiator f,g,h`: the bracket of functions on D, written out.

use dalembert_expr::ExprId;

use super::equations::Writer;
use super::request::Asked;
use super::{Item, Report, ReportError, Section};
use crate::mechanics::bracket::{Bracket, FunctionOnD, derive_bracket};

/// Kind of a bracket of functions.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum BracketKind {
    /// `{f, g}`
    Bracket,
    /// `{{f, g}, h} + {{h, f}, g} + {{g, h}, f}`
    Jacobiator,
}

impl BracketKind {
    /// The number of functions that it takes.
    fn arity(self) -> usize {
        match self {
            Self::Bracket => 2,
            Self::Jacobiator => 3,
        }
    }
}

/// The bracket of functions of a model, or of one of its scenes or modes. The functions are a list in the language of
/// claims: `x, momentum(x)`.
///
/// # Errors
/// [`ReportError`]: an invalid function, a wrong number of functions, or a model without a bracket.
pub fn bracket(
    source: &str,
    part: Option<&str>,
    functions: &str,
    kind: BracketKind,
) -> Result<Report, ReportError> {
    Asked::check_list(functions, "x, momentum(x)")?;
    let mut asked = Asked::of(source, part, &[format!("involution: {functions}")])?;
    let functions = asked.functions();
    if functions.len() != kind.arity() {
        let text = format!(
            "{} functions are needed, found {}",
            kind.arity(),
            functions.len()
        );
        return Err(Asked::refusal(text, "separate them by commas"));
    }
    let bracket = derive_bracket(&mut asked.model, &asked.derivation)
        .map_err(|reason| Asked::refusal(reason.text(), ""))?;
    let on_d: Vec<FunctionOnD> = (functions.iter())
        .map(|function| bracket.on_d(&mut asked.model.pool, function.value))
        .collect();
    let value = value(&mut asked, &bracket, &on_d);
    let pool = &asked.model.pool;
    let texts: Vec<&str> = (functions.iter())
        .map(|function| function.written.as_str())
        .collect();
    let formulas: Vec<String> = (functions.iter())
        .map(|function| pool.latex(function.value))
        .collect();
    let left = match kind {
        BracketKind::Bracket => [
            format!("{{{}}}", texts.join(", ")),
            format!("\\{{{}\\}}", formulas.join(", ")),
        ],
        BracketKind::Jacobiator => [
            format!("Jac({})", texts.join(", ")),
            format!("\\operatorname{{Jac}}({})", formulas.join(", ")),
        ],
    };
    let section = section(&mut asked, left, value, kind);
    Ok(asked.report(vec![section]))
}

fn value(asked: &mut Asked, bracket: &Bracket, functions: &[FunctionOnD]) -> ExprId {
    let pool = &mut asked.model.pool;
    let value = match functions {
        [f, g] => bracket.between(pool, f, g),
        [f, g, h] => bracket.jacobiator(pool, [f, g, h]),
        _ => pool.zero(),
    };
    bracket.written(pool, value)
}

fn section(asked: &mut Asked, left: [String; 2], value: ExprId, kind: BracketKind) -> Section {
    const POISSON: [&str; 2] = [
        "{f, g} = df/dq dg/dp - df/dp dg/dq",
        r"\{f, g\} = \frac{\partial f}{\partial q} \frac{\partial g}{\partial p} - \frac{\partial f}{\partial p} \frac{\partial g}{\partial q}",
    ];
    const ALMOST: [&str; 2] = [
        "{f, g} = {f o P, g o P} on D, P(A + k) = A + g X_0 + pi_D^* k",
        r"\{f, g\} = \{f \circ P, g \circ P\}|_D, \quad P(A + k) = A + g X_0 + \pi_D^* k",
    ];
    const JACOBIATOR: [&str; 2] = [
        "Jac(f, g, h) = {{f, g}, h} + {{h, f}, g} + {{g, h}, f}",
        r"\operatorname{Jac}(f, g, h) = \{\{f, g\}, h\} + \{\{h, f\}, g\} + \{\{g, h\}, f\}",
    ];
    let is_poisson = asked.model.constraints.is_empty();
    let mut writer = Writer {
        model: &mut asked.model,
        derivation: &asked.derivation,
    };
    let [text, latex] = left;
    let mut items = vec![writer.formula(text, latex, value)];
    let remark = match is_poisson {
        true => "a Poisson bracket: no constraints",
        false => "an almost-Poisson bracket of functions on D: its Jacobiator need not be 0",
    };
    items.push(Item::Words(remark.to_owned()));
    if !is_poisson && kind == BracketKind::Bracket {
        let symbols = "P projects momenta to those of velocities in D; A: linear term of L; X_0: a velocity in D";
        items.push(Item::Words(symbols.to_owned()));
    }
    let (title, equation) = match (kind, is_poisson) {
        (BracketKind::Jacobiator, _) => ("Jacobiator", JACOBIATOR),
        (BracketKind::Bracket, true) => ("Bracket", POISSON),
        (BracketKind::Bracket, false) => ("Bracket", ALMOST),
    };
    Section {
        title,
        equation,
        items,
    }
}
