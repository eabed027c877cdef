//! The words of the language: sections, functions, laws, and names that cannot be declared.

use dalembert_expr::Function;

/// The keywords that begin a declaration of a model.
pub const SECTIONS: [&str; 19] = [
    "const",
    "coordinates",
    "parameters",
    "let",
    "lagrangian",
    "field",
    "constraints",
    "inputs",
    "cost",
    "forces",
    "frame",
    "impacts",
    "modes",
    "transitions",
    "initial",
    "view",
    "outputs",
    "scenes",
    "claims",
];

/// The elementary functions: `sqrt`, the functions of one argument in the order of [`Function::ALL`], and `atan2`.
pub const FUNCTIONS: [&str; Function::ALL.len() + 2] = {
    let mut names = ["sqrt"; Function::ALL.len() + 2];
    let mut index = 0;
    while index < Function::ALL.len() {
        names[index + 1] = Function::ALL[index].name();
        index += 1;
    }
    names[index + 1] = "atan2";
    names
};

/// Names of declarations in other languages, with advice.
const FOREIGN_SECTIONS: [(&str, &str); 18] = [
    ("L", "write `lagrangian = ..;`"),
    ("until", "write it into `initial { until = ..; }`"),
    ("coords", "write `coordinates { .. }`"),
    ("variables", "write `coordinates { .. }`"),
    ("states", "write `coordinates { .. }`"),
    ("params", "write `parameters { .. }`"),
    (
        "constants",
        "write `parameters { .. }`, or `const N = 8;` for a size",
    ),
    ("surfaces", "write `impacts { .. }`"),
    ("walls", "write `impacts { .. }`"),
    ("guards", "write `impacts { .. }`"),
    ("events", "write `impacts { .. }`"),
    (
        "kinetic",
        "the Lagrangian is kinetic minus potential energy: `lagrangian = ..;`",
    ),
    (
        "potential",
        "the Lagrangian is kinetic minus potential energy: `lagrangian = ..;`",
    ),
    (
        "hamiltonian",
        "declare the Lagrangian it belongs to: `lagrangian = ..;`",
    ),
    ("observables", "write `outputs { .. }`"),
    ("objective", "write `cost { running = ..; }`"),
    ("fn", "a function is written `let f(u) = ..;`"),
    ("def", "a function is written `let f(u) = ..;`"),
];

/// Functions of other languages, with advice.
const FOREIGN_FUNCTIONS: [(&str, &str); 28] = [
    ("log", "write `ln(..)`"),
    ("log10", "write `ln(..)/ln(10)`"),
    ("deg", "angles are in radians: 30 degrees are `30*pi/180`"),
    (
        "radians",
        "angles are in radians: 30 degrees are `30*pi/180`",
    ),
    (
        "degrees",
        "angles are in radians: 30 degrees are `30*pi/180`",
    ),
    ("log2", "write `ln(..)/ln(2)`"),
    ("arcsin", "write `asin(..)`"),
    ("arccos", "write `acos(..)`"),
    ("arctan", "write `atan(..)`"),
    ("arctan2", "write `atan2(y, x)`"),
    ("pow", "write `a^b`"),
    ("powi", "write `a^b`"),
    ("powf", "write `a^b`"),
    ("cbrt", "write `x^(1/3)`"),
    ("tg", "write `tan(..)`"),
    ("ddt", "write `dot(..)`"),
    ("diff", "write `dot(..)` for a time derivative"),
    (
        "ddot",
        "a declaration has no accelerations: they follow from it",
    ),
    (
        "dddot",
        "a declaration has no accelerations: they follow from it",
    ),
    ("norm", "write `sqrt(x^2 + y^2)`"),
    ("hypot", "write `sqrt(x^2 + y^2)`"),
    ("square", "write `x^2`"),
    ("sec", "write `1/cos(..)`"),
    ("csc", "write `1/sin(..)`"),
    ("cot", "write `1/tan(..)`"),
    ("fabs", "write `abs(..)`"),
    ("lambda", "write `multiplier(..)`, in `outputs`"),
    ("p", "write `momentum(..)`, in `outputs`"),
];

