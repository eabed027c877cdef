//! The problem of dynamic programming: the first-order model of state, held input and cost, the grid, and the steps.

use dalembert::Tolerance;
use dalembert::describe::Description;
use dalembert_driver::{AnyModel, Axis, Landing, Lattice, Leg, Move, Unlanded};

use crate::args::{ClaimsArgs, ControlArgs, FeedbackArgs, ModelArgs};
use crate::entry::Entry;
use crate::error::{self, CliError};
use crate::state_input::{build_model, find_model};
use crate::{ends, names, scalar};

/// Largest number of values along an axis.
const MOST: usize = 4000;

/// Largest number of motions over a step, of all nodes and inputs.
const MOTIONS: usize = 1 << 24;

/// Largest number of nodes of all layers.
const VALUES: usize = 1 << 26;

/// Number of components of the state.
const STATE: usize = 2;

/// Builds the first-order model.
pub struct Builder {
    entries: Vec<Entry>,
    args: ModelArgs,
}

impl Builder {
    /// Builds a model.
    ///
    /// # Errors
    /// Unknown or refused parameters.
    pub fn built(&self) -> Result<Box<dyn AnyModel>, CliError> {
        build_model(&self.entries, &self.args)
    }
}

/// A problem of dynamic programming.
pub struct Problem {
    /// The builder of further models, for threads.
    pub builder: Builder,
    /// The first-order model.
    pub model: Box<dyn AnyModel>,
    /// The scene of the declared model.
    pub scene: String,
    /// True if the motions over a step do not depend on its start time.
    pub is_autonomous: bool,
    /// The nodes.
    pub lattice: Lattice,
    /// The inputs.
    pub inputs: Axis,
    /// Number of steps.
    pub steps: usize,
    /// The time of the end.
    pub time: f64,
    /// The value of --impacts: numbers of impacts of the extremals with which paths are compared.
    pub impacts: String,
    /// Number of threads.
    pub threads: u64,
    tolerance: Tolerance,
}

impl Problem {
    /// The problem of the flags.
    ///
    /// # Errors
    /// A model that does not have two components and one input, an invalid grid, refused parameters.
    pub fn of(models: &[Entry], args: &ControlArgs) -> Result<Self, CliError> {
        let loaded = super::super::held(models, args)?;
        let entries = vec![loaded.entry];
        entries.iter().try_for_each(Entry::check_size)?;
        let declared = find_model(models, &args.model.model)?.description();
        let builder = Builder {
            entries,
            args: ModelArgs {
                model: declared.name.to_owned(),
                scene: "all".to_owned(),
                set: args.model.set.clone(),
                feedback: FeedbackArgs::default(),
                claims: ClaimsArgs::default(),
                mode: None,
            },
        };
        let model = builder.built()?;
        check_shape(model.description(), loaded.inputs)?;
        let [x, y, inputs] = axes(model.description(), &args.dynamic.dp)?;
        let until = args.until.or(model.initial().until);
        let tolerance = Tolerance::new(args.tol)
            .map_err(|error| CliError::value("--tol", args.tol.to_string(), error.to_string()))?;
        let problem = Self {
            builder,
            model,
            scene: args.model.scene.clone(),
            is_autonomous: loaded.is_autonomous,
            lattice: Lattice { axes: [x, y] },
            inputs,
            steps: args.dynamic.steps as usize,
            time: until.filter(|time| *time > 0.0).ok_or(CliError::Usage(
                "--until is needed: the model declares no `until`",
            ))?,
            impacts: args.search.impacts.clone(),
            threads: args.dynamic.thread_count(),
            tolerance,
        };
        problem.check(args.dynamic.dp.join(",").as_str())?;
        Ok(problem)
    }

    fn check(&self, dp: &str) -> Result<(), CliError> {
        let nodes = self.lattice.count();
        if nodes * self.inputs.count > MOTIONS {
            let expected = format!("at most {MOTIONS} motions: nodes times inputs");
            return Err(CliError::value("--dp", dp, expected));
        }
        if nodes * (self.steps + 1) > VALUES {
            let expected = format!("at most {VALUES} values: nodes times steps");
            return Err(CliError::value("--steps", self.steps.to_string(), expected));
        }
        // A call without states reports only refusals of the model itself.
        match self.model.legs(&self.leg(0, &[]), &[]) {
            Ok(Some(_)) => Ok(()),
            Ok(None) => Err(CliError::Invariable {
                scene: self.scene.clone(),
            }),
            Err(refusal) => Err(CliError::Input {
                place: "--set".to_owned(),
                reason: error::refusal_text(self.model.description(), &refusal),
            }),
        }
    }

    /// The time of the start of a step.
    pub fn at(&self, step: usize) -> f64 {
        match step == self.steps {
            true => self.time,
            false => self.time * (step as f64 / self.steps as f64),
        }
    }

