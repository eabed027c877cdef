//! LaTeX output of layouts.

use super::layout::Layout;
use crate::function::{Function, Notation};
use crate::pool::Pool;
use crate::rational::Rational;

pub(super) fn render(pool: &Pool, layout: &Layout) -> String {
    match layout {
        Layout::Integer(digits) => digits.clone(),
        Layout::Pi => r"\pi".into(),
        Layout::Symbol(symbol) => pool.symbol_latex(*symbol).into(),
        Layout::Omitted => r"\ldots".into(),
        Layout::Negative(part) => format!("-{}", render_factor(pool, part, is_sum(part))),
        Layout::Sum(summands) => render_sum(pool, summands),
        Layout::Quotient(above, below) if below.is_empty() => render_product(pool, above),
        Layout::Quotient(above, below) => {
            format!(
                r"\frac{{{}}}{{{}}}",
                render_product(pool, above),
                render_product(pool, below)
            )
        }
        Layout::Power(base, exponent) => render_power(pool, base, exponent),
        Layout::Root(radicand) => format!(r"\sqrt{{{}}}", render(pool, radicand)),
        Layout::Call(function, argument) => render_call(*function, "", &render(pool, argument)),
        Layout::Atan2(y, x) => {
            let arguments = format!("{}, {}", render(pool, y), render(pool, x));
            format!(r"\operatorname{{atan2}}{}", parenthesised(&arguments))
        }
    }
}

fn is_sum(layout: &Layout) -> bool {
    matches!(layout, Layout::Sum(_) | Layout::Negative(_))
}

fn parenthesised(inner: &str) -> String {
    if inner.contains(r"\frac") || inner.contains(r"\left") {
        format!(r"\left({inner}\right)")
    } else {
        format!("({inner})")
    }
}

fn render_factor(pool: &Pool, layout: &Layout, enclosed: bool) -> String {
    let inner = render(pool, layout);
    if enclosed {
        parenthesised(&inner)
    } else {
        inner
    }
}

fn render_sum(pool: &Pool, summands: &[(bool, Layout)]) -> String {
    let mut out = String::new();
    for (position, (negative, summand)) in summands.iter().enumerate() {
        out.push_str(match (position, negative) {
            (0, false) => "",
            (0, true) => "-",
            (_, false) => " + ",
            (_, true) => " - ",
        });
        out.push_str(&render_factor(pool, summand, is_sum(summand)));
    }
    out
}

fn render_product(pool: &Pool, factors: &[Layout]) -> String {
    let mut out = String::new();
    for factor in factors {
        let inner = render_factor(pool, factor, factors.len() > 1 && is_sum(factor));
        if !out.is_empty() {
            // Two numbers side by side would read as one.
            out.push_str(if inner.starts_with(|c: char| c.is_ascii_digit()) {
                r" \cdot "
            } else {
                " "
            });
        }
        out.push_str(&inner);
    }
    out
}

fn render_power(pool: &Pool, base: &Layout, exponent: &Rational) -> String {
    let exponent = format!("^{{{exponent}}}");
    match base {
        Layout::Call(function, argument) if takes_power(*function) => {
            render_call(*function, &exponent, &render(pool, argument))
        }
        Layout::Integer(_) | Layout::Pi | Layout::Atan2(..) => render(pool, base) + &exponent,
        Layout::Call(Function::Abs, _) => render(pool, base) + &exponent,
        Layout::Symbol(symbol) => match pool.symbol_latex(*symbol) {
            latex if latex.contains('^') => format!("{{{latex}}}{exponent}"),
            latex => format!("{latex}{exponent}"),
        },
        _ => parenthesised(&render(pool, base)) + &exponent,
    }
}

/// True if the exponent is written after the function's name, `\cos^{2}(x)`.
fn takes_power(function: Function) -> bool {
    matches!(function.notation(), Notation::Command(_))
}

fn render_call(function: Function, exponent: &str, argument: &str) -> String {
    match function.notation() {
        Notation::Command(name) => format!("{name}{exponent}{}", parenthesised(argument)),
        Notation::PowerOfE => format!("e^{{{argument}}}"),
        Notation::Bars => format!(r"\left|{argument}\right|"),
    }
}
