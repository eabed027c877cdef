//! Formulas of captions, such as `$mu = 5/2$`, as MathML.

use std::fmt::Write as _;

use super::page::escaped;
use crate::symbols::Symbol;

/// Typesets the formulas between dollar signs and escapes the text around them.
pub fn typeset(text: &str) -> String {
    let mut page = String::new();
    for (place, part) in text.split('$').enumerate() {
        match place % 2 {
            0 => page += &escaped(part),
            _ => page += &formula(part),
        }
    }
    page
}

/// Typesets a formula: names, numbers, fractions of two of them, powers, and other signs.
fn formula(text: &str) -> String {
    let tokens = tokens(text);
    let mut parts = String::new();
    let mut place = 0;
    while let Some(token) = tokens.get(place) {
        let next = |ahead: usize| tokens.get(place + ahead).map(String::as_str);
        match (next(1), next(2)) {
            (Some("/"), Some(below)) if is_operand(token) && is_operand(below) => {
                let _ = write!(parts, "<mfrac>{}{}</mfrac>", element(token), element(below));
                place += 3;
            }
            (Some("^"), Some(power)) => {
                let _ = write!(parts, "<msup>{}{}</msup>", element(token), element(power));
                place += 3;
            }
            _ => {
                parts += &element(token);
                place += 1;
            }
        }
    }
    format!("<math>{parts}</math>")
}

/// Splits a formula into names, numbers and single other signs.
fn tokens(text: &str) -> Vec<String> {
    let mut tokens: Vec<String> = Vec::new();
    let mut is_open = false;
    for sign in text.chars() {
        let is_part = sign.is_alphanumeric() || sign == '_' || sign == '.';
        match tokens.last_mut() {
            Some(last) if is_open && is_part => last.push(sign),
            _ if sign != ' ' => tokens.push(sign.to_string()),
            _ => {}
        }
        is_open = is_part;
    }
    tokens
}

fn is_operand(token: &str) -> bool {
    token.chars().all(char::is_alphanumeric)
}

fn element(token: &str) -> String {
    let is_number = token.starts_with(|it: char| it.is_ascii_digit());
    if is_number {
        return format!("<mn>{}</mn>", escaped(token));
    }
    let sign = match token {
        "-" => "−",
        "*" => "\u{2062}",
        other => other,
    };
    if !token.starts_with(char::is_alphabetic) {
        return format!("<mo>{}</mo>", escaped(sign));
    }
    if let Some(coordinate) = token.strip_prefix("p_") {
        return format!("<msub><mi>p</mi>{}</msub>", element(coordinate));
    }
    let Some(symbol) = Symbol::of(token) else {
        return format!("<mi>{}</mi>", escaped(token));
    };
    let letter = format!("<mi>{}</mi>", symbol.letter);
    let rate = match symbol.is_rate {
        true => format!("<mover>{letter}<mo>˙</mo></mover>"),
        false => letter,
    };
    match symbol.index.as_str() {
        "" => rate,
        index => format!("<msub>{rate}<mn>{index}</mn></msub>"),
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn formulas_are_typeset_and_text_is_escaped() {
        assert_eq!(
            typeset("a < b, $mu = 5/2$."),
            "a &lt; b, <math><mi>μ</mi><mo>=</mo><mfrac><mn>5</mn><mn>2</mn></mfrac></math>."
        );
        assert_eq!(
            typeset("$theta1_dot = -0.5$"),
            "<math><msub><mover><mi>θ</mi><mo>˙</mo></mover><mn>1</mn></msub><mo>=</mo><mo>−</mo><mn>0.5</mn></math>"
        );
        assert_eq!(
            typeset("$10^6$"),
            "<math><msup><mn>10</mn><mn>6</mn></msup></math>"
        );
        assert_eq!(
            typeset("$p_phi$"),
            "<math><msub><mi>p</mi><mi>φ</mi></msub></math>"
        );
        assert_eq!(typeset("no formula"), "no formula");
    }
}
