//! Grammar of the command line, a public interface. Names are checked where they are used, because the model is known
//! only there.

mod certify;
mod check;
mod choice;
mod connect;
mod control;
mod derive;
mod dynamic;
mod ensemble;
mod errata;
mod file;
mod files;
mod gallery;
mod help;
mod linearise;
mod map;
mod model;
mod orbit;
mod rows;
mod search;
mod series;

use std::path::PathBuf;
use std::thread::available_parallelism;

use clap::builder::ValueParser;
use clap::{ArgGroup, Args, Parser, Subcommand, ValueEnum};
use dalembert::law::Law;
use dalembert::policy::{Corner, Penetration, Policies, Rest, Split};
use dalembert_driver::course::IntegratorChoice;
use dalembert_driver::{Form, Integrator, OffConstraint};

use crate::input_table::Between;
use crate::scalar;
pub use certify::CertifyArgs;
pub use check::CheckArgs;
pub use connect::ConnectArgs;
pub use control::ControlArgs;
pub use derive::{DeriveArgs, DeriveFormat};
pub use dynamic::{DynamicArgs, Shown};
pub use ensemble::EnsembleArgs;
pub use errata::ErrataArgs;
pub use file::{BuildArgs, ExportArgs, NewArgs, WatchArgs};
pub use gallery::GalleryArgs;
pub use linearise::LineariseArgs;
pub use map::MapArgs;
pub use model::{ClaimsArgs, FeedbackArgs, ModelArgs, Selection};
pub use orbit::OrbitArgs;
pub use rows::RowsArgs;
pub use search::SearchArgs;
pub use series::SeriesArgs;

/// Derive, evaluate and simulate mechanical systems declared in a file or with `dalembert::model!`.
#[derive(Debug, Parser)]
#[command(
    version,
    arg_required_else_help = true,
    help_template = help::TEMPLATE,
    before_help = "Example: dalembert simulate rolling_disk --until 40 --plot disk.svg",
    after_help = "Exit status: 0 the requested end was reached, 1 any other outcome, 2 bad flags or input."
)]
pub struct CommandLine {
    /// Command.
    #[command(subcommand)]
    pub command: Command,
}

