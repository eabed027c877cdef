//! Grammar of the command line. What it accepts is a public interface. Values are checked where they are used, because
//! only there the names of the model are known.

mod certify;
mod choice;
mod ensemble;
mod file;
mod gallery;
mod orbit;

use std::path::PathBuf;

use clap::builder::ValueParser;
use clap::{Args, Parser, Subcommand, ValueEnum};
use dalembert::law::Law;
use dalembert::policy::{Corner, Penetration, Policies, Rest, Split};
use dalembert_driver::{Form, Integrator, OffConstraint};

use crate::scalar;
pub use certify::CertifyArgs;
pub use ensemble::EnsembleArgs;
pub use file::{BuildArgs, NewArgs, WatchArgs};
pub use gallery::GalleryArgs;
pub use orbit::OrbitArgs;

/// Derive, evaluate and simulate mechanical systems declared with `dalembert::model!`.
#[derive(Debug, Parser)]
#[command(
    version,
    arg_required_else_help = true,
    after_help = "Exit status: 0 the requested end was reached, 1 any other outcome, 2 bad flags or input."
)]
pub struct CommandLine {
    /// What to do.
    #[command(subcommand)]
    pub command: Command,
}

/// The commands.
#[derive(Debug, Subcommand)]
pub enum Command {
    /// List the models with their numbers of coordinates (N), constraints (M) and surfaces (S).
    #[command(after_help = LIST_EXAMPLES)]
    List(ListArgs),
    /// Print what is derived from a model: metric, constraints, field, impact maps.
    #[command(after_help = DERIVE_EXAMPLES)]
    Derive(DeriveArgs),
    /// Check what a model declares.
    #[command(after_help = CHECK_EXAMPLES)]
    Check(CheckArgs),
    /// Run a model from a state to an end time or a number of impacts.
    #[command(after_help = [SIMULATE_EXAMPLES, certify::EXAMPLES].concat())]
    Simulate(Box<SimulateArgs>),
    /// Run many members of one scene: initial states and parameters on a grid, at random or from a file.
    #[command(after_help = ensemble::EXAMPLES)]
    Ensemble(Box<EnsembleArgs>),
    /// Measure what accuracy costs: error, work and time of every integrator over tolerances.
    ///
    /// Errors are differences from a reference whose impacts are audited by enclosures, without the search that found them. If
    /// they are not confirmed nothing is measured, and the exit status is 1.
    #[command(after_help = ACCURACY_EXAMPLES)]
    Accuracy(Box<AccuracyArgs>),
    /// Find a periodic orbit by its returns to a surface, and its Floquet multipliers.
    #[command(after_help = orbit::EXAMPLES)]
    Orbit(Box<OrbitArgs>),
    /// Evaluate everything that is derived at given states.
    #[command(after_help = EVAL_EXAMPLES)]
    Eval(EvalArgs),
    /// Write a file with a commented declaration to begin with.
    #[command(after_help = file::NEW_EXAMPLES)]
    New(NewArgs),
    /// Run a model of a file again whenever the file is saved.
    #[command(after_help = file::WATCH_EXAMPLES)]
    Watch(Box<WatchArgs>),
    /// Write a crate that compiles the models of a file.
    #[command(after_help = file::BUILD_EXAMPLES)]
    Build(BuildArgs),
    /// Draw figures of the models, on one page.
    #[command(after_help = gallery::EXAMPLES)]
    Gallery(GalleryArgs),
    /// Run the hard cases, and say which keep their bounds.
    #[command(after_help = STABILITY_EXAMPLES)]
    Stability(StabilityArgs),
}

impl Command {
    /// The argument that names the model of the command, for commands that read one model once.
    pub fn model(&mut self) -> Option<&mut String> {
        match self {
            Self::Derive(args) => Some(&mut args.model),
            Self::Check(args) => Some(&mut args.model),
            _ => self.model_to_run().map(|args| &mut args.model),
        }
    }

    /// The model arguments of the command, if it runs a model.
    fn model_to_run(&mut self) -> Option<&mut ModelArgs> {
        match self {
            Self::Simulate(args) => Some(&mut args.run.model),
            Self::Ensemble(args) => Some(&mut args.run.model),
            Self::Accuracy(args) => Some(&mut args.run.model),
            Self::Orbit(args) => Some(&mut args.model),
            Self::Eval(args) => Some(&mut args.model),
            _ => None,
        }
    }

    /// True if the claims of a model of a file are not examined.
    pub fn skips_claims(&mut self) -> bool {
        self.model_to_run().is_some_and(|args| args.no_claims)
    }
}

