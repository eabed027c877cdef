//! Layouts as plain text.

use super::layout::Layout;
use crate::pool::Pool;
use crate::rational::Rational;

/// Precedence of the outermost operation.
#[derive(PartialEq, Eq, PartialOrd, Ord)]
enum Binding {
    Sum,
    Product,
    Power,
    Atom,
}

pub(super) fn render(pool: &Pool, layout: &Layout) -> String {
    let mut text = String::new();
    write(pool, layout, &mut text);
    text
}

fn binding(layout: &Layout) -> Binding {
    match layout {
        Layout::Sum(_) | Layout::Negative(_) => Binding::Sum,
        Layout::Quotient(..) => Binding::Product,
        Layout::Power(..) => Binding::Power,
        _ => Binding::Atom,
    }
}

/// Writes a part, in parentheses if it binds less tightly than `least`.
fn write_bound(pool: &Pool, layout: &Layout, least: Binding, out: &mut String) {
    if binding(layout) >= least {
        write(pool, layout, out);
    } else {
        out.push('(');
        write(pool, layout, out);
        out.push(')');
    }
}

fn write(pool: &Pool, layout: &Layout, out: &mut String) {
    match layout {
        Layout::Integer(digits) => out.push_str(digits),
        Layout::Pi => out.push_str("pi"),
        Layout::Symbol(symbol) => out.push_str(pool.symbol_name(*symbol)),
        Layout::Omitted => out.push_str("..."),
        Layout::Negative(part) => {
            out.push('-');
            write_bound(pool, part, Binding::Product, out);
        }
        Layout::Sum(summands) => write_sum(pool, summands, out),
        Layout::Quotient(above, below) => write_quotient(pool, above, below, out),
        Layout::Power(base, exponent) => {
            write_bound(pool, base, Binding::Atom, out);
            out.push_str(&exponent_text(exponent));
        }
        Layout::Root(radicand) => write_call(pool, "sqrt", &[radicand], out),
        Layout::Call(function, argument) => write_call(pool, function.name(), &[argument], out),
        Layout::Atan2(y, x) => write_call(pool, "atan2", &[y, x], out),
    }
}

fn write_sum(pool: &Pool, summands: &[(bool, Layout)], out: &mut String) {
    for (position, (negative, summand)) in summands.iter().enumerate() {
        out.push_str(match (position, negative) {
            (0, false) => "",
            (0, true) => "-",
            (_, false) => " + ",
            (_, true) => " - ",
        });
        write_bound(pool, summand, Binding::Product, out);
    }
}

fn write_quotient(pool: &Pool, above: &[Layout], below: &[Layout], out: &mut String) {
    write_product(pool, above, out);
    match below {
        [] => {}
        [single] => {
            out.push('/');
            write_bound(pool, single, Binding::Power, out);
        }
        _ => {
            out.push_str("/(");
            write_product(pool, below, out);
            out.push(')');
        }
    }
}

fn write_product(pool: &Pool, factors: &[Layout], out: &mut String) {
    for (position, factor) in factors.iter().enumerate() {
        if position > 0 {
            out.push('*');
        }
        write_bound(pool, factor, Binding::Power, out);
    }
}

fn write_call(pool: &Pool, name: &str, arguments: &[&Layout], out: &mut String) {
    out.push_str(name);
    out.push('(');
    for (position, argument) in arguments.iter().enumerate() {
        if position > 0 {
            out.push_str(", ");
        }
        write(pool, argument, out);
    }
    out.push(')');
}

fn exponent_text(exponent: &Rational) -> String {
    if exponent.is_integer() {
        format!("^{exponent}")
    } else {
        format!("^({exponent})")
    }
}