/// The commands.
#[derive(Debug, Subcommand)]
pub enum Command {
    /// List the models with their numbers of coordinates (N), constraints (M) and surfaces (S).
    #[command(help_template = help::TEMPLATE, before_help = "Example: dalembert list", after_help = help::LIST)]
    List(ListArgs),
    /// Print the derived equations of a model: metric, constraints, field, impact maps.
    #[command(help_template = help::TEMPLATE, before_help = "Example: dalembert derive rolling_disk", after_help = help::DERIVE)]
    Derive(DeriveArgs),
    /// Check the declared values and the claims of a model.
    #[command(help_template = help::TEMPLATE, before_help = "Example: dalembert check rolling_disk", after_help = help::CHECK)]
    Check(CheckArgs),
    /// Run a model from a state to an end time or a number of impacts.
    #[command(
        help_template = help::TEMPLATE,
        before_help = "Example: dalembert simulate rolling_disk --until 40 --plot disk.svg",
        after_help = [help::SIMULATE, certify::EXAMPLES].concat()
    )]
    Simulate(Box<SimulateArgs>),
    /// Run many members of one scene: initial states and parameters on a grid, at random or from a file.
    #[command(
        help_template = help::TEMPLATE,
        before_help = "Example: dalembert ensemble bouncing_ball --vary x=0.5..2:20 --until 10",
        after_help = ensemble::EXAMPLES
    )]
    Ensemble(Box<EnsembleArgs>),
    /// Run every cell of a grid of starts or parameters, and draw the end of each run.
    #[command(
        help_template = help::TEMPLATE,
        before_help = "Example: dalembert map dimensionless_walker --vary eta=-2..2:20 --vary xi=-3..1:20 --returns 20 --fail 'theta > pi/2' --plot map.svg",
        after_help = map::EXAMPLES
    )]
    Map(Box<MapArgs>),
    /// Measure the cost of accuracy: error, work and time of every integrator at a series of tolerances.
    ///
    /// An error is the difference from a reference run. The impacts of the reference are checked by interval enclosures,
    /// independently of event location. If the check fails, nothing is measured and the exit status is 1.
    #[command(
        help_template = help::TEMPLATE,
        before_help = "Example: dalembert accuracy double_pendulum --until 10",
        after_help = help::ACCURACY
    )]
    Accuracy(Box<AccuracyArgs>),
    /// Find a periodic orbit by its returns to a surface, and its Floquet multipliers.
    #[command(
        help_template = help::TEMPLATE,
        before_help = "Example: dalembert orbit dimensionless_walker --surface step",
        after_help = orbit::EXAMPLES
    )]
    Orbit(Box<OrbitArgs>),
    /// Find motions that join two configurations in a given time, with given numbers of impacts.
    #[command(
        help_template = help::TEMPLATE,
        before_help = "Example: dalembert connect bouncing_ball --from x=0 --to x=0.2 --time 5 --impacts 0..3",
        after_help = connect::EXAMPLES
    )]
    Connect(Box<ConnectArgs>),
    /// Linearise the equations of motion at a state, or at an equilibrium that is found first.
    #[command(
        help_template = help::TEMPLATE,
        before_help = "Example: dalembert linearise double_pendulum --initial theta1=0.1,theta2=0.1 --trim",
        after_help = linearise::EXAMPLES
    )]
    Linearise(Box<LineariseArgs>),
    /// Find inputs that minimise the cost of a model, across impacts.
    #[command(
        help_template = help::TEMPLATE,
        before_help = "Example: dalembert control controlled_ball --impacts 0..2",
        after_help = control::EXAMPLES
    )]
    Control(Box<ControlArgs>),
    /// Evaluate all derived quantities at given states.
    #[command(
        help_template = help::TEMPLATE,
        before_help = "Example: echo '[{\"q\": [1], \"qdot\": [-2]}]' | dalembert eval bouncing_ball",
        after_help = help::EVAL
    )]
    Eval(EvalArgs),
    /// Write a file with a commented declaration as a starting point.
    #[command(help_template = help::TEMPLATE, before_help = "Example: dalembert new pendulum", after_help = file::NEW_EXAMPLES)]
    New(NewArgs),
    /// Run a model of a file again whenever the file is saved.
    #[command(
        help_template = help::TEMPLATE,
        before_help = "Example: dalembert new pendulum && dalembert watch pendulum.dal",
        after_help = file::WATCH_EXAMPLES
    )]
    Watch(Box<WatchArgs>),
    /// Write a crate that compiles the models of a file.
    #[command(
        help_template = help::TEMPLATE,
        before_help = "Example: dalembert new pendulum && dalembert build pendulum.dal",
        after_help = file::BUILD_EXAMPLES
    )]
    Build(BuildArgs),
    /// Write the functions of a model as a C header.
    #[command(
        help_template = help::TEMPLATE,
        before_help = "Example: dalembert export rolling_disk --c disk.h",
        after_help = file::EXPORT_EXAMPLES
    )]
    Export(ExportArgs),
    /// Draw figures of the models on one page.
    #[command(
        help_template = help::TEMPLATE,
        before_help = "Example: dalembert gallery pictures bouncing_ball --quick",
        after_help = gallery::EXAMPLES
    )]
    Gallery(GalleryArgs),
    /// List misprints in the sources of the models, and compute the printed and the right values.
    #[command(help_template = help::TEMPLATE, before_help = "Example: dalembert errata", after_help = errata::EXAMPLES)]
    Errata(ErrataArgs),
    /// Run the hard cases and report which of them stay within their error bounds.
    #[command(
        help_template = help::TEMPLATE,
        before_help = "Example: cargo run --release -p dalembert-stability -- stability --section A",
        after_help = help::STABILITY
    )]
    Stability(StabilityArgs),
}

impl Command {
    /// The flags that select the model of the command, for commands that read one model once.
    pub fn selection(&mut self) -> Option<Selection<'_>> {
        let (model, feedback, skips_claims) = match self {
            Self::Derive(args) => (&mut args.model, &args.feedback, args.claims.no_claims),
            // Claims are the subject of the command.
            Self::Check(args) => (&mut args.model, &args.feedback, false),
            Self::Export(args) => (&mut args.model, &args.feedback, args.claims.no_claims),
            _ => return self.model_to_run().map(ModelArgs::selection),
        };
        Some(Selection {
            model,
            feedback: &feedback.feedback,
            skips_claims,
        })
    }

    /// The model arguments of the command, if it runs a model.
    fn model_to_run(&mut self) -> Option<&mut ModelArgs> {
        match self {
            Self::Simulate(args) => Some(&mut args.run.model),
            Self::Ensemble(args) => Some(&mut args.run.model),
            Self::Map(args) => Some(&mut args.run.model),
            Self::Accuracy(args) => Some(&mut args.run.model),
            Self::Orbit(args) => Some(&mut args.model),
            Self::Connect(args) => Some(&mut args.model),
            Self::Linearise(args) => Some(&mut args.model),
            Self::Control(args) => Some(&mut args.model),
            Self::Eval(args) => Some(&mut args.model),
            _ => None,
        }
    }
}

