//! Advice on undeclared names: names that are misspelt, copied from a paper, or in the notation of another language.

use super::latex::greek_name;
use super::resolve::{DerivedNames, Resolver, Scope, Value};
use super::symbols::Meaning;
use crate::diagnostics::{Location, listed, nearest};
use crate::spec::{Declared, FUNCTIONS, PIECEWISE, Word, foreign_function, is_not_differentiable};

/// Letters with a dot above, the notation of velocities in papers.
const DOTTED: [(char, char); 22] = [
    ('ȧ', 'a'),
    ('ḃ', 'b'),
    ('ċ', 'c'),
    ('ḋ', 'd'),
    ('ė', 'e'),
    ('ḟ', 'f'),
    ('ġ', 'g'),
    ('ḣ', 'h'),
    ('ṁ', 'm'),
    ('ṅ', 'n'),
    ('ȯ', 'o'),
    ('ṗ', 'p'),
    ('ṙ', 'r'),
    ('ṡ', 's'),
    ('ṫ', 't'),
    ('ẇ', 'w'),
    ('ẋ', 'x'),
    ('ẏ', 'y'),
    ('ż', 'z'),
    ('Ṙ', 'R'),
    ('Ẋ', 'X'),
    ('Ẏ', 'Y'),
];

/// The combining dot above the preceding letter.
const COMBINING_DOT: char = '\u{307}';

/// Letters of other scripts that look like Latin ones.
const LOOKALIKES: [(char, char); 33] = [
    ('α', 'a'),
    ('γ', 'y'),
    ('ι', 'i'),
    ('κ', 'k'),
    ('ν', 'v'),
    ('ο', 'o'),
    ('ρ', 'p'),
    ('τ', 't'),
    ('υ', 'u'),
    ('χ', 'x'),
    ('ω', 'w'),
    ('Α', 'A'),
    ('Β', 'B'),
    ('Ε', 'E'),
    ('Ζ', 'Z'),
    ('Η', 'H'),
    ('Ι', 'I'),
    ('Κ', 'K'),
    ('Μ', 'M'),
    ('Ν', 'N'),
    ('Ο', 'O'),
    ('Ρ', 'P'),
    ('Τ', 'T'),
    ('Χ', 'X'),
    ('Υ', 'Y'),
    ('а', 'a'),
    ('е', 'e'),
    ('о', 'o'),
    ('р', 'p'),
    ('с', 'c'),
    ('у', 'y'),
    ('х', 'x'),
    ('і', 'i'),
];

