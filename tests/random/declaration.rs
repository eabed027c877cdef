//! Random declarations with random metrics, potentials, constraints, forces and surfaces.
//!
//! They satisfy the rules of the language by construction. The metric is a positive diagonal plus squares. The
//! constraint with index `a` begins with `d(x_a)` and continues in later coordinates, so that the forms are
//! independent. A gap is a coordinate plus a function of the others, so that it changes its sign with a nonzero
//! gradient.

use std::fmt;

use proptest::prelude::*;

use super::function::{Function, Names, PARAMETERS};

/// A declaration as data.
#[derive(Clone)]
pub struct Declaration {
    /// True for coordinates that are angles. The last coordinate is on a line.
    angles: Vec<bool>,
    /// Shift between the order of declaration and the indices of coordinates.
    turned: usize,
    inertias: Vec<Inertia>,
    /// One-forms whose squares are added to the kinetic energy.
    couplings: Vec<Vec<Function>>,
    /// Terms of the Lagrangian linear in the velocities.
    linear: Option<Vec<Function>>,
    potential: Function,
    constraints: Vec<Constraint>,
    forces: Vec<Force>,
    surfaces: Vec<Surface>,
}

#[derive(Debug, Clone, Copy)]
enum Inertia {
    Constant(u8),
    Parameter,
    Growing,
    Waving,
}

#[derive(Debug, Clone)]
struct Constraint {
    notation: Notation,
    rest: Vec<Function>,
    affine: Option<Function>,
}

#[derive(Debug, Clone, Copy)]
enum Notation {
    Differentials,
    Velocities,
    /// The form is multiplied by a function.
    Scaled,
    /// The form is the differential of a function.
    Exact,
}

#[derive(Debug, Clone)]
struct Force {
    along: usize,
    driven_by: usize,
    is_quadratic: bool,
    drive: Function,
}

#[derive(Debug, Clone)]
struct Surface {
    is_upper: bool,
    rest: Function,
    condition: Option<Function>,
    law: usize,
}

const LAWS: [&str; 7] = [
    "",
    " => elastic",
    " => restitution(c)",
    " => newton(1/2)",
    " => nonholonomic_plastic",
    " => impact_plastic",
    " => totally_plastic",
];

impl Declaration {
    /// A random declaration with up to `most` coordinates.
    pub fn any(most: usize) -> impl Strategy<Value = Self> {
        (1..=most)
            .prop_flat_map(|n| (Just(n), 0..n))
            .prop_flat_map(|(n, m)| Self::of_size(n, m))
    }

    fn of_size(n: usize, m: usize) -> impl Strategy<Value = Self> {
        let form = || prop::collection::vec(Function::any(), n);
        let shape = (prop::collection::vec(any::<bool>(), n), 0..n);
        let kinetic = (
            prop::collection::vec(Inertia::any(), n),
            prop::collection::vec(form(), 0..=2),
            prop::option::weighted(0.3, form()),
        );
        let effects = (
            prop::collection::vec(Constraint::any(n), m),
            prop::collection::vec(Force::any(n), 0..=2),
            prop::collection::vec(Surface::any(), 0..=2),
        );
        (shape, kinetic, Function::any(), effects).prop_map(
            |((mut angles, turned), (inertias, couplings, linear), potential, effects)| {
                if let Some(last) = angles.last_mut() {
                    *last = false;
                }
                let (constraints, forces, surfaces) = effects;
                Self {
                    angles,
                    turned,
                    inertias,
                    couplings,
                    linear,
                    potential,
                    constraints,
                    forces,
                    surfaces,
                }
            },
        )
    }

    /// Number of coordinates.
    pub fn dimension(&self) -> usize {
        self.angles.len()
    }

    /// The text of the declaration with this name.
    pub fn named(&self, name: &str) -> String {
        let sections = [
            self.coordinates(),
            format!("parameters {{ {PARAMETERS} }}"),
            format!("lagrangian = {};", self.lagrangian()),
            section("constraints", &self.constraints, |a, constraint| {
                self.constraint(a, constraint)
            }),
            section("forces", &self.forces, |k, force| self.force(k, force)),
            section("impacts", &self.surfaces, |s, surface| {
                self.surface(s, surface)
            }),
        ];
        let written = sections.iter().filter(|section| !section.is_empty());
        let lines = written.map(|section| format!("\n    {section}"));
        format!("pub {name} {{{}\n}}", lines.collect::<String>())
    }

    fn coordinates(&self) -> String {
        let n = self.dimension();
        let entries = (0..n).map(|k| {
            let i = (k + self.turned) % n;
            let topology = if self.angles[i] { ": angle" } else { "" };
            format!("x{i}{topology}; ")
        });
        format!("coordinates {{ {}}}", entries.collect::<String>())
    }

    fn lagrangian(&self) -> String {
        let inertias = self.inertias.iter().enumerate();
        let mut terms: Vec<String> = inertias
            .map(|(i, inertia)| format!("{}/2*dot(x{i})^2", inertia.written(self.all(), i)))
            .collect();
        for form in &self.couplings {
            terms.push(format!("({})^2/2", self.form(form, 0, "dot")));
        }
        terms.extend(self.linear.as_ref().map(|form| self.form(form, 0, "dot")));
        format!(
            "{} - ({})",
            terms.join(" + "),
            self.potential.written(self.all())
        )
    }

