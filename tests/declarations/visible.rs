//! Systems of `reference/verdicts_visible.json`, as declarations that can be transformed.

use serde_json::Value;

/// The systems of `reference/verdicts_visible.json`.
///
/// # Panics
/// If the file does not have the documented form.
pub fn visible_systems() -> Vec<Value> {
    let text = include_str!("../reference/verdicts_visible.json");
    let file: Value = serde_json::from_str(text).expect("JSON");
    let systems = file["systems"].as_array().expect("systems");
    assert!(systems.len() >= 19);
    systems.clone()
}

/// The system of this name.
///
/// # Panics
/// If there is no system of this name.
pub fn visible_system(name: &str) -> Value {
    let mut systems = visible_systems().into_iter();
    systems.find(|system| system["name"] == name).expect(name)
}

/// Coordinates, parameters, Lagrangian and constraints of a system, in the notation of `model!`.
#[derive(Debug, Clone)]
pub struct Scheme {
    /// Names and domains: `R`, `S1` or an interval.
    pub coordinates: Vec<(String, String)>,
    /// The entries of `parameters`.
    pub parameters: String,
    /// Declarations between parameters and Lagrangian.
    pub definitions: String,
    /// The Lagrangian.
    pub lagrangian: String,
    /// The coefficients of each constraint for the differentials of the functions in `columns`.
    pub forms: Vec<Vec<String>>,
    /// Functions whose differentials the constraints combine; the coordinates, unless these were transformed.
    pub columns: Vec<String>,
}

impl Scheme {
    /// A system of the file.
    ///
    /// # Panics
    /// If the file does not have the documented form.
    pub fn of(system: &Value) -> Self {
        let list = |value: &Value| value.as_array().expect("a list").clone();
        let text = |value: &Value| value.as_str().expect("a text").to_owned();
        let coordinates: Vec<_> = list(&system["coordinates"])
            .iter()
            .map(|coordinate| (text(&coordinate["name"]), text(&coordinate["domain"])))
            .collect();
        let mut parameters = String::new();
        for parameter in list(&system["params"]) {
            let is_positive = parameter["positive"] == Value::Bool(true);
            let assumption = if is_positive { " > 0" } else { "" };
            let (name, sample) = (text(&parameter["name"]), text(&parameter["sample"]));
            parameters += &format!("{name}{assumption} = {sample}; ");
        }
        let translate = |value: &Value| {
            let mut formula = text(value).replace("**", "^");
            for (name, _) in &coordinates {
                formula = formula.replace(&format!("{name}_dot"), &format!("dot({name})"));
            }
            formula
        };
        let row = |form: &Value| list(form).iter().map(translate).collect();
        Self {
            forms: list(&system["eta"]).iter().map(row).collect(),
            lagrangian: format!(
                "{} - ({})",
                translate(&system["kinetic"]),
                translate(&system["potential"])
            ),
            definitions: String::new(),
            columns: coordinates.iter().map(|(name, _)| name.clone()).collect(),
            coordinates,
            parameters,
        }
    }

    /// The body of a `model!`.
    pub fn declaration(&self) -> String {
        let coordinate = |(name, domain): &(String, String)| match domain.as_str() {
            "R" => format!("{name}; "),
            "S1" => format!("{name}: angle; "),
            interval => format!("{name} in {interval}; "),
        };
        let coordinates: String = self.coordinates.iter().map(coordinate).collect();
        let mut constraints = String::new();
        for (a, form) in self.forms.iter().enumerate() {
            let terms: Vec<String> = form
                .iter()
                .zip(&self.columns)
                .map(|(entry, name)| format!("({entry})*d({name})"))
                .collect();
            constraints += &format!("c{}: {} = 0; ", a + 1, terms.join(" + "));
        }
        let (parameters, definitions) = (&self.parameters, &self.definitions);
        let lagrangian = &self.lagrangian;
        format!(
            "Sample {{ coordinates {{ {coordinates}}} parameters {{ {parameters}}} {definitions}\
             lagrangian = {lagrangian}; constraints {{ {constraints}}} }}"
        )
    }
}

/// The body of a `model!` for a system of the file.
///
/// # Panics
/// If the file does not have the documented form.
pub fn declaration(system: &Value) -> String {
    Scheme::of(system).declaration()
}
