//! Converts the common flags of `simulate`, `ensemble`, `map` and `accuracy` to the settings of a run.

use dalembert::describe::Description;
use dalembert::law::Law;
use dalembert_driver::course::{self as choice, FormError, IntegratorChoice};
use dalembert_driver::{AnyModel, Form, OffConstraint, Settings};

use std::path::{Path, PathBuf};

use crate::args::{CourseArgs, RunArgs, Switch};
use crate::error::CliError;
use crate::sink::is_stdout;
use crate::{names, scalar};

/// Refuses a picture path that does not end in `.svg`.
pub fn check_plot(path: Option<&Path>) -> Result<(), CliError> {
    if let Some(path) = path
        && path
            .extension()
            .is_none_or(|extension| !extension.eq_ignore_ascii_case("svg"))
    {
        return Err(CliError::value(
            "--plot",
            path.display().to_string(),
            "a file name that ends in .svg",
        ));
    }
    Ok(())
}

/// Refuses outputs with the same path. The last path is that of `--plot`, which must end in `.svg`.
pub fn check_outputs<const N: usize>(paths: [&Option<PathBuf>; N]) -> Result<(), CliError> {
    check_plot(paths.last().and_then(|path| path.as_deref()))?;
    let mut given: Vec<&PathBuf> = paths.into_iter().flatten().collect();
    given.sort_unstable();
    match given.windows(2).any(|pair| pair[0] == pair[1]) {
        true => Err(CliError::Usage(
            "--csv, --json, --html and --plot need different files (`-` can be used once)",
        )),
        false => Ok(()),
    }
}

/// True if one of these outputs goes to the standard output, which then must have no other content.
pub fn uses_stdout<const N: usize>(paths: [&Option<PathBuf>; N]) -> bool {
    paths.into_iter().flatten().any(|path| is_stdout(path))
}

/// The settings of a run, with the integrator, the step limits and the end that the flags request.
pub fn course(
    model: &dyn AnyModel,
    run: &RunArgs,
    course: &CourseArgs,
) -> Result<Settings, CliError> {
    course_to(model, run, course, course.impacts)
}

/// Like [`course`]. With `counted`, the run ends after this number of impacts or of returns to a surface, and needs no
/// end time.
pub fn course_to(
    model: &dyn AnyModel,
    run: &RunArgs,
    course: &CourseArgs,
    counted: Option<u64>,
) -> Result<Settings, CliError> {
    if course.step.is_some() && course.integrator.is_adaptive() {
        return Err(CliError::Usage(
            "--step: dop853, dopri5 and taylor choose their steps by --tol; a step needs --integrator rk4, gauss4, gauss6, dla2 \
             or dla4",
        ));
    }
    if course.max_step.is_some() && !course.integrator.is_adaptive() {
        return Err(CliError::Usage(
            "--max-step: rk4, gauss4, gauss6, dla2 and dla4 keep one step, which --step sets; a largest step needs --integrator \
             dop853, dopri5 or taylor",
        ));
    }
    let integrator = (course.integrator, course.tol);
    let settings = settings(model, run, counted, integrator)?;
    if counted.is_none() {
        check_resolution("--step", course.step, settings.until)?;
        check_resolution("--max-step", course.max_step, settings.until)?;
    }
    Ok(Settings {
        step: course.step,
        max_step: course.max_step,
        steps: course.steps,
        impacts: course.impacts,
        ..settings
    })
}

/// Refuses a step that is shorter than the distance of neighbouring times at the end of the run, which it would never reach.
fn check_resolution(flag: &str, step: Option<f64>, until: f64) -> Result<(), CliError> {
    let least = f64::EPSILON * until;
    match step {
        Some(step) if step < least => {
            let expected =
                format!("at least {least:.1e}, the distance of times near the end at t = {until}");
            Err(CliError::value(flag, format!("{step:e}"), expected))
        }
        _ => Ok(()),
    }
}

