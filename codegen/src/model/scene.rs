//! Scenes: parts of a model that are models of their own.

use super::{Claim, Model};
use crate::diagnostics::listed;
use crate::spec::ItemId;

/// A declared scene, with the parts of the model that it uses.
#[derive(Debug, Clone)]
pub struct Scene {
    /// Name of the scene and of its module of indices: `with_drag`.
    pub name: String,
    /// The name of its type: `WithDrag`.
    pub type_name: String,
    /// Lines of its doc comment.
    pub documentation: Vec<String>,
    /// Forces, surfaces and extras in use.
    pub parts: Parts,
    /// Place of the declaration.
    pub item: ItemId,
}

/// Forces, surfaces and extras of a scene. Indices are in order of declaration.
#[derive(Debug, Clone, Default, PartialEq, Eq)]
pub struct Parts {
    /// The forces.
    pub forces: Vec<usize>,
    /// The surfaces.
    pub surfaces: Vec<usize>,
    /// Extras.
    pub extras: Extras,
}

/// Optional parts of the generated code besides forces and surfaces. The model itself has all that are defined for it:
/// a first-order system only `variations`, a model with a nonlinear constraint no `volume`.
#[derive(Debug, Clone, Copy, Default, PartialEq, Eq)]
pub struct Extras {
    /// The projection onto the constraints after steps.
    pub projection: bool,
    /// Density form, divergence, and the invariant volume that a claim proves.
    pub volume: bool,
    /// States, gaps and transitions in any number type, for first variations.
    pub variations: bool,
}

impl Extras {
    /// All extras.
    pub const ALL: Self = Self {
        projection: true,
        volume: true,
        variations: true,
    };
}

impl Model {
    /// The model of the scene with this index: its forces, surfaces and extras, and the claims about it.
    pub fn in_scene(&self, index: usize) -> Self {
        let scene = &self.scenes[index];
        let Parts {
            forces,
            surfaces,
            extras,
        } = &scene.parts;
        let claims = self
            .claims
            .iter()
            .filter(|claim| claim.scene == Some(index));
        Self {
            documentation: scene.documentation.clone(),
            forces: forces
                .iter()
                .map(|force| self.forces[*force].clone())
                .collect(),
            surfaces: surfaces
                .iter()
                .map(|surface| self.surfaces[*surface].clone())
                .collect(),
            claims: claims.map(|claim| claim.on_surfaces(surfaces)).collect(),
            scenes: Vec::new(),
            extras: *extras,
            notes: Vec::new(),
            ..self.clone()
        }
    }

    /// A text that lists forces, surfaces and extras of a scene: `motion with drag and floor`.
    pub fn used(&self, parts: &Parts) -> String {
        let forces = parts.forces.iter().map(|force| &self.forces[*force].name);
        let surfaces = parts
            .surfaces
            .iter()
            .map(|surface| &self.surfaces[*surface].name);
        let names = forces.chain(surfaces).map(|name| name.display.as_str());
        let Extras {
            projection,
            volume,
            variations,
        } = parts.extras;
        let extras = [
            projection.then_some("projection"),
            volume.then_some("volume"),
            variations.then_some("variations"),
        ];
        let extras = extras.into_iter().flatten();
        match listed(names.chain(extras)) {
            none if none.is_empty() => "motion alone".to_owned(),
            words => format!("motion with {words}"),
        }
    }

    /// The claims about the model itself.
    pub fn own_claims(&self) -> Vec<Claim> {
        let claims = self.claims.iter().filter(|claim| claim.scene.is_none());
        claims.cloned().collect()
    }
}

impl Claim {
    /// The claim about a scene as a claim about the model of that scene, which keeps these surfaces. The claim names no
    /// other surface.
    fn on_surfaces(&self, surfaces: &[usize]) -> Self {
        let mut claim = self.clone();
        claim.scene = None;
        if let Some(surface) = claim.statement.surface() {
            let place = surfaces.iter().position(|kept| *kept == surface);
            claim.statement = claim.statement.at_surface(place.unwrap_or(surface));
        }
        claim
    }
}