const LIST_EXAMPLES: &str = "Examples:
  dalembert list
  dalembert list --format json";

const DERIVE_EXAMPLES: &str = "Examples:
  dalembert derive rolling_disk
  dalembert derive rolling_disk --format latex > rolling_disk.tex";

const CHECK_EXAMPLES: &str = "Examples:
  dalembert check rolling_disk
  dalembert check rolling_disk --format json
  dalembert check rolling_disk --certificate proofs.json && python3 python/check_certificate.py proofs.json";

const SIMULATE_EXAMPLES: &str =
    "Numbers may be multiples of pi: pi/2, -3*pi/4, 2pi. A repeated name takes its last value.

Examples:
  dalembert simulate rolling_disk
  dalembert simulate rolling_disk --until 40 --plot disk.svg
  dalembert simulate rolling_disk --until 40 --plot momenta.svg --axes p_theta,p_phi
  dalembert simulate rolling_disk --set ta=0.3 --initial phi=pi/3,theta_dot=12
  dalembert simulate rolling_disk --impacts 50 --law leading_edge=newton:0.5 --json -
  dalembert simulate double_pendulum --integrator gauss6 --step 0.01 --until 1000
  dalembert simulate chaplygin_sleigh --integrator dla4 --step pi/200
  dalembert simulate rolling_disk --until 40 --max-step 0.05
  dalembert simulate bouncing_ball --q 1 --qdot 0 --until 10 --csv ball.csv
  dalembert simulate bouncing_ball --law newton:0.5 --rest contact --until 10";

const ACCURACY_EXAMPLES: &str = "An error is the largest difference of a position from a reference run at 64 equally spaced times and at the end,
as a share of the largest absolute value of that coordinate (of an angle, at least 1). Times are those of this machine.
Exit status: 0, or 1 if nothing reaches the error that is wanted.

Examples:
  dalembert accuracy double_pendulum --until 10
  dalembert accuracy rolling_disk --until 2 --wanted 1e-9
  dalembert accuracy chaplygin_sleigh --integrator dop853 --integrator taylor --csv sleigh.csv --plot sleigh.svg";

const EVAL_EXAMPLES: &str = "Input: a JSON array of states, {\"q\": [..], \"qdot\": [..]} or {\"q\": [..], \"p\": [..]}, with \"t\"
if the model depends on time. Numbers may be decimal strings. Output: an array of the same length; a
state at which something does not exist gives {\"error\": ..} and exit status 1.

Examples:
  echo '[{\"q\": [1], \"qdot\": [-2]}]' | dalembert eval bouncing_ball
  dalembert eval rolling_disk --set m=2 --newton 0.5 --input states.json";

const STABILITY_EXAMPLES: &str = "Each case has a right answer that is a closed form, an exact count or a class of outcome. Exit status: 0 every
case passes or is pending, 1 some case fails.

Examples:
  dalembert stability
  dalembert stability --section A --integrator dopri5
  dalembert stability --case C11 --case C13 --html report.html";

/// Text for people or JSON for programs.
#[derive(Debug, Clone, Copy, PartialEq, Eq, ValueEnum)]
pub enum Format {
    /// For people.
    Text,
    /// For programs.
    Json,
}

/// How a derivation is printed.
#[derive(Debug, Clone, Copy, PartialEq, Eq, ValueEnum)]
pub enum DeriveFormat {
    /// For people.
    Text,
    /// For documents.
    Latex,
    /// For programs.
    Json,
}

/// `list`
#[derive(Debug, Args)]
pub struct ListArgs {
    /// How to print.
    #[arg(long, value_enum, default_value_t = Format::Text)]
    pub format: Format,
}

/// `derive`
#[derive(Debug, Args)]
pub struct DeriveArgs {
    /// Name of the model, as `list` prints it, or a file with its declaration: `disk.dal`, `systems.dal:disk`, `-`.
    pub model: String,
    /// The scene.
    #[arg(long, value_name = "SCENE", default_value = "all")]
    pub scene: String,
    /// How to print.
    #[arg(long, value_enum, default_value_t = DeriveFormat::Text)]
    pub format: DeriveFormat,
}

/// `check`
#[derive(Debug, Args)]
pub struct CheckArgs {
    /// Name of the model, as `list` prints it, or a file with its declaration: `disk.dal`, `systems.dal:disk`, `-`.
    pub model: String,
    /// How to print.
    #[arg(long, value_enum, default_value_t = Format::Text)]
    pub format: Format,
    /// Write what the claims are about and what their proofs rest on, as JSON; `python/check_certificate.py` checks it.
    #[arg(long, value_name = "FILE")]
    pub certificate: Option<PathBuf>,
}

/// The model, its scene and its parameters.
#[derive(Debug, Args)]
pub struct ModelArgs {
    /// Name of the model, as `list` prints it, or a file with its declaration: `disk.dal`, `systems.dal:disk`, `-`.
    pub model: String,
    /// The scene.
    #[arg(long, value_name = "SCENE", default_value = "all")]
    pub scene: String,
    /// Set a parameter; may be repeated.
    #[arg(long, value_name = "NAME=VALUE", allow_hyphen_values = true)]
    pub set: Vec<String>,
    /// Run a model of a file without looking at its claims.
    #[arg(long)]
    pub no_claims: bool,
    /// The mode to begin in, of a model with modes; without it the first.
    #[arg(long, value_name = "MODE")]
    pub mode: Option<String>,
}

/// The state to start from.
#[derive(Debug, Args)]
pub struct StateArgs {
    /// Change the model's initial state by name: `x=..`, `theta.3=..`, `x_dot=..`, `theta_dot.3=..`;
    /// what nobody names follows from the constraints.
    #[arg(long, value_name = "NAME=VALUE,..", allow_hyphen_values = true, conflicts_with_all = ["q", "qdot", "p"])]
    pub initial: Vec<String>,
    /// All positions, in the order of the coordinates; needs --qdot or --p.
    #[arg(long, value_name = "V,..", allow_hyphen_values = true)]
    pub q: Option<String>,
    /// All velocities; needs --q.
    #[arg(
        long,
        value_name = "V,..",
        allow_hyphen_values = true,
        conflicts_with = "p"
    )]
    pub qdot: Option<String>,
    /// All momenta; needs --q.
    #[arg(long, value_name = "V,..", allow_hyphen_values = true)]
    pub p: Option<String>,
    /// What to do with positions or a velocity that violate the constraints.
    #[arg(long, value_parser = choice::off_constraint(), default_value = "error")]
    pub off_constraint: OffConstraint,
}