/// Functions that are not differentiable and are refused in expressions.
const NOT_DIFFERENTIABLE: [&str; 11] = [
    "clamp",
    "clip",
    "max",
    "min",
    "floor",
    "ceil",
    "round",
    "sgn",
    "sign",
    "signum",
    "heaviside",
];

/// The impact laws, with the number of their coefficients.
pub const LAWS: [(&str, usize); 8] = [
    ("elastic", 0),
    ("restitution", 1),
    ("newton", 1),
    ("nonholonomic_plastic", 0),
    ("impact_plastic", 0),
    ("totally_plastic", 0),
    (RESET, 0),
    (STOP, 0),
];

/// The law that is a map: `reset { x = ..; dot(x) = ..; }`.
pub const RESET: &str = "reset";

/// The law that ends the motion.
pub const STOP: &str = "stop";

/// The function that makes an output the integral of its argument along a run.
pub const INTEGRAL: &str = "integral";

/// The Lagrangian: its declaration, and its name in `outputs`.
pub const LAGRANGIAN: &str = "lagrangian";

/// The word that replaces `when`: the surface counts where no other surface with the same gap counts.
pub const OTHERWISE: &str = "otherwise";

/// The word before constraints that hold only at impacts on a surface and in contact with it:
/// `=> LAW, instantaneous { .. }`.
pub const INSTANTANEOUS: &str = "instantaneous";

/// Extras of a scene besides named forces and surfaces. `projection` is the projection onto the constraints after
/// steps, `volume` stands for density form, divergence and invariant volume.
pub const EXTRAS: [&str; 3] = ["projection", "volume", "variations"];

/// Name of the scene with everything that was declared: the model itself.
pub const WHOLE: &str = "all";

/// Words with a meaning of their own in expressions.
const RESERVED: [&str; 14] = [
    "t",
    "pi",
    "d",
    "dot",
    "sum",
    "energy",
    "momentum",
    "multiplier",
    "partial",
    INTEGRAL,
    LAGRANGIAN,
    "until",
    "when",
    OTHERWISE,
];

/// Words that Rust does not accept as the name of a field.
const RUST: [&str; 52] = [
    "as", "async", "await", "break", "const", "continue", "crate", "dyn", "else", "enum", "extern",
    "false", "fn", "for", "gen", "if", "impl", "in", "let", "loop", "match", "mod", "move", "mut",
    "pub", "ref", "return", "self", "Self", "static", "struct", "super", "trait", "true", "type",
    "unsafe", "use", "where", "while", "abstract", "become", "box", "do", "final", "macro",
    "override", "priv", "try", "typeof", "unsized", "virtual", "yield",
];

/// True if Rust reserves this word.
pub fn is_rust_keyword(name: &str) -> bool {
    RUST.contains(&name)
}

/// Functions and operators that take their arguments in parentheses.
pub fn is_function(name: &str) -> bool {
    FUNCTIONS.contains(&name)
        || matches!(
            name,
            "d" | "dot" | "sum" | "momentum" | "multiplier" | "partial" | INTEGRAL
        )
}

/// Reason for which `name` cannot be declared, if there is one.
pub fn reserved(name: &str) -> Option<&'static str> {
    if RUST.contains(&name) || name.starts_with("r#") || name == "_" {
        Some("a keyword of Rust")
    } else if RESERVED.contains(&name) || FUNCTIONS.contains(&name) {
        Some("reserved")
    } else {
        None
    }
}

/// Advice on a declaration of another language.
pub fn foreign_section(word: &str) -> Option<&'static str> {
    FOREIGN_SECTIONS
        .iter()
        .find(|(foreign, _)| *foreign == word)
        .map(|(_, instead)| *instead)
}

/// Advice on a function of another language.
pub fn foreign_function(name: &str) -> Option<&'static str> {
    FOREIGN_FUNCTIONS
        .iter()
        .find(|(foreign, _)| *foreign == name)
        .map(|(_, instead)| *instead)
}

/// True if `name` is a function that is not differentiable everywhere.
pub fn is_not_differentiable(name: &str) -> bool {
    NOT_DIFFERENTIABLE.contains(&name)
}

/// The help for everything that is not differentiable.
pub const PIECEWISE: &str = "motion is divided into pieces by the surfaces in `impacts`";
