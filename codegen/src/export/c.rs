//! A C99 header. Its functions do not allocate, and call only functions of `math.h`.

use std::fmt::{self, Write as _};

use super::{Fault, Line, Operand, Part, Routine, Takes};

/// The header for these models.
pub fn header(parts: &[Part]) -> String {
    let mut text = String::new();
    // Writing to a `String` does not fail.
    let _ = write(&mut text, parts);
    text
}

fn write(text: &mut String, parts: &[Part]) -> fmt::Result {
    text.push_str(PREAMBLE);
    for part in parts {
        write_part(text, part)?;
    }
    Ok(())
}

const PREAMBLE: &str = "\
/* Written by dalembert. Every function returns 0, or a number that says why its results do not exist:
   1 the metric is not positive definite, 2 the constraints are dependent, 3 the quasi-velocities are
   dependent, 4 a surface is singular or tangent to the constraints. `out` receives the results; it may be `s`.
   Arguments: the time `t`, the state `s` or positions `q` and velocities `v`, the parameters `k`. */
#include <math.h>
";

fn write_part(text: &mut String, part: &Part) -> fmt::Result {
    let Part {
        name,
        documentation,
        coordinates,
        motion,
        parameters,
        routines,
    } = part;
    let (n, size) = (coordinates.len(), coordinates.len() + motion.len());
    writeln!(text, "\n#ifndef {name}_STATE")?;
    for line in documentation.lines() {
        writeln!(text, "/* {} */", line.replace("*/", "* /"))?;
    }
    let state = [coordinates.as_slice(), motion].concat().join(", ");
    writeln!(text, "/* State: {state}. */")?;
    writeln!(text, "#define {name}_COORDINATES {n}")?;
    writeln!(text, "#define {name}_STATE {size}")?;
    writeln!(text, "#define {name}_PARAMETERS {}", parameters.len())?;
    let names: Vec<&str> = parameters.iter().map(|(name, _)| name.as_str()).collect();
    if !names.is_empty() {
        let defaults = parameters
            .iter()
            .map(|(_, value)| Number(value.unwrap_or(f64::NAN)).to_string());
        let defaults: Vec<String> = defaults.collect();
        writeln!(
            text,
            "/* {}; inputs default to 0, parameters without a default to NAN. */",
            names.join(", ")
        )?;
        let list = defaults.join(", ");
        writeln!(
            text,
            "static const double {name}_defaults[{}] = {{{list}}};",
            names.len()
        )?;
    }
    for routine in routines {
        write_routine(text, part, routine)?;
    }
    writeln!(text, "#endif")
}

fn write_routine(text: &mut String, part: &Part, routine: &Routine) -> fmt::Result {
    let Routine {
        name,
        about,
        takes,
        lines,
    } = routine;
    let model = &part.name;
    writeln!(text, "\n/* out[{}]: {about}. */", lines.outputs.len())?;
    let place = match takes {
        Takes::State => "const double *s",
        Takes::Velocities => "const double *q, const double *v",
    };
    writeln!(
        text,
        "static inline int {model}_{name}(double t, {place}, const double *k, double *out)"
    )?;
    writeln!(text, "{{")?;
    let places = match takes {
        Takes::State => "(void)s",
        Takes::Velocities => "(void)q; (void)v",
    };
    writeln!(text, "    (void)t; {places}; (void)k; (void)out;")?;
    if *takes == Takes::State && lines.reads_velocity() {
        writeln!(text, "    double v[{}];", part.coordinates.len())?;
        writeln!(text, "    const int fault = {model}_velocity(t, s, k, v);")?;
        writeln!(text, "    if (fault) return fault;")?;
    }
    let named = |operand: &Operand| Named(*operand, *takes).to_string();
    for line in &lines.lines {
        writeln!(text, "    {}", statement(line, &named))?;
    }
    // All results are computed before any is written, because `out` may be the state.
    let results = lines.outputs.iter().enumerate();
    for (index, output) in results.clone() {
        writeln!(text, "    const double r{index} = {};", named(output))?;
    }
    for (index, _) in results {
        writeln!(text, "    out[{index}] = r{index};")?;
    }
    writeln!(text, "    return 0;\n}}")
}

fn statement(line: &Line, named: &dyn Fn(&Operand) -> String) -> String {
    match line {
        Line::Let {
            value,
            operation,
            operands,
        } => {
            let operands: Vec<String> = operands.iter().map(named).collect();
            let right = match (*operation, operands.as_slice()) {
                ("neg", [a]) => format!("-{a}"),
                ("+" | "-" | "*" | "/", [a, b]) => format!("{a} {operation} {b}"),
                (name, all) => format!("{name}({})", all.join(", ")),
            };
            format!("const double v{value} = {right};")
        }
        Line::Demand {
            value,
            factor,
            reference,
            fault,
        } => {
            let bound = match reference {
                Some(reference) => format!("{}*{}", Number(*factor), named(reference)),
                None => "0.0".into(),
            };
            format!(
                "if (!({} > {bound})) return {};",
                named(value),
                code(*fault)
            )
        }
    }
}

fn code(fault: Fault) -> i32 {
    match fault {
        Fault::Metric => 1,
        Fault::Constraint => 2,
        Fault::Frame => 3,
        Fault::Surface => 4,
    }
}

/// An operand as a C expression that needs no parentheses.
struct Named(Operand, Takes);

impl fmt::Display for Named {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        match (self.0, self.1) {
            (Operand::Value(value), _) => write!(f, "v{value}"),
            (Operand::Number(number), _) => Number(number).fmt(f),
            (Operand::Time, _) => f.write_str("t"),
            (Operand::State(i), Takes::State) => write!(f, "s[{i}]"),
            (Operand::State(i), Takes::Velocities) => write!(f, "q[{i}]"),
            (Operand::Velocity(i), _) => write!(f, "v[{i}]"),
            (Operand::Parameter(k), _) => write!(f, "k[{k}]"),
        }
    }
}

/// A number with enough digits to be read back exactly.
struct Number(f64);

impl fmt::Display for Number {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        match self.0 {
            number if number.is_nan() => f.write_str("NAN"),
            number if number.is_infinite() && number > 0.0 => f.write_str("INFINITY"),
            number if number.is_infinite() => f.write_str("(-INFINITY)"),
            number if number.is_sign_negative() => write!(f, "({number:?})"),
            number => write!(f, "{number:?}"),
        }
    }
}