    /// `f*d(x_first) + ..`
    fn form(&self, components: &[Function], first: usize, rate: &str) -> String {
        let terms = components.iter().enumerate().skip(first);
        let terms =
            terms.map(|(i, component)| format!("({})*{rate}(x{i})", component.written(self.all())));
        let terms: Vec<String> = terms.collect();
        terms.join(" + ")
    }

    fn constraint(&self, a: usize, constraint: &Constraint) -> String {
        let later = self.form(&constraint.rest, a + 1, constraint.notation.rate());
        let affine = constraint
            .affine
            .as_ref()
            .map(|affine| affine.written(self.all()));
        match constraint.notation {
            Notation::Velocities => {
                format!("dot(x{a}) = {later} + {}", affine.unwrap_or("0".into()))
            }
            Notation::Differentials => {
                format!(
                    "d(x{a}) + {later} + ({})*d(t) = 0",
                    affine.unwrap_or("0".into())
                )
            }
            Notation::Scaled => format!("(2 + cos(x{a}))*(d(x{a}) + {later}) = 0"),
            Notation::Exact => {
                let names = Names {
                    first: a + 1,
                    ..self.all()
                };
                format!("d(x{a} + {}) = 0", constraint.rest[0].written(names))
            }
        }
    }

    fn force(&self, _: usize, force: &Force) -> String {
        let (i, j) = (force.along, force.driven_by);
        let drag = match force.is_quadratic {
            true => format!("abs(dot(x{j}))*dot(x{i})"),
            false => format!("dot(x{j})"),
        };
        format!("(-c*{drag} + {})*d(x{i})", force.drive.written(self.all()))
    }

    fn surface(&self, s: usize, surface: &Surface) -> String {
        let last = self.dimension() - 1;
        let names = Names {
            end: last,
            ..self.all()
        };
        let rest = surface.rest.written(names);
        let gap = match surface.is_upper {
            true => format!("x{last} <= {s} + 2 + {rest}"),
            false => format!("x{last} + {rest} >= -{s}"),
        };
        let condition = surface
            .condition
            .as_ref()
            .map(|condition| condition.written(names));
        let condition =
            condition.map_or(String::new(), |text| format!(" when 1 + x{last} > {text}"));
        format!("{gap}{condition}{}", LAWS[surface.law])
    }

    fn all(&self) -> Names<'_> {
        Names {
            angles: &self.angles,
            first: 0,
            end: self.dimension(),
        }
    }
}

impl fmt::Debug for Declaration {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        f.write_str(&self.named("Random"))
    }
}

/// `name { name_0: ..; .. }`, or nothing without entries.
fn section<T>(name: &str, entries: &[T], written: impl Fn(usize, &T) -> String) -> String {
    if entries.is_empty() {
        return String::new();
    }
    let entries = entries.iter().enumerate();
    let entries = entries.map(|(k, entry)| format!("{name}_{k}: {}; ", written(k, entry)));
    format!("{name} {{ {}}}", entries.collect::<String>())
}

impl Inertia {
    fn any() -> impl Strategy<Value = Self> {
        prop_oneof![
            (1_u8..=9).prop_map(Self::Constant),
            Just(Self::Parameter),
            Just(Self::Growing),
            Just(Self::Waving),
        ]
    }

    /// A positive function: of coordinate `i`, of the last coordinate, or a constant.
    fn written(self, names: Names<'_>, i: usize) -> String {
        let last = names.end - 1;
        match self {
            Self::Constant(thirds) => format!("({thirds}/3)"),
            Self::Parameter => "a".to_owned(),
            Self::Growing => format!("(1 + x{last}^2)"),
            Self::Waving => format!("(2 + sin(x{i}))"),
        }
    }
}

impl Constraint {
    fn any(n: usize) -> impl Strategy<Value = Self> {
        let notation = prop_oneof![
            Just(Notation::Differentials),
            Just(Notation::Velocities),
            Just(Notation::Scaled),
            Just(Notation::Exact),
        ];
        let rest = prop::collection::vec(Function::any(), n);
        let affine = prop::option::weighted(0.3, Function::any());
        (notation, rest, affine).prop_map(|(notation, rest, affine)| Self {
            notation,
            rest,
            affine,
        })
    }
}

impl Notation {
    fn rate(self) -> &'static str {
        match self {
            Self::Velocities => "dot",
            Self::Differentials | Self::Scaled | Self::Exact => "d",
        }
    }
}

impl Force {
    fn any(n: usize) -> impl Strategy<Value = Self> {
        (0..n, 0..n, any::<bool>(), Function::any()).prop_map(
            |(along, driven_by, is_quadratic, drive)| Self {
                along,
                driven_by,
                is_quadratic,
                drive,
            },
        )
    }
}

impl Surface {
    fn any() -> impl Strategy<Value = Self> {
        let condition = prop::option::weighted(0.3, Function::any());
        (any::<bool>(), Function::any(), condition, 0..LAWS.len()).prop_map(
            |(is_upper, rest, condition, law)| Self {
                is_upper,
                rest,
                condition,
                law,
            },
        )
    }
}