    /// A step with these inputs.
    pub fn leg<'a>(&self, step: usize, inputs: &'a [f64]) -> Leg<'a> {
        Leg {
            span: [self.at(step), self.at((step + 1).min(self.steps))],
            tolerance: self.tolerance,
            inputs,
        }
    }

    /// The values of the input.
    pub fn input_values(&self) -> Vec<f64> {
        let axis = self.inputs;
        (0..axis.count).map(|index| axis.value(index)).collect()
    }

    /// The input at a fractional index between its values.
    pub fn input(&self, place: f64) -> f64 {
        let axis = self.inputs;
        let [low, high] = axis.ends;
        match place == place.round() {
            true => axis.value(place as usize),
            false => (low + place * axis.step()).clamp(low, high),
        }
    }

    /// The terminal cost of a state.
    pub fn terminal(&self, state: [f64; 2]) -> f64 {
        let count = self.model.description().coordinates.len();
        let mut q = vec![0.0; count];
        q[..STATE].copy_from_slice(&state);
        let outputs = self.model.outputs(self.time, &q, &vec![0.0; count]);
        outputs
            .and_then(|it| it.first().copied())
            .unwrap_or(f64::NAN)
    }

    /// The names of the state's components, of the input and of the cost.
    pub fn names(&self) -> [&'static str; 4] {
        let mut names = names::coordinates(self.model.description());
        [(); 4].map(|()| names.next().unwrap_or_default())
    }

    /// The starts of the paths.
    ///
    /// # Errors
    /// An unknown component, a value that is not a number.
    pub fn starts(&self, args: &ControlArgs) -> Result<Vec<[f64; 2]>, CliError> {
        let declared = self.model.initial().q;
        let first = self.state("--initial", &args.initial, [declared[0], declared[1]])?;
        let paths = args.dynamic.path.iter();
        let paths: Vec<[f64; 2]> = paths
            .map(|text| self.state("--path", std::slice::from_ref(text), first))
            .collect::<Result<_, CliError>>()?;
        Ok(match paths.is_empty() {
            true => vec![first],
            false => paths,
        })
    }

    fn state(
        &self,
        flag: &'static str,
        texts: &[String],
        or: [f64; 2],
    ) -> Result<[f64; 2], CliError> {
        let states = self.names().into_iter().take(STATE);
        let given = ends::components(flag, "component", states, texts)?;
        Ok([0, 1].map(|index| given[index].unwrap_or(or[index])))
    }
}

/// The part of a motion over a step on which the choice of the input depends: its end, its cost, its impacts.
pub fn moved(landing: Result<&Landing, &Unlanded>) -> Move {
    match landing {
        Ok(landing) => Move {
            state: landing.state,
            cost: landing.cost,
            impacts: landing.hits.len() as u32,
        },
        Err(Unlanded::NoState) => Move::NOWHERE,
        Err(Unlanded::Lost) => Move::LOST,
    }
}

fn check_shape(description: &Description, inputs: usize) -> Result<(), CliError> {
    let states = description.coordinates.len() - 1 - inputs;
    let refuse = |reason: String| {
        Err(CliError::Input {
            place: "--dp".to_owned(),
            reason,
        })
    };
    if states != STATE {
        let components = error::counted(states, "component");
        return refuse(format!(
            "the state of `{}` has {components}, and a grid is for two: one degree of freedom; without --dp extremals are found",
            description.name
        ));
    }
    match inputs {
        1 => Ok(()),
        _ => refuse(format!(
            "`{}` has {inputs} inputs, and a grid is for one; without --dp extremals are found",
            description.name
        )),
    }
}

/// The axes of the state and of the input.
fn axes(description: &Description, texts: &[String]) -> Result<[Axis; 3], CliError> {
    let names: Vec<&str> = names::coordinates(description).take(STATE + 1).collect();
    let mut axes = [None; 3];
    for text in texts {
        let (name, range) = names::assignment("--dp", text, "NAME=A..B:COUNT")?;
        let index = names::find("--dp", "component or input", name, names.iter().copied())?;
        let axis = axis(name, range)?;
        if axes[index].replace(axis).is_some() {
            return Err(CliError::value("--dp", text, "every name once"));
        }
    }
    let mut all = Vec::new();
    for (axis, name) in axes.into_iter().zip(&names) {
        all.push(axis.ok_or_else(|| CliError::Input {
            place: "--dp".to_owned(),
            reason: format!(
                "there is no axis for `{name}`; write {}",
                names
                    .iter()
                    .map(|name| format!("{name}=A..B:COUNT"))
                    .collect::<Vec<_>>()
                    .join(",")
            ),
        })?);
    }
    Ok([all[0], all[1], all[2]])
}

fn axis(name: &str, text: &str) -> Result<Axis, CliError> {
    let refuse = |expected: &str| CliError::value(format!("--dp {name}"), text, expected);
    let parts = text
        .split_once("..")
        .and_then(|(first, rest)| Some((first, rest.split_once(':')?)));
    let Some((first, (last, count))) = parts else {
        return Err(refuse("A..B:COUNT, such as 0..3:61"));
    };
    let number = |text: &str| scalar::parse(text).map_err(&refuse);
    let ends = [number(first)?, number(last)?];
    let count = count.trim().parse().ok();
    let count = count.filter(|count| (2..=MOST).contains(count));
    match count {
        None => Err(refuse("a count from 2 to 4000")),
        Some(count) if ends[0] < ends[1] && ends.iter().all(|it| it.is_finite()) => {
            Ok(Axis { ends, count })
        }
        Some(_) => Err(refuse("A..B with A below B")),
    }
}
