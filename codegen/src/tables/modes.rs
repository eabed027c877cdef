//! Data of a model with modes: lengths of vectors, and indices of each mode's quantities among those of the model.

use dalembert_numbers::Held;
use dalembert_numbers::description::{Description, Documentation, ModeInfo};
use dalembert_numbers::tables::{Dimensions, Form, Mode, Passage, Tables, Transition, Work};

use super::{FormOf, description, name, names, table};
use crate::model::{self, ModeGraph, Model};
use crate::spec::WHOLE;

/// A model with modes.
#[derive(Debug)]
pub struct Whole<'a> {
    /// The declaration.
    pub graph: &'a ModeGraph,
    /// Forms of each mode: first its own, then the global form if that is a different one.
    pub forms: Vec<Vec<FormOf<'a>>>,
}

impl<'a> Whole<'a> {
    /// The model of the first mode. Names and parameters of the whole are those of this model.
    pub fn model(&self) -> &Model {
        &self.graph.modes[0].model
    }

    /// The modes' own forms, in order.
    pub fn modes(&self) -> impl Iterator<Item = &FormOf<'a>> {
        self.forms.iter().map(|forms| &forms[0])
    }

    fn longest(&self, length: impl Fn(&FormOf<'a>) -> usize) -> usize {
        self.modes().map(length).max().unwrap_or(0)
    }

    /// Sizes of the vectors, large enough for all modes.
    pub fn dimensions(&self) -> Dimensions {
        Dimensions {
            // The last component of the state is the index of the mode.
            state: self.longest(FormOf::state_dimension) + 1,
            coordinates: self.graph.coordinates.len(),
            motion: self.longest(FormOf::motion_dimension),
            constraints: self.longest(|mode| mode.model.constraints.len()),
            levels: self.longest(FormOf::levels),
            surfaces: self.graph.surfaces.len(),
            parameters: self.model().parameters.len(),
        }
    }

    /// Largest number of outputs of a kernel with several outputs.
    pub fn room(&self) -> usize {
        let rooms = self.forms.iter().flatten().map(FormOf::room);
        let others = [2 * self.graph.coordinates.len(), self.graph.outputs.len()];
        rooms.chain(others).max().unwrap_or(0)
    }

    /// Number of gaps with a series: all of them, or 0 if a gap of one mode has no series.
    pub fn series_gaps(&self) -> usize {
        let mut modes = self.modes();
        let have_series = modes.all(|mode| mode.series_gaps() == mode.model.surfaces.len());
        match have_series {
            true => self.graph.surfaces.len(),
            false => 0,
        }
    }

    /// Work of expansions of the motion: the largest over all modes.
    pub fn work(&self) -> Option<Work> {
        self.modes().map(FormOf::work).reduce(Work::most)
    }

    /// Tables of the whole model.
    pub fn tables(&self) -> Tables {
        let of_modes: Vec<Tables> = self.modes().map(FormOf::tables).collect();
        let surfaces = self.graph.surfaces.iter();
        Tables {
            form: match self.graph.is_first_order() {
                true => Form::FirstOrder,
                false => Form::Global,
            },
            dimensions: self.dimensions(),
            parameters: description::parameters(self.model()),
            charts: Held::Static(&[]),
            conserves_energy: false,
            can_be_narrow: of_modes.iter().any(|mode| mode.can_be_narrow),
            can_lose_rank: of_modes.iter().any(|mode| mode.can_lose_rank),
            depends_on_time: of_modes.iter().any(|mode| mode.depends_on_time),
            drifts: of_modes.iter().any(|mode| mode.drifts),
            is_linear: of_modes.iter().all(|mode| mode.is_linear),
            varies: true,
            levels: Held::Static(&[]),
            surfaces: table(surfaces.map(|entry| self.forms[entry.mode][0].surface(entry.place))),
            density_reference: None,
            modes: table(self.tables_of_modes(of_modes)),
        }
    }

    fn tables_of_modes(&self, tables: Vec<Tables>) -> impl Iterator<Item = Mode> {
        let mut kernels = 0;
        let modes = self.graph.modes.iter().zip(&self.forms).zip(tables);
        modes.map(move |((mode, forms), tables)| {
            let first = kernels;
            kernels += forms.len();
            let places = &mode.places;
            let list = |places: &[usize]| table(places.iter().copied());
            Mode {
                tables: Held::Owned(Box::new(tables)),
                documentation: Held::Owned(Box::new(forms[0].documentation())),
                kernels: first,
                global: kernels - 1,
                coordinates: list(&places.coordinates),
                constraints: list(&places.constraints),
                surfaces: list(&places.surfaces),
                outputs: list(&places.outputs),
                transitions: table(transitions(self.graph, mode)),
            }
        })
    }

    /// Self-description of the whole model.
    pub fn documentation(&self) -> Documentation {
        Documentation {
            description: self.description(),
            inputs: description::inputs(&self.graph.modes[0].model),
            placed: Held::Static(&[]),
            named: Held::Static(&[]),
            geometry: Held::Static(&[]),
        }
    }

    fn description(&self) -> Description {
        let graph = self.graph;
        let model_of = |entry: &model::Entry| &graph.modes[entry.mode].model;
        let coordinates = graph.coordinates.iter().map(|entry| {
            let model = model_of(entry);
            description::coordinate(model, &model.coordinates[entry.place])
        });
        let constraints = graph.constraints.iter().map(|entry| {
            let model = model_of(entry);
            description::constraint(model, &model.constraints[entry.place], None)
        });
        let surfaces = graph.surfaces.iter();
        let surfaces = surfaces.map(|entry| description::surface(model_of(entry), entry.place));
        let scenes = graph.modes.iter().map(|mode| mode.scene.name.as_str());
        let modes = graph.modes.iter().map(|mode| ModeInfo {
            name: name(&mode.scene.name),
            coordinates: table(mode.places.coordinates.iter().copied()),
        });
        Description {
            is_first_order: graph.is_first_order(),
            coordinates: table(coordinates),
            constraints: table(constraints),
            forces: names(graph.forces.iter().map(|entry| entry.name.display.as_str())),
            surfaces: table(surfaces),
            outputs: names(
                graph
                    .outputs
                    .iter()
                    .map(|entry| entry.name.display.as_str()),
            ),
            integrals: description::integrals(
                (graph.outputs.iter()).map(|entry| &model_of(entry).outputs[entry.place]),
            ),
            scenes: names(core::iter::once(WHOLE).chain(scenes)),
            modes: table(modes),
            view: description::view(self.model(), &graph.modes[0].places.coordinates),
            ..description::of_model(self.model())
        }
    }
}

/// The transition of each surface of a mode.
fn transitions(graph: &ModeGraph, mode: &model::Mode) -> Vec<Option<Transition>> {
    let opposites: Vec<[usize; 2]> = graph.opposites().collect();
    let surfaces = mode.model.surfaces.iter().zip(&mode.places.surfaces);
    let leads_to = |(surface, place): (&model::Surface, &usize)| {
        let transition = surface.transition.as_ref()?;
        let opposite = opposites.iter().find(|[surface, _]| surface == place);
        Some(Transition {
            enters: transition.enters,
            passage: passage(transition, mode.model.is_first_order()),
            has_no_side: transition.has_no_side,
            opposite: opposite.map(|[_, back]| *back),
            meets: graph.meets(mode, surface),
        })
    };
    surfaces.map(leads_to).collect()
}

fn passage(transition: &model::Transition, is_first_order: bool) -> Passage {
    match (transition.map.is_some(), transition.keeps_lagrangian) {
        (true, _) => Passage::Declared,
        (false, _) if is_first_order => Passage::Kept,
        (false, true) => Passage::Focused,
        (false, false) => Passage::Refracted,
    }
}
