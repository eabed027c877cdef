//! Models with modes: every mode is a model, and transitions connect the modes.
//!
//! The model as a whole has the coordinates, constraints, surfaces, forces and outputs of all modes, one for each name.
//! Coordinate `i` of a mode is coordinate `places.coordinates[i]` of the whole.

use dalembert_expr::Pool;

use super::check::{check_mode, peer};
use super::scene::{Extras, Parts, Scene};
use super::transition::Peer;
use super::{Beside, Coordinate, Model, Name, Surface, Topology};
use crate::diagnostics::Diagnostics;
use crate::spec::{self, STEPS};

/// A checked model with modes.
#[derive(Debug)]
pub struct ModeGraph {
    /// The modes, in order of declaration. A run begins in the first one.
    pub modes: Vec<Mode>,
    /// The coordinates of all modes.
    pub coordinates: Vec<Entry>,
    /// Constraints of all modes.
    pub constraints: Vec<Entry>,
    /// Quasi-velocities of all modes.
    pub frame: Vec<Entry>,
    /// Surfaces of all modes, transitions included.
    pub surfaces: Vec<Entry>,
    /// Outputs of all modes.
    pub outputs: Vec<Entry>,
    /// Names of the forces of all modes.
    pub forces: Vec<Entry>,
}

/// A mode.
#[derive(Debug)]
pub struct Mode {
    /// Names and documentation of the mode, stored as for a scene.
    pub scene: Scene,
    /// The mode as a model.
    pub model: Model,
    /// Indices of its declarations in the whole model.
    pub places: Places,
}

/// Indices in the whole model, in the order of the mode.
#[derive(Debug, Clone, Default)]
pub struct Places {
    /// Coordinates.
    pub coordinates: Vec<usize>,
    /// Constraints.
    pub constraints: Vec<usize>,
    /// Surfaces.
    pub surfaces: Vec<usize>,
    /// Outputs.
    pub outputs: Vec<usize>,
}

/// A declared name, with the first mode that declares it and its index there.
#[derive(Debug, Clone)]
pub struct Entry {
    /// Name.
    pub name: Name,
    /// Lines of its doc comment.
    pub documentation: Vec<String>,
    /// Index of the first mode that declares it.
    pub mode: usize,
    /// Index in that mode.
    pub place: usize,
}

impl ModeGraph {
    /// True if the modes are first-order systems. All modes are, or none.
    pub fn is_first_order(&self) -> bool {
        self.modes.iter().all(|mode| mode.model.is_first_order())
    }
}

impl ModeGraph {
    /// Pairs of transitions between first-order modes that cross the same surface in opposite directions and keep the
    /// state. The gaps of a pair, as written, differ in their sign.
    pub fn opposites(&self) -> impl Iterator<Item = [usize; 2]> {
        let leaving = |index: usize| {
            let mode = &self.modes[index];
            let surfaces = mode.model.surfaces.iter().zip(&mode.places.surfaces);
            surfaces.filter_map(move |(surface, place)| {
                Some((mode, surface, surface.transition.as_ref()?, *place))
            })
        };
        let all = (0..self.modes.len())
            .flat_map(move |index| leaving(index).map(move |departure| (index, departure)));
        let modes: Vec<_> = all
            .filter(|(_, (mode, _, transition, _))| {
                mode.model.is_first_order() && transition.map.is_none()
            })
            .collect();
        let mut pairs = Vec::new();
        for (from, (mode, surface, transition, place)) in &modes {
            let mut pool = mode.model.pool.clone();
            let opposite = pool.neg(surface.gap);
            let opposite = pool.text(opposite);
            pairs.extend(
                modes
                    .iter()
                    .filter_map(|(other, (target, back, returning, there))| {
                        let leads_back = *other == transition.enters && returning.enters == *from;
                        (leads_back && target.model.pool.text(back.gap) == opposite)
                            .then_some([*place, *there])
                    }),
            );
        }
        pairs.into_iter()
    }

    /// The surfaces of the entered mode with the gap of a transition that keeps the positions, as written, and with the
    /// negative of it.
    pub fn meets(&self, mode: &Mode, surface: &Surface) -> [Option<usize>; 2] {
        let Some(transition) = surface.transition.as_ref().filter(|to| to.map.is_none()) else {
            return [None; 2];
        };
        let mut pool = mode.model.pool.clone();
        let negative = pool.neg(surface.gap);
        let entered = &self.modes[transition.enters];
        [surface.gap, negative].map(|gap| {
            let gap = pool.text(gap);
            let mut others = entered.model.surfaces.iter().zip(&entered.places.surfaces);
            let met = others.find(|(other, _)| entered.model.pool.text(other.gap) == gap);
            met.map(|(_, place)| *place)
        })
    }
}