/// The given number of threads, or the number that the machine runs in parallel.
fn thread_count(given: Option<u16>) -> u64 {
    match given {
        Some(threads) => u64::from(threads),
        None => available_parallelism().map_or(1, |threads| threads.get() as u64),
    }
}

/// Text for people or JSON for programs.
#[derive(Debug, Clone, Copy, PartialEq, Eq, ValueEnum)]
pub enum Format {
    /// For people.
    Text,
    /// For programs.
    Json,
}

/// `list`
#[derive(Debug, Args)]
pub struct ListArgs {
    /// Output format.
    #[arg(long, value_enum, default_value_t = Format::Text)]
    pub format: Format,
    /// Write the list as one JSON document. `-` is the standard output.
    #[arg(long, value_name = "FILE", conflicts_with = "format")]
    pub json: Option<PathBuf>,
}

/// The state to start from.
#[derive(Debug, Args)]
pub struct StateArgs {
    /// Change the model's initial state by name: `x=..`, `theta.3=..`, `x_dot=..`, `theta_dot.3=..`. The names of the
    /// language work too: `theta[3]`, `dot(x)`, `dot(theta[3])`. Values that are given neither here nor by the model
    /// follow from the constraints.
    #[arg(long, value_name = "NAME=VALUE,..", allow_hyphen_values = true, conflicts_with_all = ["q", "qdot", "p"])]
    pub initial: Vec<String>,
    /// All positions, in the order of the coordinates. Needs --qdot or --p.
    #[arg(long, value_name = "V,..", allow_hyphen_values = true)]
    pub q: Option<String>,
    /// All velocities. Needs --q.
    #[arg(
        long,
        value_name = "V,..",
        allow_hyphen_values = true,
        conflicts_with = "p"
    )]
    pub qdot: Option<String>,
    /// All momenta. Needs --q.
    #[arg(long, value_name = "V,..", allow_hyphen_values = true)]
    pub p: Option<String>,
    /// Treatment of initial positions or velocities that violate the constraints.
    #[arg(long, value_parser = choice::off_constraint(), default_value = "error")]
    pub off_constraint: OffConstraint,
}

/// `on` or `off`.
#[derive(Debug, Clone, Copy, PartialEq, Eq, ValueEnum)]
pub enum Switch {
    /// Project after each step.
    On,
    /// Do not project.
    Off,
}

/// Treatment of a surface that the motion presses into.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Default, ValueEnum)]
pub enum RestPolicy {
    /// End the run with the outcome `contact`, or `zeno` if impacts accumulate.
    #[default]
    Stop,
    /// Continue along the surface without friction, until the surface would have to pull.
    Contact,
}

/// Treatment of an impact after which the state still approaches the surface.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Default, ValueEnum)]
pub enum PenetrationPolicy {
    /// End the run with the outcome `still_penetrating`.
    #[default]
    Stop,
    /// Use the limit of the repeated law, which is `impact_plastic`.
    Repeat,
    /// Like `repeat`, and continue along the surface as with `--rest contact`.
    Contact,
}

/// Treatment of simultaneous impacts at several surfaces whose order matters.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Default, ValueEnum)]
pub enum CornerPolicy {
    /// End the run with the outcome `ambiguous`.
    #[default]
    Stop,
    /// Process the surface declared first before the others.
    Ascending,
    /// Process the surface declared last before the others.
    Descending,
}

/// Treatment of a transition at which both refraction and reflection are possible.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Default, ValueEnum)]
pub enum SplitPolicy {
    /// Continue with the refracted motion, if it is possible.
    #[default]
    First,
    /// End the run with the outcome `ambiguous`.
    Stop,
}

/// Treatment of impacts after which the law alone does not determine the motion.
#[derive(Debug, Clone, Copy, Args)]
pub struct PolicyArgs {
    /// Treatment of a surface that the motion presses into: after a plastic impact, after impacts that accumulate, or at
    /// the start.
    #[arg(long, value_enum, default_value_t)]
    pub rest: RestPolicy,
    /// Treatment of an impact after which the state still approaches the surface.
    #[arg(long, value_enum, default_value_t)]
    pub penetration: PenetrationPolicy,
    /// Treatment of simultaneous impacts at several surfaces whose order matters.
    #[arg(long, value_enum, default_value_t)]
    pub corner: CornerPolicy,
    /// Treatment of a transition at which both refraction and reflection are possible.
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
        "Use this impact law at one surface, or at all surfaces. May be repeated. Laws: {}, with E in [0, 1]. A reset must \
         be declared",
        laws.join(", ")
    )
}

