//! Scenes: parts of a model that are models of their own.

use super::{Claim, Model};
use crate::diagnostics::listed;
use crate::spec::ItemId;

/// A declared scene: what of the model it uses.
#[derive(Debug, Clone)]
pub struct Scene {
    /// Its name, which is that of its module of indices: `with_drag`.
    pub name: String,
    /// The name of its type: `WithDrag`.
    pub type_name: String,
    /// Lines of its doc comment.
    pub documentation: Vec<String>,
    /// What it uses.
    pub parts: Parts,
    /// Where it was declared.
    pub item: ItemId,
}

/// What a scene uses: indices of forces and surfaces in order of declaration, and the extras.
#[derive(Debug, Clone, Default, PartialEq, Eq)]
pub struct Parts {
    /// The forces.
    pub forces: Vec<usize>,
    /// The surfaces.
    pub surfaces: Vec<usize>,
    /// What it uses besides.
    pub extras: Extras,
}

/// What a scene uses besides forces and surfaces. The model itself uses all of it.
#[derive(Debug, Clone, Copy, Default, PartialEq, Eq)]
pub struct Extras {
    /// The return to the constraints after steps.
    pub projection: bool,
    /// Density form, divergence, and the invariant volume that a claim proves.
    pub volume: bool,
    /// States, gaps and transitions over numbers, for first variations.
    pub variations: bool,
}

impl Extras {
    /// Those of the model itself.
    pub const ALL: Self = Self {
        projection: true,
        volume: true,
        variations: true,
    };
}

impl Model {
    /// The model with nothing but what the scene of this index uses: forces, surfaces, and the claims about it.
    pub fn in_scene(&self, index: usize) -> Self {
        let scene = &self.scenes[index];
        let Parts {
            forces,
            surfaces,
            extras,
        } = &scene.parts;
        let claims = self.claims.iter().filter(|own| own.scene == Some(index));
        Self {
            documentation: scene.documentation.clone(),
            forces: forces.iter().map(|own| self.forces[*own].clone()).collect(),
            surfaces: surfaces
                .iter()
                .map(|own| self.surfaces[*own].clone())
                .collect(),
            claims: claims.map(|own| own.on_surfaces(surfaces)).collect(),
            scenes: Vec::new(),
            extras: *extras,
            notes: Vec::new(),
            ..self.clone()
        }
    }

    /// What a scene uses, in words.
    pub fn used(&self, parts: &Parts) -> String {
        let forces = parts.forces.iter().map(|own| &self.forces[*own].name);
        let surfaces = parts.surfaces.iter().map(|own| &self.surfaces[*own].name);
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
        let own = self.claims.iter().filter(|own| own.scene.is_none());
        own.cloned().collect()
    }
}

impl Claim {
    /// The claim about a scene as one about the model that the scene is, of whose surfaces only these are left; it names
    /// no other.
    fn on_surfaces(&self, surfaces: &[usize]) -> Self {
        let mut claim = self.clone();
        claim.scene = None;
        if let Some(surface) = claim.statement.surface() {
            let place = surfaces.iter().position(|own| *own == surface);
            claim.statement = claim.statement.at_surface(place.unwrap_or(surface));
        }
        claim
    }
}