/// Checks every mode and the relations between modes.
///
/// # Errors
/// All mistakes, each at the smallest part of the declaration that is wrong.
pub fn check_modes(declared: &spec::Modes) -> Result<ModeGraph, Diagnostics> {
    let mut diagnostics = Diagnostics::new();
    check_names(declared, &mut diagnostics);
    check_reached(declared, &mut diagnostics);
    check_kind(declared, &mut diagnostics);
    let peers: Vec<Peer> = (declared.modes.iter())
        .map(|mode| peer(&mode.name.text, &mode.spec))
        .collect();
    let mut models = Vec::new();
    for mode in &declared.modes {
        match check_mode(&mode.spec, &peers, STEPS) {
            Ok(model) => models.push(model),
            Err(others) => diagnostics.extend_once(others),
        }
    }
    let mut models = diagnostics.finish(models)?;
    compare_lagrangians(&mut models);
    keep_common_notes(&mut models);
    let graph = joined(declared, models);
    check_topologies(declared, &graph)?;
    check_integrals(declared, &graph)?;
    check_surfaces(declared, &graph)?;
    Ok(graph)
}

/// Rejects names that are not valid as names of a type or a module.
fn check_names(declared: &spec::Modes, diagnostics: &mut Diagnostics) {
    const MODULES: [&str; 7] = [
        "coordinate",
        "constraint",
        "quasi_velocity",
        "surface",
        "output",
        "mode",
        spec::WHOLE,
    ];
    let parameters = declared.modes[0].spec.parameters.iter();
    for parameter in parameters.filter(|parameter| parameter.declared.name.text == "mode") {
        let text = "`mode` is the field that says where a run begins";
        let help = "choose another name";
        diagnostics
            .error(parameter.declared.name.at, text)
            .help(help);
    }
    for (index, mode) in declared.modes.iter().enumerate() {
        let (name, at) = (mode.name.text.as_str(), mode.name.at);
        let type_name = spec::camel_case(name);
        let is_word =
            type_name.starts_with(char::is_alphabetic) && !spec::is_rust_keyword(&type_name);
        if MODULES.contains(&name) {
            let text = format!("`{name}` cannot be the name of a mode");
            diagnostics.error(at, text).help("choose another name");
        } else if type_name == name || !is_word {
            let text = format!("`{name}` does not name a type and its module");
            let help =
                "write a mode in snake case, like `double_support`; its type is `DoubleSupport`";
            diagnostics.error(at, text).help(help);
        } else if let Some(other) = declared.modes[..index].iter().find(|other| {
            let other = spec::camel_case(&other.name.text);
            other == type_name
                || other == format!("{type_name}Global")
                || type_name == format!("{other}Global")
        }) {
            let text = format!(
                "modes `{}` and `{name}` name the same type",
                other.name.text
            );
            diagnostics.error(at, text).help("choose another name");
        }
    }
}

/// Rejects modes that no transition enters, and transitions whose source or target mode does not exist.
fn check_reached(declared: &spec::Modes, diagnostics: &mut Diagnostics) {
    let names: Vec<&str> = (declared.modes.iter())
        .map(|mode| mode.name.text.as_str())
        .collect();
    for (index, transition) in declared.transitions.iter().enumerate() {
        for word in [&transition.from, &transition.to] {
            if !names.contains(&word.text.as_str()) {
                let written: Vec<String> = (declared.modes.iter())
                    .map(|mode| mode.written.clone())
                    .collect();
                let help = spec::mode_help(&word.text, &written);
                let text = format!("unknown mode `{}`", word.text);
                diagnostics.error(word.at, text).help(help);
            }
        }
        if transition.from.text == transition.to.text {
            let text = format!(
                "`{}` leads back into the mode that it leaves",
                transition.name.text
            );
            let help = "write an impact of this mode: `impacts { name: h >= 0 => reset { .. }; }`";
            diagnostics.error(transition.to.at, text).help(help);
        }
        // Transitions that leave the same mode are compared with the other surfaces of that mode.
        let is_same = |other: &spec::Transition| {
            other.name.text == transition.name.text && other.from.text != transition.from.text
        };
        let is_first = !declared.transitions[..index].iter().any(is_same);
        if !is_first {
            let text = format!("transition `{}` declared again", transition.name.text);
            diagnostics
                .error(transition.name.at, text)
                .help("choose another name");
        }
    }
    if !diagnostics.is_empty() {
        return;
    }
    let mut reached = vec![names.first().copied().unwrap_or_default()];
    let mut next = 0;
    while next < reached.len() {
        for transition in &declared.transitions {
            let to = transition.to.text.as_str();
            if transition.from.text == reached[next] && !reached.contains(&to) {
                reached.push(to);
            }
        }
        next += 1;
    }
    for mode in &declared.modes {
        if !reached.contains(&mode.name.text.as_str()) {
            let text = format!("mode `{}` is never entered", mode.written);
            let help = format!(
                "write a transition that leads to it, as `name: {} -> {} when x >= 0;`, or leave it out",
                declared.modes[0].written, mode.written
            );
            diagnostics.error(mode.name.at, text).help(help);
        }
    }
}