/// A run except for its integrator.
#[derive(Debug, Args)]
pub struct RunArgs {
    /// The model.
    #[command(flatten)]
    pub model: ModelArgs,
    /// Set inputs to constant values; 0 by default. May be repeated.
    #[arg(
        long,
        value_name = "NAME=VALUE,..",
        value_delimiter = ',',
        allow_hyphen_values = true
    )]
    pub input: Vec<String>,
    /// The state.
    #[command(flatten)]
    pub state: StateArgs,
    /// End time. Default: the model's `until`.
    #[arg(long, value_name = "T", allow_hyphen_values = true, value_parser = ValueParser::new(scalar::positive))]
    pub until: Option<f64>,
    /// Laws in place of the declared ones.
    #[arg(long, value_name = "[SURFACE=]LAW[:E]", help = law_help())]
    pub law: Vec<String>,
    /// Treatment of impacts after which the law alone does not determine the motion.
    #[command(flatten)]
    pub policies: PolicyArgs,
    /// Form of the equations. Default: reduced if the model has that form, but global with --off-constraint keep and with
    /// --projection.
    #[arg(long, value_parser = choice::form())]
    pub form: Option<Form>,
    /// Projection to the constraints after each step, in global form. Default: as the scene declares, but off
    /// with --off-constraint keep.
    #[arg(long, value_enum)]
    pub projection: Option<Switch>,
}

/// The integrator of a run, and the limits that end it before its end time.
#[derive(Debug, Clone, Args)]
pub struct CourseArgs {
    /// Stop after this many impacts. Without --until the end time is then 3600, or the model's `until` if that is later.
    #[arg(long, value_name = "N", allow_hyphen_values = true, value_parser = clap::value_parser!(u64).range(1..))]
    pub impacts: Option<u64>,
    /// Integrator.
    #[arg(long, value_parser = choice::integrator_or_auto(), default_value = IntegratorChoice::AUTOMATIC)]
    pub integrator: IntegratorChoice,
    /// Step of an integrator of fixed step. Default: a step that satisfies --tol at the start, but not so short that the
    /// run takes more than about four million steps. The summary prints it.
    #[arg(long, alias = "dt", value_name = "H", allow_hyphen_values = true, value_parser = ValueParser::new(scalar::positive))]
    pub step: Option<f64>,
    /// Largest step of dop853, dopri5 and taylor. A force that acts for a time shorter than the step may be missed:
    /// choose a largest step below its duration.
    #[arg(long, value_name = "H", allow_hyphen_values = true, value_parser = ValueParser::new(scalar::positive))]
    pub max_step: Option<f64>,
    /// Tolerance: relative local error per step, between 1e-15 and 0.1.
    #[arg(long, value_name = "X", default_value = "1e-10", allow_hyphen_values = true, value_parser = ValueParser::new(scalar::tolerance))]
    pub tol: f64,
    /// Stop after this many steps, with the outcome `step_budget`.
    #[arg(long, value_name = "N", allow_hyphen_values = true, value_parser = clap::value_parser!(u64).range(1..))]
    pub steps: Option<u64>,
}

