//! Names in formulas: `theta1` is `\theta_{1}`, `ta` is `\mathrm{ta}`, `θ` is `\theta`.

use super::Name;

/// Letters that have a command of their own, by name.
const GREEK: [&str; 34] = [
    "alpha", "beta", "gamma", "delta", "epsilon", "zeta", "eta", "theta", "iota", "kappa",
    "lambda", "mu", "nu", "xi", "rho", "sigma", "tau", "upsilon", "phi", "chi", "psi", "omega",
    "Gamma", "Delta", "Theta", "Lambda", "Xi", "Pi", "Sigma", "Upsilon", "Phi", "Psi", "Omega",
    "varphi",
];

/// Greek letters as characters, with their names.
const LETTERS: [(char, &str); 34] = [
    ('α', "alpha"),
    ('β', "beta"),
    ('γ', "gamma"),
    ('δ', "delta"),
    ('ε', "epsilon"),
    ('ζ', "zeta"),
    ('η', "eta"),
    ('θ', "theta"),
    ('ι', "iota"),
    ('κ', "kappa"),
    ('λ', "lambda"),
    ('μ', "mu"),
    ('ν', "nu"),
    ('ξ', "xi"),
    ('π', "pi"),
    ('ρ', "rho"),
    ('σ', "sigma"),
    ('τ', "tau"),
    ('υ', "upsilon"),
    ('φ', "phi"),
    ('χ', "chi"),
    ('ψ', "psi"),
    ('ω', "omega"),
    ('Γ', "Gamma"),
    ('Δ', "Delta"),
    ('Θ', "Theta"),
    ('Λ', "Lambda"),
    ('Ξ', "Xi"),
    ('Π', "Pi"),
    ('Σ', "Sigma"),
    ('Υ', "Upsilon"),
    ('Φ', "Phi"),
    ('Ψ', "Psi"),
    ('Ω', "Omega"),
];

/// The name of a Greek letter.
pub(super) fn greek_name(letter: char) -> Option<&'static str> {
    LETTERS
        .iter()
        .find(|(character, _)| *character == letter)
        .map(|(_, name)| *name)
}

/// The Greek letter of this name.
pub fn greek_letter(name: &str) -> Option<char> {
    let found = LETTERS.iter().find(|(_, known)| *known == name);
    found.map(|(letter, _)| *letter)
}

/// The name in a formula.
pub(super) fn latex(name: &Name) -> String {
    decorated(name, |letter| letter)
}

/// The velocity of the name in a formula: the dot stands on the letter, not on its index.
pub(super) fn latex_velocity(name: &Name) -> String {
    decorated(name, |letter| format!(r"\dot{{{letter}}}"))
}

fn decorated(name: &Name, decorate: fn(String) -> String) -> String {
    let (letter, mut indices) = split(&name.field);
    indices.extend(name.member.map(|member| member.to_string()));
    let letter = decorate(symbol(letter));
    if indices.is_empty() {
        letter
    } else {
        format!("{letter}_{{{}}}", indices.join(","))
    }
}

/// The letter or word, and its indices: trailing digits, and the part behind an underscore.
fn split(field: &str) -> (&str, Vec<String>) {
    let (word, index) = match field.split_once('_') {
        Some((word, index)) if !word.is_empty() && !index.is_empty() => (word, Some(index)),
        _ => (field, None),
    };
    let letter = word.trim_end_matches(|last: char| last.is_ascii_digit());
    let letter = if letter.is_empty() { word } else { letter };
    let digits = &word[letter.len()..];
    let mut indices: Vec<String> = Vec::new();
    if !digits.is_empty() {
        indices.push(digits.to_owned());
    }
    indices.extend(index.map(|index| index_symbol(&index.replace('_', ","))));
    (letter, indices)
}

fn symbol(letter: &str) -> String {
    let mut characters = letter.chars();
    match (characters.next(), characters.next()) {
        (Some(only), None) => match greek_name(only) {
            Some(greek) => format!(r"\{greek}"),
            None => letter.to_owned(),
        },
        _ if GREEK.contains(&letter) => format!(r"\{letter}"),
        _ => format!(r"\mathrm{{{}}}", letter.replace('_', r"\_")),
    }
}

/// Words in an index stand upright; single letters and numbers do not.
fn index_symbol(index: &str) -> String {
    let is_plain = index
        .split(',')
        .all(|part| part.chars().count() == 1 || part.chars().all(|digit| digit.is_ascii_digit()));
    if is_plain {
        index.to_owned()
    } else {
        format!(r"\mathrm{{{index}}}")
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn name(field: &str, member: Option<usize>) -> Name {
        Name {
            display: field.to_owned(),
            field: field.to_owned(),
            member,
        }
    }

    #[test]
    fn greek_names_and_indices_become_commands() {
        assert_eq!(latex(&name("theta", None)), r"\theta");
        assert_eq!(latex(&name("θ", None)), r"\theta");
        assert_eq!(latex(&name("theta1", None)), r"\theta_{1}");
        assert_eq!(latex(&name("theta", Some(3))), r"\theta_{3}");
        assert_eq!(latex(&name("ta", None)), r"\mathrm{ta}");
        assert_eq!(latex(&name("R", None)), "R");
        assert_eq!(latex(&name("k_t", None)), "k_{t}");
        assert_eq!(latex(&name("m_left", Some(2))), r"m_{\mathrm{left},2}");
    }

    #[test]
    fn the_dot_of_a_velocity_stands_on_the_letter() {
        assert_eq!(latex_velocity(&name("theta", Some(3))), r"\dot{\theta}_{3}");
        assert_eq!(latex_velocity(&name("x", None)), r"\dot{x}");
    }
}
