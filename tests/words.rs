//! The words of the language are read by the parser and documented. Generator and runtime have the same laws.

use dalembert::{Described, Impacting, Law};
use dalembert_codegen::spec::{self, FUNCTIONS, LAWS, RESET, SECTIONS};

const LANGUAGE: &str = include_str!("../docs/language.md");
const EQUATIONS: &str = include_str!("../docs/equations.md");
const CHECKER: &str = include_str!("../python/check_certificate.py");

/// The text between `start` and the next `end`.
fn between<'a>(text: &'a str, start: &str, end: &str) -> &'a str {
    let (_, rest) = text
        .split_once(start)
        .unwrap_or_else(|| panic!("`{start}`"));
    rest.split_once(end)
        .unwrap_or_else(|| panic!("`{end}` after `{start}`"))
        .0
}

#[test]
fn every_section_is_read_and_documented() {
    let grammar = between(LANGUAGE, "declaration = ", "```");
    for section in SECTIONS {
        let source = format!("Sample {{ {section} }}");
        let errors = spec::parse(source.parse().expect("tokens")).expect_err("half a declaration");
        for error in errors.iter() {
            let unknown = error.message().starts_with("unknown declaration");
            assert!(!unknown, "{}", error.message());
        }
        assert!(
            grammar.contains(&format!("\"{section}\"")),
            "`{section}` is missing in the grammar of docs/language.md"
        );
    }
}

#[test]
fn every_function_is_documented() {
    let listed = FUNCTIONS.join(" ");
    assert_eq!(between(LANGUAGE, "* the functions `", "`"), listed);
    let table = between(LANGUAGE, "**Functions** take", "**Time and rates.**");
    let words: Vec<&str> = table.split(|c: char| !c.is_alphanumeric()).collect();
    for name in FUNCTIONS {
        assert!(
            words.contains(&name),
            "`{name}` is missing in docs/language.md"
        );
    }
}

#[test]
fn the_checker_of_certificates_knows_every_function() {
    let list = between(CHECKER, "FUNCTIONS = {", "}");
    let words: Vec<&str> = list.split(|c: char| !c.is_alphanumeric()).collect();
    for name in FUNCTIONS {
        assert!(
            words.contains(&name),
            "`{name}` is missing in python/check_certificate.py"
        );
    }
}

dalembert::model! {
    /// A surface for each law, of the same name.
    pub EveryLaw {
        coordinates { x; }
        lagrangian = dot(x)^2/2;
        impacts {
            elastic: x + 1 >= 0 => elastic;
            restitution: x + 2 >= 0 => restitution(1/2);
            newton: x + 3 >= 0 => newton(1/2);
            nonholonomic_plastic: x + 4 >= 0 => nonholonomic_plastic;
            impact_plastic: x + 5 >= 0 => impact_plastic;
            totally_plastic: x + 6 >= 0 => totally_plastic;
            reset: x + 7 >= 0 => reset { dot(x) = -dot(x)/2; };
            stop: x + 8 >= 0 => stop;
        }
    }
}

#[test]
fn every_law_of_the_language_is_the_runtimes_law_of_that_name() {
    assert_eq!(LAWS.map(|(name, count)| (name, count == 1)), Law::NAMES);
    let surfaces = &EveryLaw::DESCRIPTION.surfaces;
    assert_eq!(surfaces.len(), LAWS.len(), "a surface for each law");
    for (index, ((name, count), surface)) in LAWS.into_iter().zip(surfaces).enumerate() {
        let law = EveryLaw::default().law(index);
        let written = match (name, count) {
            (RESET, _) => "reset { dot(x) = -dot(x)/2; }".to_owned(),
            (_, 1) => format!("{name}(1/2)"),
            _ => name.to_owned(),
        };
        assert_eq!(
            (surface.name, &*surface.law, law.name()),
            (name, written.as_str(), name)
        );
        assert_eq!(law.coefficient(), (count == 1).then_some(0.5));
    }
}

#[test]
fn every_law_is_documented() {
    for (page, table) in [
        (
            "language.md",
            between(LANGUAGE, "| law | gap rate after |", "\n\n"),
        ),
        ("equations.md", between(EQUATIONS, "| law | eps |", "\n\n")),
    ] {
        for (name, count) in LAWS {
            let row = if count == 1 {
                format!("\n| `{name}(e)`")
            } else {
                format!("\n| `{name}`")
            };
            assert!(table.contains(&row), "`{name}` is missing in docs/{page}");
        }
    }
}
