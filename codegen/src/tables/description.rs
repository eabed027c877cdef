//! Self-description of a model.

use dalembert_expr::ExprId;
use dalembert_numbers::Held;
use dalembert_numbers::description::{
    self, ConstraintInfo, CoordinateInfo, Description, Documentation, ParameterInfo, Quantity,
    SurfaceInfo, ViewInfo,
};
use dalembert_numbers::kernel::Shape;

use super::{FormOf, constant, default_value, name, names, table, text};
use crate::model::{Assumption, Constraint, Coordinate, Model, Output, Topology};
use crate::program::recipes::geometry;
use crate::spec::WHOLE;

/// The names of the inputs.
pub(super) fn inputs(model: &Model) -> Held<[&'static str]> {
    names(model.inputs().map(|(_, input)| input.name.display.as_str()))
}

impl FormOf<'_> {
    /// The self-description.
    pub fn documentation(&self) -> Documentation {
        let model = self.model;
        let quantities = self.program.geometry.groups.iter();
        let [placed, named] = [&model.initial.q, &model.initial.qdot].map(|values| marks(values));
        Documentation {
            description: self.description(),
            inputs: inputs(model),
            placed,
            named,
            geometry: table(quantities.map(|group| Quantity {
                name: name(&group.name),
                shape: match group.shape {
                    geometry::Shape::Scalar => Shape::Scalar,
                    geometry::Shape::Vector(count) => Shape::Vector(count),
                    geometry::Shape::Matrix(rows, columns) => Shape::Matrix(rows, columns),
                },
            })),
        }
    }

    fn description(&self) -> Description {
        let model = self.model;
        let coordinates = model.coordinates.iter();
        let quasi = match self.frame {
            Some(_) => self.quasi_names(),
            None => Vec::new(),
        };
        let scenes = self.scenes.iter().map(|scene| scene.name.as_str());
        let places: Vec<usize> = (0..model.coordinates.len()).collect();
        Description {
            coordinates: table(coordinates.map(|declared| coordinate(model, declared))),
            constraints: table(constraints(model)),
            forces: names(model.forces.iter().map(|force| force.name.display.as_str())),
            quasi_velocities: names(quasi.iter().map(String::as_str)),
            surfaces: table((0..model.surfaces.len()).map(|index| surface(model, index))),
            outputs: names(
                model
                    .outputs
                    .iter()
                    .map(|output| output.name.display.as_str()),
            ),
            integrals: integrals(model.outputs.iter()),
            scenes: names(core::iter::once(WHOLE).chain(scenes)),
            view: view(model, &places),
            ..of_model(model)
        }
    }
}

/// The description of a model with only its name, its text and its parameters.
pub(super) fn of_model(model: &Model) -> Description {
    Description {
        type_name: name(&model.name),
        name: name(&model.snake_name),
        documentation: text(text_of(&model.documentation)),
        source: text(model.source.as_str()),
        is_first_order: model.is_first_order(),
        coordinates: Held::Static(&[]),
        parameters: parameters(model),
        constraints: Held::Static(&[]),
        forces: Held::Static(&[]),
        quasi_velocities: Held::Static(&[]),
        surfaces: Held::Static(&[]),
        outputs: Held::Static(&[]),
        integrals: Held::Static(&[]),
        scenes: Held::Static(&[]),
        modes: Held::Static(&[]),
        view: None,
    }
}

/// The outputs that are integrals, by index.
pub(super) fn integrals<'m>(outputs: impl Iterator<Item = &'m Output>) -> Held<[usize]> {
    let integrals = outputs.enumerate().filter(|(_, output)| output.is_integral);
    table(integrals.map(|(index, _)| index))
}

/// The lines of a doc comment as a text.
pub fn text_of(documentation: &[String]) -> String {
    let lines: Vec<&str> = documentation.iter().map(|line| line.trim()).collect();
    lines.join("\n")
}

/// For each value, true if it was declared.
fn marks(values: &[Option<ExprId>]) -> Held<[bool]> {
    table(values.iter().map(Option::is_some))
}

pub(super) fn parameters(model: &Model) -> Held<[ParameterInfo]> {
    let declared = model
        .parameters
        .iter()
        .filter(|parameter| !parameter.is_input);
    table(declared.map(|parameter| ParameterInfo {
        name: name(&parameter.name.display),
        assumption: match &parameter.assumption {
            Assumption::Finite => description::Assumption::Finite,
            Assumption::Positive => description::Assumption::Positive,
            Assumption::NonNegative => description::Assumption::NonNegative,
            Assumption::NonZero => description::Assumption::NonZero,
            Assumption::Within { low, high } => description::Assumption::Within {
                low: low.to_f64(),
                high: high.to_f64(),
            },
        },
        default: default_value(model, parameter),
    }))
}

pub(super) fn coordinate(model: &Model, declared: &Coordinate) -> CoordinateInfo {
    CoordinateInfo {
        name: name(&declared.name.display),
        topology: match declared.topology {
            Topology::Line => description::Topology::Line,
            Topology::Angle => description::Topology::Circle,
            Topology::Interval { low, high } => description::Topology::Interval {
                low: constant(model, low),
                high: constant(model, high),
            },
        },
    }
}

fn constraints(model: &Model) -> impl Iterator<Item = ConstraintInfo> {
    let mut levels = 0;
    model.constraints.iter().map(move |declared| {
        let level = declared.level.map(|_| levels);
        levels += usize::from(level.is_some());
        constraint(model, declared, level)
    })
}

/// Description of a constraint, with the index of its level.
pub(super) fn constraint(
    model: &Model,
    declared: &Constraint,
    level: Option<usize>,
) -> ConstraintInfo {
    ConstraintInfo {
        name: name(&declared.name.display),
        affine: declared.nonlinear.is_none() && !model.pool.is_syntactic_zero(declared.affine),
        level,
    }
}

pub(super) fn surface(model: &Model, index: usize) -> SurfaceInfo {
    SurfaceInfo {
        name: name(&model.surfaces[index].name.display),
        law: text(model.law_text(index)),
    }
}

/// Description of the view; `places` are the indices of the coordinates in the description.
pub(super) fn view(model: &Model, places: &[usize]) -> Option<ViewInfo> {
    let view = model.view.as_ref()?;
    Some(ViewInfo {
        labels: view.labels.each_ref().map(|label| text(label.as_str())),
        plane: view
            .plane
            .map(|plane| plane.map(|coordinate| places[coordinate])),
        region: view.region.is_some(),
    })
}