/// Rejects a mixture of mechanical and first-order modes: a run has an energy in all modes or in none.
fn check_kind(declared: &spec::Modes, diagnostics: &mut Diagnostics) {
    let is_first_order = |mode: &&spec::Mode| mode.spec.field.is_some();
    let first = declared.modes.iter().find(is_first_order);
    let other = declared.modes.iter().find(|mode| !is_first_order(mode));
    if let (Some(first), Some(other)) = (first, other) {
        let text = format!(
            "`{}` is a first-order system and `{}` is not",
            first.name.text, other.name.text
        );
        let help = "declare a `lagrangian` in all modes, or a `field` in all of them";
        diagnostics.error(first.name.at, text).help(help);
    }
}

/// Marks the transitions between modes with the same Lagrangian.
fn compare_lagrangians(models: &mut [Model]) {
    let texts: Vec<Vec<String>> = models.iter().map(lagrangian_text).collect();
    for (index, model) in models.iter_mut().enumerate() {
        for surface in &mut model.surfaces {
            if let Some(transition) = &mut surface.transition {
                transition.keeps_lagrangian = texts[index] == texts[transition.enters];
            }
        }
    }
}

/// Metric, velocity-linear terms and potential as text. Expressions are kept in a canonical order, so equal texts are
/// equal functions. Equal functions that are written differently may have different texts.
fn lagrangian_text(model: &Model) -> Vec<String> {
    let lagrangian = &model.lagrangian;
    let parts = lagrangian.metric.iter().flatten().chain(&lagrangian.linear);
    let text = |pool: &Pool, expr| pool.text(expr);
    parts
        .chain([&lagrangian.potential])
        .map(|expr| text(&model.pool, *expr))
        .collect()
}

/// Removes notes on unused parameters, unless the parameter is unused in all modes.
fn keep_common_notes(models: &mut [Model]) {
    let unused = |note: &String| note.ends_with("is not used");
    let lists: Vec<Vec<String>> = models.iter().map(|model| model.notes.clone()).collect();
    for model in models {
        model
            .notes
            .retain(|note| !unused(note) || lists.iter().all(|notes| notes.contains(note)));
    }
}

/// The model as a whole: the lists of all modes, joined.
fn joined(declared: &spec::Modes, models: Vec<Model>) -> ModeGraph {
    let mut graph = ModeGraph {
        modes: Vec::new(),
        coordinates: Vec::new(),
        constraints: Vec::new(),
        frame: Vec::new(),
        surfaces: Vec::new(),
        outputs: Vec::new(),
        forces: Vec::new(),
    };
    for (index, (written, model)) in declared.modes.iter().zip(models).enumerate() {
        macro_rules! placed {
            ($list:ident) => {{
                let entries = model
                    .$list
                    .iter()
                    .map(|entry| (&entry.name, entry.documentation.as_slice()));
                place(&mut graph.$list, index, entries)
            }};
        }
        let places = Places {
            coordinates: placed!(coordinates),
            constraints: placed!(constraints),
            surfaces: placed!(surfaces),
            outputs: placed!(outputs),
        };
        placed!(frame);
        let forces = model
            .forces
            .iter()
            .map(|force| (&force.name, [].as_slice()));
        place(&mut graph.forces, index, forces);
        let scene = Scene {
            name: written.name.text.clone(),
            type_name: spec::camel_case(&written.name.text),
            documentation: written.documentation.clone(),
            parts: Parts {
                extras: Extras::ALL,
                ..Parts::default()
            },
            item: model.lagrangian.item,
        };
        graph.modes.push(Mode {
            scene,
            model,
            places,
        });
    }
    graph
}