/// The settings of a run by an integrator at this tolerance, to the requested time or number of impacts.
pub fn settings(
    model: &dyn AnyModel,
    args: &RunArgs,
    impacts: Option<u64>,
    (integrator, tol): (IntegratorChoice, f64),
) -> Result<Settings, CliError> {
    if impacts.is_some() && model.description().surfaces.is_empty() {
        return Err(CliError::Usage(
            "--impacts: the model has no impact surfaces",
        ));
    }
    let form = form(model.description(), args)?;
    let integrator = integrator.settle(model, form, tol);
    Ok(Settings {
        form,
        integrator: integrator.map_err(|error| CliError::refused(model, &error.into()))?,
        tol,
        step: None,
        max_step: None,
        steps: None,
        until: horizon(model, args.until, impacts)?,
        impacts,
        laws: laws(model, &args.law)?,
        policies: args.policies.policies(),
        projection: args
            .state
            .off_constraint
            .projection(args.projection.map(|switch| switch == Switch::On)),
    })
}

/// The requested form of the equations. The default is the reduced form if the model and the flags allow it.
fn form(description: &Description, args: &RunArgs) -> Result<Form, CliError> {
    let needs_global =
        args.state.off_constraint == OffConstraint::Keep || args.projection.is_some();
    Form::choose(description, args.form, needs_global).map_err(|error| match error {
        FormError::Unreduced { model } => CliError::Unreduced {
            model,
            is_free: description.constraints.is_empty(),
        },
        FormError::OnConstraints => CliError::Usage(
            "--form reduced has no states off the constraints: leave out --off-constraint keep and --projection",
        ),
    })
}

fn horizon(
    model: &dyn AnyModel,
    until: Option<f64>,
    impacts: Option<u64>,
) -> Result<f64, CliError> {
    choice::horizon(model, until, impacts).ok_or(CliError::Usage(
        "the model declares no usable `until`; give an end with --until T or --impacts N",
    ))
}

/// The laws of `--law`, in order. A later law for a surface replaces an earlier one.
pub(crate) fn laws(model: &dyn AnyModel, flags: &[String]) -> Result<Vec<(usize, Law)>, CliError> {
    let description = model.description();
    let mut laws = Vec::new();
    for flag in flags {
        let (surface, law) = match flag.split_once('=') {
            Some((surface, law)) => (Some(surface.trim()), law.trim()),
            None => (None, flag.trim()),
        };
        if let Some((name, rest)) = law.split_once(':')
            && names::surfaces(description).any(|known| known == name)
        {
            let expected = format!("SURFACE=LAW, such as `{name}={rest}`");
            return Err(CliError::value("--law", law, expected));
        }
        let law = parse_law(law)?;
        let surface = surface
            .map(|name| names::find("--law", "surface", name, names::surfaces(description)))
            .transpose()?;
        choice::add_law(&mut laws, model, surface, law).map_err(CliError::Law)?;
    }
    Ok(laws)
}

/// Parses `LAW[:E]`.
fn parse_law(text: &str) -> Result<Law, CliError> {
    let (name, coefficient) = match text.split_once(':') {
        Some((name, coefficient)) => (name.trim(), Some(coefficient.trim())),
        None => (text, None),
    };
    let index = names::find(
        "--law",
        "law",
        name,
        Law::NAMES.iter().map(|(name, _)| *name),
    )?;
    let e = match (Law::NAMES[index].1, coefficient) {
        (true, Some(e)) => scalar::coefficient(e).map_err(|_| {
            CliError::value(
                "--law",
                text,
                format!("{name}:E with E a number from 0 to 1"),
            )
        })?,
        (true, None) => {
            return Err(CliError::value(
                "--law",
                text,
                format!("{name}:E with E a number from 0 to 1"),
            ));
        }
        (false, Some(_)) => {
            return Err(CliError::value(
                "--law",
                text,
                format!("{name} without a coefficient"),
            ));
        }
        (false, None) => 0.0,
    };
    // The name is one of `Law::NAMES`, so this is never `None`.
    Law::from_name(name, e).ok_or_else(|| CliError::value("--law", text, "an impact law"))
}
