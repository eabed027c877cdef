//! Symbols for the names of quantities, as pictures and pages show them: `theta_dot` is θ with a dot, `x1` is x with
//! the subscript 1.

use dalembert_codegen::model::greek_letter;

/// A dot above the letter before it.
const DOT: char = '\u{307}';

/// Subscript digits.
const INDICES: [char; 10] = ['₀', '₁', '₂', '₃', '₄', '₅', '₆', '₇', '₈', '₉'];

/// Parts of a name of a quantity.
#[derive(Debug, Clone, PartialEq, Eq)]
pub struct Symbol {
    /// One letter.
    pub letter: String,
    /// True for a rate.
    pub is_rate: bool,
    /// The index: digits, or two numbers with a comma between them. Empty if there is none.
    pub index: String,
}

impl Symbol {
    /// The parts of a name: `x`, `x_dot`, `theta1_dot`, `theta_dot.3`. `None` for a word of several letters that is not
    /// the name of a Greek letter, and for an index that is not a number.
    pub fn of(name: &str) -> Option<Self> {
        let (family, member) = name.split_once('.').unwrap_or((name, ""));
        let (family, is_rate) = match family.strip_suffix("_dot") {
            Some(family) => (family, true),
            None => (family, false),
        };
        let letters = family.trim_end_matches(|it: char| it.is_ascii_digit());
        // A common abbreviation.
        let name = if letters == "eps" { "epsilon" } else { letters };
        let letter = match greek_letter(name) {
            Some(letter) => letter.to_string(),
            None if letters.chars().count() == 1 => letters.to_owned(),
            None => return None,
        };
        let digits = &family[letters.len()..];
        let index = match (digits, member) {
            ("", member) => member.to_owned(),
            (digits, "") => digits.to_owned(),
            (digits, member) => format!("{digits},{member}"),
        };
        let is_number = |it: char| it.is_ascii_digit() || it == ',';
        (index.chars().all(is_number)).then_some(Self {
            letter,
            is_rate,
            index,
        })
    }
}

/// A name as plain text: `ẋ₁` for `x1_dot`. A name that is no symbol keeps its letters, with spaces for underscores;
/// its rate is written `d(name)/dt`.
pub fn text(name: &str) -> String {
    if let Some(momentum) = name.strip_prefix("p_") {
        return format!("p_{}", text(momentum));
    }
    match (Symbol::of(name), name.strip_suffix("_dot")) {
        (Some(symbol), _) => {
            let dot = symbol.is_rate.then_some(DOT);
            let index = symbol.index.chars().map(lowered);
            symbol.letter.chars().chain(dot).chain(index).collect()
        }
        (None, Some(word)) => format!("d({})/dt", word.replace('_', " ")),
        (None, None) => name.replace('_', " "),
    }
}

/// The subscript of a digit; other characters stay.
fn lowered(digit: char) -> char {
    let place = digit.to_digit(10).map(|place| place as usize);
    place.map_or(digit, |place| INDICES[place])
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn names_have_symbols() {
        for (name, expected) in [
            ("x", "x"),
            ("theta", "θ"),
            ("x_dot", "x\u{307}"),
            ("theta1_dot", "θ\u{307}₁"),
            ("x_dot.12", "x\u{307}₁₂"),
            ("theta.3", "θ₃"),
            ("p_phi", "p_φ"),
            ("p_x1", "p_x₁"),
            ("spring_force", "spring force"),
            ("roll_dot", "d(roll)/dt"),
            ("energy", "energy"),
        ] {
            assert_eq!(text(name), expected);
        }
    }
}
