//! Parsers of flags whose values are names of an enumeration of the driver.

use clap::builder::{PossibleValue, PossibleValuesParser, TypedValueParser, ValueParser};
use dalembert_driver::course::IntegratorChoice;
use dalembert_driver::{Form, Integrator, OffConstraint};

/// The integrators.
pub fn integrator() -> ValueParser {
    let every = Integrator::every().iter();
    one_of(every.map(|&integrator| (integrator, integrator.name(), help(integrator))))
}

/// The integrators, and the automatic choice.
pub fn integrator_or_auto() -> ValueParser {
    one_of(IntegratorChoice::every().map(|choice| {
        let help = match choice {
            IntegratorChoice::Automatic => {
                "taylor or dop853, whichever takes less work, by counted operations of the model at this tolerance"
            }
            IntegratorChoice::Given(integrator) => help(integrator),
        };
        (choice, choice.name(), help)
    }))
}

fn help(integrator: Integrator) -> &'static str {
    match integrator {
        Integrator::Dop853 => "Dormand and Prince of order 8(5,3), dense output of order 7",
        Integrator::Dopri5 => "Dormand and Prince of order 5(4), dense output of order 4",
        Integrator::Taylor => "Taylor series of an order chosen for the tolerance and the model",
        Integrator::Rk4 => "Fixed step: the classical Runge-Kutta method of order 4",
        Integrator::Gauss4 => {
            "Fixed step: Gauss collocation of order 4, symplectic without constraints"
        }
        Integrator::Gauss6 => {
            "Fixed step: Gauss collocation of order 6, symplectic without constraints"
        }
        Integrator::Dla2 => {
            "Fixed step: discrete Lagrange-d'Alembert principle of order 2; constraints hold to rounding"
        }
        Integrator::Dla4 => "Fixed step: dla2 composed to order 4",
    }
}

/// The forms of the equations.
pub fn form() -> ValueParser {
    one_of(Form::every().iter().map(|&form| {
        let help = match form {
            Form::Reduced => "Positions and independent quasi-velocities: (q, u) on D",
            Form::Global => "Positions and momenta, also off the constraints: (q, p) on T*Q",
        };
        (form, form.name(), help)
    }))
}

/// The policies for positions or velocities off the constraints.
pub fn off_constraint() -> ValueParser {
    one_of(OffConstraint::every().iter().map(|&policy| {
        let help = match policy {
            OffConstraint::Error => {
                "Refuse them if the residual exceeds 1e-9 of the sum of the absolute values of the terms"
            }
            OffConstraint::Project => {
                "Replace the positions by nearby ones that satisfy the constraints, and the velocity by the nearest allowed one in the metric"
            }
            OffConstraint::Keep => "Start there; the residual persists during the motion",
        };
        (policy, policy.name(), help)
    }))
}

/// A parser of values, each with a name and a help text.
fn one_of<T: Copy + Send + Sync + 'static>(
    choices: impl IntoIterator<Item = (T, &'static str, &'static str)>,
) -> ValueParser {
    let choices: Vec<_> = choices.into_iter().collect();
    let named = choices
        .iter()
        .map(|&(_, name, help)| PossibleValue::new(name).help(help));
    let parser = PossibleValuesParser::new(named);
    ValueParser::new(parser.map(move |given| {
        let chosen = choices.iter().find(|(_, name, _)| *name == given);
        chosen.expect("a name that was accepted").0
    }))
}