/// `simulate`
#[derive(Debug, Args)]
#[command(group = ArgGroup::new("drawn").args(["plot", "html"]).multiple(true))]
pub struct SimulateArgs {
    /// Run.
    #[command(flatten)]
    pub run: RunArgs,
    /// Integrator and end of the run.
    #[command(flatten)]
    pub course: CourseArgs,
    /// Take inputs from a table with a column `t` and columns of inputs, such as the table of `control --inputs`. Two
    /// rows at the same time make a jump. Inputs without a column have the values of --input. Inputs are constant
    /// before the first row and after the last one.
    #[arg(long, value_name = "FILE.csv", conflicts_with_all = ["verify", "certify"])]
    pub inputs: Option<PathBuf>,
    /// Interpolation of the inputs between the rows of --inputs.
    #[arg(long, value_enum, requires = "inputs", default_value_t = Between::Cubic)]
    pub between: Between,
    /// Add an output to the model for this run, such as `S = integral(lagrangian)`. The expression has the syntax of
    /// `outputs` in a model; it cannot refer to another output. May be repeated.
    #[arg(
        long,
        value_name = "NAME = EXPR",
        allow_hyphen_values = true,
        conflicts_with = "certify"
    )]
    pub output: Vec<String>,
    /// Certified motion.
    #[command(flatten)]
    pub certify: CertifyArgs,
    /// Measure the error of the run against a reference at the smallest tolerance. This takes three more runs. The
    /// impacts of all runs are checked by interval enclosures, independently of event location. If the check fails, or
    /// if the runs have different impacts, the run is `not verified` and the exit status is 1.
    #[arg(long)]
    pub verify: bool,
    /// Number of equally spaced times from 0 to the end, both included, to record (at most 1000000).
    #[arg(long, value_name = "N", allow_hyphen_values = true, value_parser = clap::value_parser!(u64).range(0..=1_000_000), default_value_t = 1000)]
    pub samples: u64,
    /// Write samples and impacts as a table. `-` is the standard output.
    #[arg(long, value_name = "FILE")]
    pub csv: Option<PathBuf>,
    /// Write the results as one JSON document. `-` is the standard output.
    #[arg(long, value_name = "FILE")]
    pub json: Option<PathBuf>,
    /// Draw the run: the axes of --axes, else the declared view, else all coordinates against time.
    #[arg(long, value_name = "FILE.svg")]
    pub plot: Option<PathBuf>,
    /// Write a page that shows the same picture as an animation, with a slider for the time. It needs no other file.
    #[arg(long, value_name = "FILE.html", conflicts_with = "certify")]
    pub html: Option<PathBuf>,
    /// Length of the animation of --html in seconds, up to 600.
    #[arg(long, value_name = "S", requires = "html", allow_hyphen_values = true, value_parser = ValueParser::new(scalar::seconds_shown), default_value = "10")]
    pub duration: f64,
    /// Quantities of the picture: one along x, one or more along y. Quantities are `t`, coordinates, velocities
    /// `x_dot`, momenta `p_x`, `energy`, `energy_error` and outputs. `q`, `qdot`, `p` and `outputs` stand for all
    /// coordinates, velocities, momenta and outputs.
    #[arg(long, value_name = "X,Y[,Y..]", requires = "drawn")]
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
    /// Error for which the fastest integrator is reported.
    #[arg(long, value_name = "X", allow_hyphen_values = true, value_parser = ValueParser::new(scalar::positive))]
    pub wanted: Option<f64>,
    /// Measure only this integrator. May be repeated.
    #[arg(long, value_parser = choice::integrator())]
    pub integrator: Vec<Integrator>,
    /// Largest number of timings of each case. The median is reported.
    #[arg(long, value_name = "N", value_parser = clap::value_parser!(u32).range(1..), default_value_t = 5)]
    pub rounds: u32,
    /// Time of all measurements in seconds. Once it is used up, a case that has been timed is not timed again. The
    /// reference and one timing of each case are always made.
    #[arg(long, value_name = "S", allow_hyphen_values = true, value_parser = ValueParser::new(scalar::positive), default_value = "5")]
    pub budget: f64,
    /// Largest time of a run with a fixed step in seconds; five times as long for dop853, dopri5 and taylor. An integrator
    /// that takes longer is not run at smaller tolerances. Default: a hundredth of --budget.
    #[arg(long, value_name = "S", allow_hyphen_values = true, value_parser = ValueParser::new(scalar::positive))]
    pub patience: Option<f64>,
    /// Write the measurements as a table. `-` is the standard output.
    #[arg(long, value_name = "FILE")]
    pub csv: Option<PathBuf>,
    /// Write the results as one JSON document. `-` is the standard output.
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
    /// Evaluate the law `restitution` as well, with this coefficient in [0, 1].
    #[arg(long, value_name = "E", allow_hyphen_values = true, value_parser = ValueParser::new(scalar::coefficient))]
    pub restitution: Option<f64>,
    /// Evaluate the law `newton` as well, with this coefficient in [0, 1].
    #[arg(long, value_name = "E", allow_hyphen_values = true, value_parser = ValueParser::new(scalar::coefficient))]
    pub newton: Option<f64>,
    /// Read the states from a file instead of the standard input; `-` is the standard input.
    #[arg(long, value_name = "FILE")]
    pub input: Option<PathBuf>,
}

/// `stability`
#[derive(Debug, Args)]
pub struct StabilityArgs {
    /// Run only this case. May be repeated.
    #[arg(long, value_name = "ID")]
    pub case: Vec<String>,
    /// Run only the cases of this section. May be repeated.
    #[arg(long, value_name = "LETTER")]
    pub section: Vec<String>,
    /// Run the long cases as well.
    #[arg(long)]
    pub nightly: bool,
    /// Run only with this integrator. Default: all of them.
    #[arg(long, value_parser = choice::integrator())]
    pub integrator: Option<Integrator>,
    /// Write the findings as one JSON document. `-` is the standard output.
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
