//! Random starts of the shipped models.

use std::sync::Arc;

use dalembert::describe::{Description, Topology};
use dalembert::erased::Form;
use dalembert_driver::{AnyModel, Code, OffConstraint, Origin, Rates, of_form};
use dalembert_tests::sampling::Random;

/// A model with parameters and a start.
pub struct Case {
    /// The name of the model, with the number of the start.
    pub name: String,
    /// The model with its parameters and initial mode.
    pub model: Box<dyn AnyModel>,
    /// The start.
    pub origin: Origin,
    /// The end of runs.
    pub until: f64,
}

/// A shipped model.
pub struct Shipped {
    /// The name of the model.
    pub name: &'static str,
    form: Arc<Form>,
}

/// Length of runs, as a multiple of the declared length.
const LONGER: f64 = 3.0;

impl Shipped {
    /// All shipped models with surfaces.
    pub fn with_surfaces() -> impl Iterator<Item = Self> {
        let texts = dalembert_command::TEXTS.iter();
        texts.filter_map(|&(name, text)| {
            let models = dalembert_jit::load(name, text);
            let models = models.unwrap_or_else(|refused| panic!("{refused}"));
            let form = Arc::clone(&models[0].form);
            let has_surfaces = !form.documentation.description.surfaces.is_empty();
            has_surfaces.then_some(Self { name, form })
        })
    }

    /// The declared start.
    pub fn declared(&self) -> Case {
        let model =
            of_form(Arc::clone(&self.form).into(), Code::Loaded).expect("room for its vectors");
        let start = model.initial();
        let q = model.complete_position(&start.q, &start.placed);
        let q = q.expect("positions");
        let qdot = model.complete_velocity(&q, &start.qdot, &start.named);
        let rates = Rates::Velocities(qdot.expect("velocities"));
        Case {
            name: format!("{} as declared", self.name),
            model,
            until: LONGER * start.until.unwrap_or(10.0),
            origin: Origin {
                q,
                rates,
                policy: OffConstraint::Project,
            },
        }
    }

    /// A random start with random parameters. Even numbers give starts near the declared one, odd numbers starts
    /// anywhere in the chart.
    pub fn drawn(&self, number: u64, random: &mut Random) -> Case {
        let mut case = self.declared();
        let description = &self.form.documentation.description;
        case.name = format!("{} {number}", self.name);
        vary_parameters(case.model.as_mut(), description, random);
        let modes = description.modes.len() as f64;
        if modes > 0.0 {
            case.model.set_mode(random.within(0.0, modes) as usize);
        }
        let Rates::Velocities(qdot) = &mut case.origin.rates else {
            return case;
        };
        match number.is_multiple_of(2) {
            true => {
                for q in &mut case.origin.q {
                    *q += 0.1 * random.within(-1.0, 1.0) * q.abs().max(0.1);
                }
                for v in qdot {
                    *v = *v * random.within(0.8, 1.2) + 0.1 * random.within(-1.0, 1.0);
                }
            }
            false => {
                draw_positions(&mut case.origin.q, description, random);
                let speed = 10.0_f64.powf(random.within(-1.0, 1.0));
                qdot.fill_with(|| speed * random.within(-1.0, 1.0));
            }
        }
        case
    }
}

/// Draws every parameter within a fifth of its declared value, as far as the declaration allows it.
fn vary_parameters(model: &mut dyn AnyModel, description: &Description, random: &mut Random) {
    for index in 0..description.parameters.len() {
        let value = model.parameter(index);
        model.set_parameter(index, value * random.within(0.8, 1.2));
        if model.check_parameters().is_err() {
            model.set_parameter(index, value);
        }
    }
}

/// Draws positions in the chart. Coordinates on lines are drawn near their declared values.
fn draw_positions(q: &mut [f64], description: &Description, random: &mut Random) {
    let size = 10.0_f64.powf(random.within(-2.0, 0.5));
    for (q, coordinate) in q.iter_mut().zip(&description.coordinates) {
        *q = match coordinate.topology {
            Topology::Circle => random.within(0.0, core::f64::consts::TAU),
            Topology::Interval { low, high } => {
                low.max(-1e3) + (high - low).min(4.0) * random.within(0.02, 0.98)
            }
            Topology::Line => *q + size * random.within(-1.0, 1.0),
        };
    }
}