/// `on` or `off`.
#[derive(Debug, Clone, Copy, PartialEq, Eq, ValueEnum)]
pub enum Switch {
    /// Yes.
    On,
    /// No.
    Off,
}

/// What to do on a surface that the motion presses into.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Default, ValueEnum)]
pub enum RestPolicy {
    /// End the run, as `contact`, or as `zeno` where impacts accumulate.
    #[default]
    Stop,
    /// Go on along the surface without friction, until it would have to pull.
    Contact,
}

/// What to do after a law that leaves the state approaching.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Default, ValueEnum)]
pub enum PenetrationPolicy {
    /// End the run, as `still_penetrating`.
    #[default]
    Stop,
    /// Repeat the law for ever: its limit is `impact_plastic`.
    Repeat,
    /// The same, and go on along the surface as with `--rest contact`.
    Contact,
}

/// What to do where several surfaces are hit at one time, and their order matters.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Default, ValueEnum)]
pub enum CornerPolicy {
    /// End the run, as `ambiguous`.
    #[default]
    Stop,
    /// Always first the surface declared first.
    Ascending,
    /// Always first the surface declared last.
    Descending,
}

/// What to do at a transition that the motion can go on from in more than one way.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Default, ValueEnum)]
pub enum SplitPolicy {
    /// Go on refracted, where that is possible.
    #[default]
    First,
    /// End the run, as `ambiguous`.
    Stop,
}

/// What impacts do where a law alone does not tell how to go on.
#[derive(Debug, Clone, Copy, Args)]
pub struct PolicyArgs {
    /// On a surface that the motion presses into: after impacts that accumulate, after a plastic impact, at the start.
    #[arg(long, value_enum, default_value_t)]
    pub rest: RestPolicy,
    /// After a law that leaves the state approaching.
    #[arg(long, value_enum, default_value_t)]
    pub penetration: PenetrationPolicy,
    /// At several surfaces at one time whose order matters.
    #[arg(long, value_enum, default_value_t)]
    pub corner: CornerPolicy,
    /// At a transition that the motion can go on from refracted or reflected.
    #[arg(long, value_enum, default_value_t)]
    pub split: SplitPolicy,
}