impl Resolver<'_> {
    /// Refuses a name that nothing declares.
    pub(super) fn unknown_name(
        &mut self,
        name: &str,
        at: Location,
        scope: &Scope,
    ) -> Option<Value> {
        if let Some((letter, declared)) = self.lookalike(name) {
            let text = format!("`{name}` ({letter}) is not the declared `{declared}`");
            return self.refuse(at, text, &format!("write `{declared}`"));
        }
        if let Some((text, help)) = self.not_yet_known(name) {
            return self.refuse(at, text, help);
        }
        if matches!(name.to_lowercase().as_str(), "inf" | "infinity" | "nan") {
            let help = "numbers are finite; where an interval has no end, write a large one, for example `1e6`";
            return self.refuse(at, format!("`{name}` is not a number"), help);
        }
        let help = self.unknown_help(name, scope);
        self.refuse(at, format!("unknown name `{name}`"), &help)
    }

    /// Message for a declared name that is not known yet. Constants are read in order, before all other declarations.
    pub(super) fn not_yet_known(&self, name: &str) -> Option<(String, &'static str)> {
        let spec = self.spec;
        if spec
            .constants
            .iter()
            .any(|constant| constant.name.text == name)
        {
            let text = format!("`{name}` is used before it is declared");
            return Some((text, "a `const` uses only a `const` above it"));
        }
        let declares = |declared: &Declared| declared.name.text == name;
        let noun = if spec
            .coordinates
            .iter()
            .any(|coordinate| declares(&coordinate.declared))
        {
            "coordinate"
        } else if spec
            .parameters
            .iter()
            .any(|parameter| declares(&parameter.declared))
        {
            "parameter"
        } else if spec.inputs.iter().any(|input| declares(&input.declared)) {
            "input"
        } else if spec
            .definitions
            .iter()
            .any(|definition| declares(&definition.declared))
        {
            "definition"
        } else {
            return None;
        };
        let text = format!("`{name}` is a {noun}, and a constant is expected here");
        Some((text, "write numbers, `pi` and constants"))
    }

    fn unknown_help(&self, name: &str, scope: &Scope) -> String {
        if name.contains('·') {
            return format!(
                "the middle dot is part of the name; write `{}`",
                name.replace('·', "*")
            );
        }
        let outputs = &self.spec.outputs;
        if outputs
            .iter()
            .any(|output| output.declared.name.text == name)
        {
            return format!(
                "`{name}` is an output, and expressions cannot use outputs; declare its expression with `let` and use that"
            );
        }
        let special = self
            .velocity_help(name)
            .or_else(|| self.member_help(name))
            .or_else(|| self.foreign_help(name));
        if let Some(help) = special {
            return help;
        }
        let declared = self
            .symbols
            .names
            .iter()
            .map(|(name, (meaning, _))| (name.as_str(), meaning.noun()));
        let locals = scope.names().map(|name| (name, "index or argument"));
        let known: Vec<(&str, &str)> = declared.chain(locals).collect();
        let near = nearest(name, known.iter().map(|(name, _)| *name));
        match near.and_then(|near| known.iter().find(|(name, _)| *name == near)) {
            Some((near, noun)) => format!("did you mean the {noun} `{near}`?"),
            None => format!("a parameter is declared with `parameters {{ {name}; }}`"),
        }
    }

    /// Advice on `q1`, `q_1` and `q_i`, written for a member of the family `q`.
    pub(super) fn member_help(&self, name: &str) -> Option<String> {
        let is_family = |meaning: Meaning| {
            matches!(meaning, Meaning::Coordinates(..) | Meaning::Parameters(..))
        };
        let families = self
            .symbols
            .names
            .iter()
            .filter(|(_, (meaning, _))| is_family(*meaning));
        let index = |family: &str| {
            let rest = name.strip_prefix(family)?;
            let index = rest.strip_prefix('_').unwrap_or(rest);
            let is_number = !index.is_empty() && index.chars().all(|digit| digit.is_ascii_digit());
            let is_letter = rest.starts_with('_') && matches!(index, "i" | "j" | "k" | "n" | "N");
            (is_number || is_letter)
                .then(|| format!("a member of `{family}` is written `{family}[{index}]`"))
        };
        families
            .map(|(family, _)| family)
            .find_map(|family| index(family))
    }

    /// Advice on names from other notations.
    fn foreign_help(&self, name: &str) -> Option<String> {
        let momentum = name
            .strip_prefix("p_")
            .filter(|field| self.is_coordinate(field));
        let help = match name {
            "PI" | "Pi" | "π" => "write `pi`",
            "e" | "euler" => "declare it; the exponential function is written `exp(x)`",
            "E" | "H" | "Energy" | "ENERGY" if self.derived_names != DerivedNames::Nowhere => {
                "the energy is written `energy`"
            }
            "time" => "time is written `t`",
            _ => {
                return momentum.map(|field| {
                    format!(
                        "in `outputs`, the momentum of `{field}` is written `momentum({field})`"
                    )
                });
            }
        };
        Some(help.to_owned())
    }

    /// Notation of a coordinate in an expression: its name, or a member of the family.
    fn member_or_name(&self, field: &str) -> String {
        match self.symbols.names.get(field) {
            Some((Meaning::Coordinates(..), _)) => format!("{field}[1]"),
            _ => field.to_owned(),
        }
    }

    fn is_coordinate(&self, name: &str) -> bool {
        let coordinates = &self.symbols.coordinates;
        coordinates
            .iter()
            .any(|coordinate| coordinate.name.field == name)
    }

    /// Advice on `xdot`, `x_dot` and `ẋ`, written for `dot(x)`, and on `dx`, written for `d(x)`.
    pub(super) fn velocity_help(&self, name: &str) -> Option<String> {
        if let Some(base) = without_dot(name) {
            let base = self.ascii_name(&base).unwrap_or(base);
            return Some(format!("did you mean `dot({base})`?"));
        }
        let coordinates = self
            .symbols
            .coordinates
            .iter()
            .map(|coordinate| coordinate.name.field.as_str());
        for field in coordinates {
            let rest = name
                .strip_prefix(field)
                .map(|rest| rest.trim_start_matches('_'));
            if rest.is_some_and(|rest| rest == "d" || rest.starts_with("dot")) {
                let member = self.member_or_name(field);
                return Some(format!(
                    "the velocity of `{member}` is written `dot({member})`"
                ));
            }
            if name.strip_prefix('d') == Some(field) {
                return Some(format!(
                    "the differential of `{field}` is written `d({field})`"
                ));
            }
        }
        None
    }

    /// The declared name that a Greek or Cyrillic name resembles or spells, with a description of the letter.
    fn lookalike(&self, name: &str) -> Option<(String, String)> {
        let foreign = name.chars().find(|letter| {
            !letter.is_ascii() && (greek_name(*letter).is_some() || latin(*letter).is_some())
        })?;
        let declared = self.ascii_name(name)?;
        let letter = match greek_name(foreign) {
            Some(greek) => format!("Greek {greek}"),
            None if ('\u{400}'..'\u{500}').contains(&foreign) => "Cyrillic".to_owned(),
            None => "Greek".to_owned(),
        };
        Some((letter, declared))
    }

    /// The declared name that results from spelling out foreign letters, or from replacing them by Latin lookalikes.
    fn ascii_name(&self, name: &str) -> Option<String> {
        let spelt: String = name
            .chars()
            .map(|letter| greek_name(letter).map_or(letter.to_string(), str::to_owned))
            .collect();
        let seen: String = name
            .chars()
            .map(|letter| latin(letter).unwrap_or(letter))
            .collect();
        [spelt, seen]
            .into_iter()
            .find(|candidate| self.symbols.names.contains_key(candidate))
    }

    /// Refuses a call of a function that nothing declares.
    pub(super) fn unknown_function(&mut self, name: &Word) -> Option<Value> {
        let defined = self.definitions.keys().copied();
        let help = if let Some(help) = foreign_function(&name.text) {
            help.to_owned()
        } else if is_not_differentiable(&name.text) {
            format!("`{}` is not differentiable; {PIECEWISE}", name.text)
        } else if let Some(near) = nearest(&name.text, FUNCTIONS.into_iter().chain(defined)) {
            format!(
                "did you mean `{near}`? The functions are {}",
                listed(FUNCTIONS)
            )
        } else {
            format!("the functions are {}", listed(FUNCTIONS))
        };
        self.refuse(name.at, format!("unknown function `{}`", name.text), &help)
    }
}

fn latin(letter: char) -> Option<char> {
    LOOKALIKES
        .iter()
        .find(|(foreign, _)| *foreign == letter)
        .map(|(_, latin)| *latin)
}

/// The name without the dot above one of its letters.
fn without_dot(name: &str) -> Option<String> {
    let plain = |letter: char| {
        DOTTED
            .iter()
            .find(|(dotted, _)| *dotted == letter)
            .map_or(letter, |(_, plain)| *plain)
    };
    let base: String = name
        .chars()
        .filter(|letter| *letter != COMBINING_DOT)
        .map(plain)
        .collect();
    (base != name).then_some(base)
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn dots_above_letters_are_taken_off() {
        assert_eq!(without_dot("ẋ").as_deref(), Some("x"));
        assert_eq!(without_dot("φ\u{307}").as_deref(), Some("φ"));
        assert_eq!(without_dot("x"), None);
    }
}
