//! `simulate --certify`: enclosures of impacts and of the state at the end, as text or as a document.

mod document;
mod report;
mod within;

use dalembert_driver::{
    AnyModel, Beginning, Certification, Certified, OffConstraint, Refusal, Strike,
};

use self::within::Within;
use crate::args::SimulateArgs;
use crate::entry::Entry;
use crate::error::CliError;
use crate::exit::Exit;
use crate::sink::Sink;
use crate::state_input::{build_run, initial_state_with};
use crate::{Streams, run_request};

/// Finished certification: its request and its results.
struct Enclosed<'a> {
    model: &'a dyn AnyModel,
    scene: &'a str,
    request: &'a Certification,
    /// Given ranges, each with the name of its quantity.
    within: Vec<(String, [f64; 2])>,
    strikes: Vec<Strike>,
    certified: Certified,
}

/// Carries out `simulate --certify`.
///
/// # Errors
/// Invalid flags, a state that is refused, a model whose motion cannot be certified. Motion whose certification is lost
/// is not an error but an [`Exit`].
pub(super) fn run(
    models: &[Entry],
    args: &SimulateArgs,
    streams: &mut Streams<'_>,
) -> Result<Exit, CliError> {
    let mut model = build_run(models, &args.run)?;
    let settings = run_request::course(model.as_ref(), &args.run, &args.course)?;
    let is_projected = args.run.state.off_constraint == OffConstraint::Project;
    if is_projected && !args.certify.certify_within.is_empty() {
        return Err(CliError::Usage(
            "--certify-within: ranges of starts are not projected; leave out --off-constraint project",
        ));
    }
    let within = Within::parse(model.as_mut(), settings.form, &args.certify)?;
    let mut named = Vec::new();
    let origin = initial_state_with(model.as_ref(), &args.run.state, |beginning| {
        within.begin(settings.form, beginning)?;
        if let Beginning::Named(start) = beginning {
            named.clone_from(&start.named);
        }
        Ok(())
    })?;
    let json = Sink::open_given("--json", args.json.as_deref())?;
    let request = Certification {
        form: settings.form,
        until: settings.until,
        impacts: settings.impacts,
        laws: settings.laws,
        parameters: within.parameters,
        positions: within.positions,
        rates: within.rates,
        named,
    };
    let mut strikes = Vec::new();
    let certified = model.certify(&origin, &request, &mut |strike| {
        strikes.push(strike.clone())
    });
    let certified = certified.map_err(|refusal| match refusal {
        Refusal::Uncertified(why) => CliError::Uncertified(why),
        other => CliError::refused(model.as_ref(), &other),
    })?;
    let enclosed = Enclosed {
        model: model.as_ref(),
        scene: &args.run.model.scene,
        request: &request,
        within: within.named,
        strikes,
        certified,
    };
    if let Some(sink) = json {
        sink.write(streams, |output| document::write(output, &enclosed))?;
    }
    if !run_request::uses_stdout([&args.json, &None]) {
        report::write(streams.output, &enclosed)?;
    }
    Ok(match enclosed.certified.lost {
        None => Exit::Reached,
        Some(_) => Exit::Other,
    })
}