impl PolicyArgs {
    /// The policies of the run.
    pub fn policies(self) -> Policies {
        let rests =
            self.rest == RestPolicy::Contact || self.penetration == PenetrationPolicy::Contact;
        Policies {
            rest: if rests { Rest::Contact } else { Rest::Stop },
            penetration: match self.penetration {
                PenetrationPolicy::Stop => Penetration::Stop,
                PenetrationPolicy::Repeat | PenetrationPolicy::Contact => Penetration::Repeat,
            },
            corner: match self.corner {
                CornerPolicy::Stop => Corner::Stop,
                CornerPolicy::Ascending => Corner::Ascending,
                CornerPolicy::Descending => Corner::Descending,
            },
            split: match self.split {
                SplitPolicy::First => Split::First,
                SplitPolicy::Stop => Split::Stop,
            },
        }
    }
}

/// Help text of `--law`.
fn law_help() -> String {
    let laws = Law::NAMES.map(|(name, takes_coefficient)| match takes_coefficient {
        true => format!("{name}:E"),
        false => name.to_owned(),
    });
    format!(
        "Use this impact law, at one surface or at all; may be repeated. Laws: {}, with E in [0, 1]; reset where one is \
         declared",
        laws.join(", ")
    )
}

/// A run but for its integrator.
#[derive(Debug, Args)]
pub struct RunArgs {
    /// The model.
    #[command(flatten)]
    pub model: ModelArgs,
    /// Hold an input at a value, 0 if it is not given; may be repeated.
    #[arg(long, value_name = "NAME=VALUE", allow_hyphen_values = true)]
    pub input: Vec<String>,
    /// The state.
    #[command(flatten)]
    pub state: StateArgs,
    /// End time; without it the model's `until`.
    #[arg(long, value_name = "T", allow_hyphen_values = true, value_parser = ValueParser::new(scalar::positive))]
    pub until: Option<f64>,
    /// The laws to use instead of the declared ones.
    #[arg(long, value_name = "[SURFACE=]LAW[:E]", help = law_help())]
    pub law: Vec<String>,
    /// Where a law alone does not tell how to go on.
    #[command(flatten)]
    pub policies: PolicyArgs,
    /// The form of the equations. Without it reduced where the model has such a form; global for states that are kept
    /// off the constraints and with --projection.
    #[arg(long, value_parser = choice::form())]
    pub form: Option<Form>,
    /// Whether to project on the constraints after each step, in global form; without it as the scene declares.
    #[arg(long, value_enum)]
    pub projection: Option<Switch>,
}

/// The integrator of a run, and what ends it before its time.
#[derive(Debug, Args)]
pub struct CourseArgs {
    /// Stop after this many impacts. Without --until the run may then take up to 3600 units of time, or the
    /// model's `until` if that is longer, to get there.
    #[arg(long, value_name = "N", allow_hyphen_values = true, value_parser = clap::value_parser!(u64).range(1..))]
    pub impacts: Option<u64>,
    /// The integrator.
    #[arg(long, value_parser = choice::integrator(), default_value = Integrator::Dop853.name())]
    pub integrator: Integrator,
    /// The step of an integrator of fixed step. Without it, one that suits --tol where the run starts, of which about
    /// four million make the run at most; the summary says which.
    #[arg(long, value_name = "H", allow_hyphen_values = true, value_parser = ValueParser::new(scalar::positive))]
    pub step: Option<f64>,
    /// The largest step that dop853, dopri5 and taylor may take. A force that acts for a short time is stepped over unless it
    /// lasts longer than this.
    #[arg(long, value_name = "H", allow_hyphen_values = true, value_parser = ValueParser::new(scalar::positive))]
    pub max_step: Option<f64>,
    /// Relative error allowed per step, between 1e-15 and 0.1.
    #[arg(long, value_name = "X", default_value = "1e-10", allow_hyphen_values = true, value_parser = ValueParser::new(scalar::tolerance))]
    pub tol: f64,
    /// Stop after this many steps, with the outcome `step_budget`.
    #[arg(long, value_name = "N", allow_hyphen_values = true, value_parser = clap::value_parser!(u64).range(1..))]
    pub steps: Option<u64>,
}