/// Adds the new entries of a mode to a list. Returns the indices of all its entries in the list.
fn place<'e>(
    list: &mut Vec<Entry>,
    mode: usize,
    entries: impl Iterator<Item = (&'e Name, &'e [String])>,
) -> Vec<usize> {
    let mut places = Vec::new();
    for (place, (name, documentation)) in entries.enumerate() {
        let known = list.iter().position(|entry| entry.name == *name);
        places.push(known.unwrap_or_else(|| {
            list.push(Entry {
                name: name.clone(),
                documentation: documentation.to_vec(),
                mode,
                place,
            });
            list.len() - 1
        }));
    }
    places
}

/// Rejects a coordinate whose topology differs between modes.
fn check_topologies(declared: &spec::Modes, graph: &ModeGraph) -> Result<(), Diagnostics> {
    let mut diagnostics = Diagnostics::new();
    let kind = |model: &Model, coordinate: &Coordinate| match coordinate.topology {
        Topology::Line => "a line".to_owned(),
        Topology::Angle => "an angle".to_owned(),
        Topology::Interval { low, high } => {
            format!("in ({}, {})", model.pool.text(low), model.pool.text(high))
        }
    };
    for (mode, written) in graph.modes.iter().zip(&declared.modes) {
        for (coordinate, place) in mode.model.coordinates.iter().zip(&mode.places.coordinates) {
            let entry = &graph.coordinates[*place];
            let other = &graph.modes[entry.mode];
            let first = kind(&other.model, &other.model.coordinates[entry.place]);
            let second = kind(&mode.model, coordinate);
            if first != second {
                let text = format!(
                    "`{}` is {second} here and {first} in `{}`",
                    coordinate.name.display, other.scene.name
                );
                let at = written.spec.location(coordinate.item);
                diagnostics.error(at, text).help("choose another name");
            }
        }
    }
    diagnostics.finish(())
}

/// Rejects an integral that is an ordinary output in another mode, or that a mode lacks.
fn check_integrals(declared: &spec::Modes, graph: &ModeGraph) -> Result<(), Diagnostics> {
    let mut diagnostics = Diagnostics::new();
    for (place, entry) in graph.outputs.iter().enumerate() {
        let of = |mode: &Mode| -> Option<bool> {
            let index = mode
                .places
                .outputs
                .iter()
                .position(|known| *known == place)?;
            Some(mode.model.outputs[index].is_integral)
        };
        if !graph.modes.iter().any(|mode| of(mode) == Some(true)) {
            continue;
        }
        let Some(other) = graph.modes.iter().find(|mode| of(mode) != Some(true)) else {
            continue;
        };
        let name = &entry.name.display;
        let (text, help) = match of(other) {
            Some(_) => (
                format!(
                    "`{name}` is an integral in some modes and a value in `{}`",
                    other.scene.name
                ),
                "choose another name".to_owned(),
            ),
            None => (
                format!(
                    "`{name}` is an integral, and the mode `{}` lacks it",
                    other.scene.name
                ),
                format!("write `outputs {{ {name}: integral(0); }}` there"),
            ),
        };
        let item = graph.modes[entry.mode].model.outputs[entry.place].item;
        let at = declared.modes[entry.mode].spec.location(item);
        diagnostics.error(at, text).help(help);
    }
    diagnostics.finish(())
}

/// Rejects surfaces of the same name that differ between modes, because events and laws refer to surfaces by name.
fn check_surfaces(declared: &spec::Modes, graph: &ModeGraph) -> Result<(), Diagnostics> {
    let mut diagnostics = Diagnostics::new();
    let text = |model: &Model, surface: usize| {
        let declared = &model.surfaces[surface];
        let conditions = declared.conditions.iter();
        let conditions: Vec<(String, bool)> = conditions
            .map(|condition| (model.pool.text(condition.margin), condition.is_closed))
            .collect();
        let is_otherwise = matches!(declared.beside, Beside::Otherwise(_));
        (
            model.pool.text(declared.gap),
            (conditions, is_otherwise),
            model.law_text(surface),
        )
    };
    for (mode, written) in graph.modes.iter().zip(&declared.modes) {
        for (surface, place) in mode.places.surfaces.iter().enumerate() {
            let entry = &graph.surfaces[*place];
            let other = &graph.modes[entry.mode];
            if text(&mode.model, surface) != text(&other.model, entry.place) {
                let declared = &mode.model.surfaces[surface];
                let name = &declared.name.display;
                let text = format!(
                    "the surface `{name}` differs from the one in `{}`",
                    other.scene.name
                );
                let at = written.spec.location(declared.item);
                diagnostics.error(at, text).help("choose another name");
            }
        }
    }
    diagnostics.finish(())
}
