//! `check`: the declarations of a model, the verdicts on its claims, and tests of its defaults and its initial state.

mod bendixson;
mod certificate;

use std::io::{self, Write};

use dalembert::describe::{Description, Report, Topology};
use dalembert::{Outcome, Policies};
use dalembert_codegen::claims::{Finding, Verdict};
use dalembert_codegen::report::{self, Item, Section};
use dalembert_driver::{
    AnyModel, Contact, Form, Impact, Integrator, Origin, Piece, Settings, Watch, outcome, words,
};
use serde_json::{Value, json};

use crate::Streams;
use crate::args::{CheckArgs, Format};
use crate::entry::Entry;
use crate::error::{CliError, refusal_text};
use crate::exit::Exit;
use crate::json::{Document, number};
use crate::names;
use crate::sink::{self, Sink};
use crate::state_input::{declared_state, find_model};

/// A test of the model: its name, and the defect that it found.
struct Check {
    subject: &'static str,
    failure: Option<String>,
}

/// Everything that was examined.
struct Examined {
    checks: Vec<Check>,
    /// Findings, each with the scene of its claim.
    claims: Vec<(&'static str, Finding)>,
    notes: Vec<String>,
}

/// Carries out `check`.
///
/// # Errors
/// An unknown model, or an output that fails.
pub fn run(
    models: &[Entry],
    args: &CheckArgs,
    streams: &mut Streams<'_>,
) -> Result<Exit, CliError> {
    let certificate = Sink::open_given("--certificate", args.certificate.as_deref())?;
    let json = Sink::open_given("--json", args.json.as_deref())?;
    let model = find_model(models, &args.model)?.with_defaults(0);
    if args.bendixson {
        return bendixson::run(model, args, json, streams);
    }
    let model = model.as_ref();
    let mut checks = checks(model);
    // A system written by hand has no declaration and no claims.
    let source = Some(&*model.description().source).filter(|source| !source.is_empty());
    let derived = source.map(report::report).transpose();
    if source.is_some() {
        checks.push(Check {
            subject: "the text of the declaration gives equations and verdicts on its claims",
            failure: derived.as_ref().err().map(ToString::to_string),
        });
    }
    let derived = derived.ok().flatten();
    if let Some(sink) = certificate {
        sink.write(streams, |output| {
            certificate::write(output, derived.as_ref())
        })?;
    }
    let examined = Examined {
        checks,
        notes: notes(model, derived.as_ref()),
        claims: derived
            .map(|derived| findings(model, derived))
            .unwrap_or_default(),
    };
    let document = |output: &mut dyn Write| write_json(output, model, &examined);
    if !sink::write_document(json, streams, document)? {
        match args.format {
            Format::Text => write_text(streams.output, model, &examined)?,
            Format::Json => document(streams.output)?,
        }
    }
    let passed = examined.checks.iter().all(|check| check.failure.is_none());
    Ok(if passed { Exit::Reached } else { Exit::Other })
}

/// The verdicts on the claims about the model itself, then those on the claims about its scenes.
fn findings(model: &dyn AnyModel, report: report::Report) -> Vec<(&'static str, Finding)> {
    let of_scenes = report.scenes.into_iter().map(|scene| scene.findings);
    let all = [report.findings].into_iter().chain(of_scenes);
    let named = model.description().scenes.iter().zip(all);
    named
        .flat_map(|(scene, findings)| findings.into_iter().map(|finding| (*scene, finding)))
        .collect()
}

/// Tests the defaults against the assumptions, then the initial state if the defaults are complete.
fn checks(model: &dyn AnyModel) -> Vec<Check> {
    let description = model.description();
    let refused = defaults_against_assumptions(model);
    let mut checks = vec![Check {
        subject: "declared defaults satisfy their assumptions",
        failure: refused,
    }];
    // Parameters without a default leave the initial state undefined.
    if model.check_parameters().is_err() {
        return checks;
    }
    let initial = declared_state(model);
    let failure = match &initial {
        Err(error) => Some(error.to_string()),
        Ok(origin) => defect(model, origin),
    };
    checks.push(Check {
        subject: "the initial state is admissible",
        failure,
    });
    if let Ok(state) = initial.and_then(|origin| {
        let state = model.state(0.0, &origin);
        state.map_err(|error| CliError::state("the model's `initial`", description, error))
    }) {
        let inspected = model.inspect(0.0, &state, &mut Silent);
        let failure = inspected
            .err()
            .map(|fault| words::fault_text(description, &fault));
        checks.push(Check {
            subject: "the equations of motion exist at the initial state",
            failure,
        });
    }
    checks
}

/// The defect of this state for a run: a run from it is refused, a surface has a negative gap, or a component or a gap has no
/// value. The first step of a run reports all of them.
fn defect(model: &dyn AnyModel, origin: &Origin) -> Option<String> {
    let settings = Settings {
        form: Form::Global,
        integrator: Integrator::Dop853,
        tol: 1e-9,
        step: None,
        max_step: None,
        steps: Some(1),
        until: 1e-3,
        impacts: None,
        laws: Vec::new(),
        policies: Policies::default(),
        projection: None,
    };
    let description = model.description();
    let ending = match model.simulate(origin, &settings, &mut Silent) {
        Ok(ending) => ending,
        Err(refusal) => return Some(refusal_text(description, &refusal)),
    };
    match ending.outcome {
        Outcome::StartsInside { surface, gap } => {
            let name = names::surfaces(description).nth(surface);
            let name = name.unwrap_or_default();
            Some(format!(
                "it lies behind the surface `{name}`: its gap is {gap}"
            ))
        }
        outcome @ Outcome::NonFinite { .. } if ending.counters.accepted == 0 => {
            outcome::explanation(description, &outcome)
        }
        _ => None,
    }
}

fn defaults_against_assumptions(model: &dyn AnyModel) -> Option<String> {
    let parameters = model.description().parameters.iter();
    let bad: Vec<String> = parameters
        .filter_map(|parameter| {
            let value = parameter
                .default
                .filter(|&value| !parameter.assumption.holds(value))?;
            Some(format!(
                "`{}` is {value}, but must be {}",
                parameter.name, parameter.assumption
            ))
        })
        .collect();
    (!bad.is_empty()).then(|| bad.join("; "))
}

/// Remarks for the user.
fn notes(model: &dyn AnyModel, report: Option<&report::Report>) -> Vec<String> {
    let description = model.description();
    let mut notes = Vec::new();
    for parameter in description
        .parameters
        .iter()
        .filter(|parameter| parameter.default.is_none())
    {
        notes.push(format!(
            "parameter `{0}` has no default: runs need --set {0}=VALUE",
            parameter.name
        ));
    }
    for constraint in &description.constraints {
        if constraint.affine {
            notes.push(format!(
                "constraint `{}` is affine in the velocities",
                constraint.name
            ));
        }
        if constraint.level.is_some() {
            let arguments = match constraint.affine {
                true => "of position and time",
                false => "of the position",
            };
            notes.push(format!(
                "constraint `{}` is integrable: it keeps a function {arguments} constant",
                constraint.name
            ));
        }
    }
    if model.initial().until.is_none() {
        notes.push("no `until` is declared: runs need --until T or --impacts N".to_owned());
    }
    notes.extend(report.map(remarks).unwrap_or_default());
    notes
}

/// Remarks of the generator on the declaration: velocity-linear terms, integrable constraints, unused parameters.
fn remarks(report: &report::Report) -> Vec<String> {
    let sections = report.sections.iter();
    let remarks = sections.filter(|section| section.title == Section::NOTES);
    remarks
        .flat_map(|section| &section.items)
        .filter_map(|item| match item {
            Item::Words(words) => Some(words.clone()),
            _ => None,
        })
        .collect()
}

fn write_text(
    output: &mut dyn Write,
    model: &dyn AnyModel,
    examined: &Examined,
) -> Result<(), CliError> {
    let description = model.description();
    writeln!(
        output,
        "{}: {}",
        description.name,
        or_none(names::summary(description))
    )?;
    for (title, entries) in declarations(description) {
        writeln!(output, "  {title:12} {}", or_none(&entries.join(", ")))?;
    }
    writeln!(output, "parameters")?;
    for parameter in &description.parameters {
        let default = parameter
            .default
            .map_or("no default".to_owned(), |value| format!("= {value}"));
        writeln!(
            output,
            "  {} {default}, {}",
            parameter.name, parameter.assumption
        )?;
    }
    writeln!(output, "checks")?;
    for Check { subject, failure } in &examined.checks {
        match failure {
            None => writeln!(output, "  ok    {subject}")?,
            Some(failure) => writeln!(output, "  FAIL  {subject}: {failure}")?,
        }
    }
    writeln!(output, "claims")?;
    for (scene, claim) in &examined.claims {
        write_claim(output, scene, claim)?;
    }
    if examined.claims.is_empty() {
        writeln!(output, "  none")?;
    }
    writeln!(output, "notes")?;
    for note in &examined.notes {
        writeln!(output, "  {note}")?;
    }
    if examined.notes.is_empty() {
        writeln!(output, "  none")?;
    }
    Ok(())
}

/// Writes the verdict and the claim as written, and below them its grounds and remarks.
fn write_claim(output: &mut dyn Write, scene: &str, finding: &Finding) -> Result<(), CliError> {
    let about = match scene {
        "all" => String::new(),
        _ => format!(" (scene {scene})"),
    };
    writeln!(output, "  {:9} {}{about}", finding.word(), finding.claim)?;
    let grounds = finding.grounds();
    let lines = grounds
        .lines()
        .chain(finding.remarks.iter().map(String::as_str));
    for line in lines {
        writeln!(output, "            {line}")?;
    }
    Ok(())
}

/// The declarations except parameters: titles, each with its entries.
fn declarations(description: &Description) -> [(&'static str, Vec<String>); 6] {
    let owned = |names: &[&str]| names.iter().map(|&name| name.to_owned()).collect();
    let coordinates = description.coordinates.iter();
    let surfaces = description.surfaces.iter();
    [
        (
            "coordinates",
            coordinates
                .map(|it| format!("{}{}", it.name, topology(it.topology)))
                .collect(),
        ),
        (
            "constraints",
            description
                .constraints
                .iter()
                .map(|it| it.name.to_owned())
                .collect(),
        ),
        ("forces", owned(&description.forces)),
        (
            "surfaces",
            surfaces
                .map(|it| format!("{} ({})", it.name, it.law))
                .collect(),
        ),
        ("outputs", owned(&description.outputs)),
        ("scenes", owned(&description.scenes)),
    ]
}

fn topology(topology: Topology) -> String {
    match topology {
        Topology::Line => String::new(),
        Topology::Circle => " (angle)".to_owned(),
        Topology::Interval { low, high } => format!(" in ({low}, {high})"),
    }
}

fn or_none(text: &str) -> &str {
    if text.is_empty() { "none" } else { text }
}

fn write_json(output: &mut dyn Write, model: &dyn AnyModel, examined: &Examined) -> io::Result<()> {
    let description = model.description();
    let mut document = Document::begin(output)?;
    document.field("model", description.name)?;
    document.field("documentation", &*description.documentation)?;
    document.rows(
        "coordinates",
        description
            .coordinates
            .iter()
            .map(|it| json!({ "name": it.name, "topology": topology_json(it.topology) })),
    )?;
    document.rows("parameters", description.parameters.iter().map(|it| {
        let holds = it.default.map(|value| it.assumption.holds(value));
        json!({ "name": it.name, "default": it.default, "assumption": it.assumption.to_string(), "holds": holds })
    }))?;
    document.rows(
        "constraints",
        description.constraints.iter().map(
            |it| json!({ "name": it.name, "affine": it.affine, "integrable": it.level.is_some() }),
        ),
    )?;
    document.field("forces", description.forces.to_vec())?;
    document.rows(
        "surfaces",
        description
            .surfaces
            .iter()
            .map(|it| json!({ "name": it.name, "law": *it.law })),
    )?;
    document.field("outputs", description.outputs.to_vec())?;
    document.field("scenes", description.scenes.to_vec())?;
    document.rows("checks", examined.checks.iter().map(|check| {
        json!({ "check": check.subject, "passed": check.failure.is_none(), "failure": check.failure })
    }))?;
    document.rows(
        "claims",
        examined
            .claims
            .iter()
            .map(|(scene, claim)| claim_json(scene, claim)),
    )?;
    document.field("notes", examined.notes.clone())?;
    document.end()
}

fn claim_json(scene: &str, finding: &Finding) -> Value {
    let mut claim = json!({
        "scene": scene,
        "claim": finding.claim,
        "verdict": finding.word(),
        "grounds": finding.grounds(),
        "remarks": finding.remarks,
    });
    match &finding.verdict {
        Verdict::Proved(certificate) => {
            claim["certificate"] = json!({
                "shown": certificate.shown,
                "points": certificate.points,
                "primes": certificate.primes,
                "seed": certificate.seed,
                "error_bound": number(certificate.error),
            });
        }
        Verdict::Refuted(witness) => {
            let named = |pairs: &[(String, f64)]| -> Value {
                pairs
                    .iter()
                    .map(|(name, value)| (name.clone(), number(*value)))
                    .collect()
            };
            let at = witness.sample.as_ref().map(|sample| named(&sample.values));
            claim["witness"] =
                json!({ "reason": witness.reason, "at": at, "values": named(&witness.values) });
        }
        Verdict::Undecided(_) => {}
    }
    claim
}

fn topology_json(topology: Topology) -> Value {
    match topology {
        Topology::Line => json!("line"),
        Topology::Circle => json!("circle"),
        Topology::Interval { low, high } => json!([number(low), number(high)]),
    }
}

/// A receiver that discards everything it is given: only success or failure of a run or an inspection counts.
struct Silent;

impl Watch for Silent {
    fn step(&mut self, _piece: &dyn Piece) {}
    fn hears(&mut self, _impact: &Impact<()>) -> bool {
        false
    }

    fn impact(&mut self, _impact: Impact) {}
    fn contact(&mut self, _contact: Contact) {}
}

impl Report for Silent {
    fn scalar(&mut self, _name: &str, _value: f64) {}
    fn vector(&mut self, _name: &str, _values: &[f64]) {}
    fn matrix(&mut self, _name: &str, _rows: usize, _columns: usize, _values: &[f64]) {}
}