/// `simulate`
#[derive(Debug, Args)]
pub struct SimulateArgs {
    /// The run.
    #[command(flatten)]
    pub run: RunArgs,
    /// Its integrator and its end.
    #[command(flatten)]
    pub course: CourseArgs,
    /// Certified motion.
    #[command(flatten)]
    pub certify: CertifyArgs,
    /// Measure the error of the run against a reference as exact as `f64` allows, which takes three more runs. The impacts of
    /// all of them are audited by enclosures, without the search that found them; where they are not confirmed, or differ, the
    /// run is `not verified` and the exit status is 1.
    #[arg(long)]
    pub verify: bool,
    /// Number of equally spaced times from 0 to the end, both included, to record (at most 1000000).
    #[arg(long, value_name = "N", allow_hyphen_values = true, value_parser = clap::value_parser!(u64).range(0..=1_000_000), default_value_t = 1000)]
    pub samples: u64,
    /// Write samples and impacts as a table; `-` is the standard output.
    #[arg(long, value_name = "FILE")]
    pub csv: Option<PathBuf>,
    /// Write everything as one JSON document; `-` is the standard output.
    #[arg(long, value_name = "FILE")]
    pub json: Option<PathBuf>,
    /// Draw the run: what --axes says; without it the declared view, or all coordinates against time.
    #[arg(long, value_name = "FILE.svg")]
    pub plot: Option<PathBuf>,
    /// Draw these: `t` or another quantity along x, one or more along y. Quantities: t, coordinates, velocities `x_dot`,
    /// momenta `p_x`, energy, energy_error, outputs; q, qdot, p and outputs stand for all of their kind.
    #[arg(long, value_name = "X,Y[,Y..]", requires = "plot")]
    pub axes: Option<String>,
    /// Width of the picture, in pixels.
    #[arg(long, value_name = "PIXELS", requires = "plot", value_parser = clap::value_parser!(u32).range(300..=4000), default_value_t = 900)]
    pub plot_width: u32,
}

/// `accuracy`
#[derive(Debug, Args)]
pub struct AccuracyArgs {
    /// The runs.
    #[command(flatten)]
    pub run: RunArgs,
    /// The error that is wanted: say which integrator reaches it in the least time.
    #[arg(long, value_name = "X", allow_hyphen_values = true, value_parser = ValueParser::new(scalar::positive))]
    pub wanted: Option<f64>,
    /// Only this integrator; may be repeated.
    #[arg(long, value_parser = choice::integrator())]
    pub integrator: Vec<Integrator>,
    /// How often each case is timed; the median counts.
    #[arg(long, value_name = "N", value_parser = clap::value_parser!(u32).range(1..), default_value_t = 5)]
    pub rounds: u32,
    /// Seconds that a run may take; an integrator is not tried at tighter tolerances once it takes longer.
    #[arg(long, value_name = "S", allow_hyphen_values = true, value_parser = ValueParser::new(scalar::positive), default_value = "1")]
    pub patience: f64,
    /// Write what was measured as a table; `-` is the standard output.
    #[arg(long, value_name = "FILE")]
    pub csv: Option<PathBuf>,
    /// Write everything as one JSON document; `-` is the standard output.
    #[arg(long, value_name = "FILE")]
    pub json: Option<PathBuf>,
    /// Draw the work-precision diagram: time against error.
    #[arg(long, value_name = "FILE.svg")]
    pub plot: Option<PathBuf>,
}

/// `eval`
#[derive(Debug, Args)]
pub struct EvalArgs {
    /// The model.
    #[command(flatten)]
    pub model: ModelArgs,
    /// Evaluate the law `restitution` too, with this coefficient in [0, 1].
    #[arg(long, value_name = "E", allow_hyphen_values = true, value_parser = ValueParser::new(scalar::coefficient))]
    pub restitution: Option<f64>,
    /// Evaluate the law `newton` too, with this coefficient in [0, 1].
    #[arg(long, value_name = "E", allow_hyphen_values = true, value_parser = ValueParser::new(scalar::coefficient))]
    pub newton: Option<f64>,
    /// Read the states from a file instead of the standard input; `-` is the standard input.
    #[arg(long, value_name = "FILE")]
    pub input: Option<PathBuf>,
}

/// `stability`
#[derive(Debug, Args)]
pub struct StabilityArgs {
    /// Only this case; may be repeated.
    #[arg(long, value_name = "ID")]
    pub case: Vec<String>,
    /// Only the cases of this section; may be repeated.
    #[arg(long, value_name = "LETTER")]
    pub section: Vec<String>,
    /// The long cases too.
    #[arg(long)]
    pub nightly: bool,
    /// Only by this integrator; otherwise each case is run by all.
    #[arg(long, value_parser = choice::integrator())]
    pub integrator: Option<Integrator>,
    /// Write the findings as one JSON document; `-` is the standard output.
    #[arg(long, value_name = "FILE")]
    pub json: Option<PathBuf>,
    /// Write the findings as a page with plots, in one file.
    #[arg(long, value_name = "FILE.html")]
    pub html: Option<PathBuf>,
}

#[cfg(test)]
mod tests {
    use clap::CommandFactory;

    use super::*;

    #[test]
    fn the_grammar_is_consistent() {
        CommandLine::command().debug_assert();
    }
}
