//! Systems of `reference/verdicts_visible.json` as declarations.

use serde_json::Value;

/// The body of a `model!`: the system's coordinates, parameters, Lagrangian and constraints.
///
/// # Panics
/// If the file has not the documented form.
pub fn declaration(system: &Value) -> String {
    let list = |key: &str| system[key].as_array().expect("a list");
    let text = |value: &Value| value.as_str().expect("a text").to_owned();
    let mut velocities = Vec::new();
    let mut coordinates = String::new();
    for coordinate in list("coordinates") {
        let name = text(&coordinate["name"]);
        let domain = text(&coordinate["domain"]);
        coordinates += &match domain.as_str() {
            "R" => format!("{name}; "),
            "S1" => format!("{name}: angle; "),
            interval => format!("{name} in {interval}; "),
        };
        velocities.push(name);
    }
    let mut parameters = String::new();
    for parameter in list("params") {
        let assumption = if parameter["positive"] == Value::Bool(true) {
            " > 0"
        } else {
            ""
        };
        let (name, sample) = (text(&parameter["name"]), text(&parameter["sample"]));
        parameters += &format!("{name}{assumption} = {sample}; ");
    }
    let translate = |formula: &str| {
        let mut formula = formula.replace("**", "^");
        for name in &velocities {
            formula = formula.replace(&format!("{name}_dot"), &format!("dot({name})"));
        }
        formula
    };
    let mut constraints = String::new();
    for (a, form) in list("eta").iter().enumerate() {
        let terms: Vec<String> = form
            .as_array()
            .expect("a form")
            .iter()
            .zip(&velocities)
            .map(|(entry, name)| format!("({})*d({name})", translate(&text(entry))))
            .collect();
        constraints += &format!("c{}: {} = 0; ", a + 1, terms.join(" + "));
    }
    format!(
        "Sample {{ coordinates {{ {coordinates}}} parameters {{ {parameters}}} lagrangian = {} - ({}); \
         constraints {{ {constraints}}} }}",
        translate(&text(&system["kinetic"])),
        translate(&text(&system["potential"])),
    )
}
