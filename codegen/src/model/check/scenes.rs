//! Scenes: the declarations that each of them uses, and the names of their types.

use super::super::resolve::Resolver;
use super::super::{Extras, Force, Name, Parts, Scene, Surface};
use crate::diagnostics::{Location, listed};
use crate::spec::{self, Declared, EXTRAS, SCENES, WHOLE};

/// Modules of indices. The module of a scene is next to them and must have another name.
const MODULES: [&str; 5] = [
    "coordinate",
    "constraint",
    "quasi_velocity",
    "surface",
    "output",
];

/// Declarations that a scene may name.
struct Material<'m> {
    forces: &'m [Force],
    surfaces: &'m [Surface],
    scenes: Vec<Scene>,
}

/// All scenes. A scene may only name earlier declarations.
pub(super) fn resolve(
    resolver: &mut Resolver<'_>,
    forces: &[Force],
    surfaces: &[Surface],
) -> Vec<Scene> {
    let spec = resolver.spec;
    // A refused force or surface is missing here. Scenes that name it are not reported as well.
    let is_complete = resolver.diagnostics.is_empty();
    let mut material = Material {
        forces,
        surfaces,
        scenes: Vec::new(),
    };
    for scene in &spec.scenes {
        if material.scenes.len() == SCENES {
            let text = format!("more than {SCENES} scenes");
            resolver.refuse::<()>(scene.name.at, text, "split the model");
            break;
        }
        let has_name = resolver.check_scene_name(scene, &material);
        let mut parts = Parts::default();
        for part in &scene.parts {
            if is_complete {
                resolver.scene_part(part, &material, &mut parts);
            }
        }
        if has_name {
            material.scenes.push(Scene {
                name: scene.name.text.clone(),
                type_name: spec::camel_case(&scene.name.text),
                documentation: scene.documentation.clone(),
                parts,
                item: scene.item,
            });
        }
    }
    material.scenes
}

/// True if two scenes share a type name, including the names of their global forms.
fn share_a_type(a: &str, b: &str) -> bool {
    a == b || *a == format!("{b}Global") || *b == format!("{a}Global")
}

impl Resolver<'_> {
    /// True if a scene may have its name; reports an error otherwise.
    fn check_scene_name(&mut self, scene: &spec::Scene, material: &Material<'_>) -> bool {
        let (name, at) = (scene.name.text.as_str(), scene.name.at);
        let type_name = spec::camel_case(name);
        if name == WHOLE {
            let text = format!("`{WHOLE}` is the model itself");
            let help = "leave it out: the model's type uses everything that is declared";
            return self.refuse::<()>(at, text, help).is_some();
        }
        if MODULES.contains(&name) {
            let text = format!("`{name}` is the module of indices next to which a scene stands");
            return self.refuse::<()>(at, text, "choose another name").is_some();
        }
        let is_word = type_name.starts_with(|c: char| c.is_alphabetic())
            && !spec::is_rust_keyword(&type_name);
        if type_name == name || !is_word {
            let text = format!("`{name}` does not name a type and its module");
            let help = "write a scene in snake case, like `with_drag`; its type is `WithDrag`";
            return self.refuse::<()>(at, text, help).is_some();
        }
        let spec = self.spec;
        let taken = material
            .scenes
            .iter()
            .find(|other| share_a_type(&other.type_name, &type_name));
        if let Some(other) = taken {
            let text = match other.name == name {
                true => format!("scene `{name}` declared again"),
                false => format!("scenes `{name}` and `{}` name the same type", other.name),
            };
            let error = self.diagnostics.error(at, text);
            let first = format!("`{}` first declared here", other.name);
            error
                .help("choose another name")
                .also(spec.location(other.item), first);
            return false;
        }
        true
    }

    /// Adds the declarations that a part of a scene names.
    fn scene_part(&mut self, part: &Declared, material: &Material<'_>, parts: &mut Parts) {
        let field = part.name.text.as_str();
        let members: Vec<String> = match part.index {
            None => Vec::new(),
            Some(_) => {
                let members = self.members(part).into_iter();
                members.map(|(name, _)| name.display).collect()
            }
        };
        // A family without an index means all its members.
        let names = |name: &Name| match part.index {
            None => name.field == field,
            Some(_) => members.contains(&name.display),
        };
        let forces = places(material.forces.iter().map(|force| names(&force.name)));
        let surfaces = places(material.surfaces.iter().map(|surface| names(&surface.name)));
        let scene = material
            .scenes
            .iter()
            .find(|scene| part.index.is_none() && scene.name == field);
        let extra = EXTRAS
            .iter()
            .find(|extra| part.index.is_none() && **extra == field);
        let kinds = [
            (!forces.is_empty()).then_some("a force"),
            (!surfaces.is_empty()).then_some("a surface"),
            scene.map(|_| "a scene"),
            extra.map(|_| "an extra"),
        ];
        let kinds: Vec<&str> = kinds.into_iter().flatten().collect();
        match kinds.as_slice() {
            [] => self.refuse_scene_part(part, material),
            [_] => {}
            several => {
                let text = format!("`{field}` names {}", several.join(" and "));
                self.refuse::<()>(part.name.at, text, "rename one of them");
            }
        }
        parts.add(&Parts {
            forces,
            surfaces,
            extras: Extras {
                projection: extra == Some(&"projection"),
                volume: extra == Some(&"volume"),
                variations: extra == Some(&"variations"),
            },
        });
        if let Some(scene) = scene {
            parts.add(&scene.parts);
        }
    }

    /// Reports a name that a scene cannot use.
    fn refuse_scene_part(&mut self, part: &Declared, material: &Material<'_>) {
        let field = part.name.text.as_str();
        let at: Location = part.name.at;
        let is_later = self
            .spec
            .scenes
            .iter()
            .any(|scene| scene.name.text == field);
        if is_later && part.index.is_none() {
            let text = format!("scene `{field}` is not declared before it is used");
            self.refuse::<()>(
                at,
                text,
                "declare scenes in the order in which they build on each other",
            );
            return;
        }
        let forces = material.forces.iter().map(|force| &force.name);
        let surfaces = material.surfaces.iter().map(|surface| &surface.name);
        let mut known: Vec<&str> = Vec::new();
        let scenes = material.scenes.iter().map(|scene| scene.name.as_str());
        let names = forces.chain(surfaces).map(|force| force.field.as_str());
        for name in names.chain(scenes).chain(EXTRAS) {
            if !known.contains(&name) {
                known.push(name);
            }
        }
        let written = match &part.index {
            Some(_) => format!("{field}[..]"),
            None => field.to_owned(),
        };
        let text = format!("`{written}` is nothing that a scene can use");
        let help = match crate::diagnostics::nearest(field, known.iter().copied()) {
            Some(near) if near != field => format!("did you mean `{near}`?"),
            _ => format!("a scene uses {}", listed(known)),
        };
        self.refuse::<()>(at, text, &help);
    }
}

/// Positions of true entries.
fn places(marks: impl Iterator<Item = bool>) -> Vec<usize> {
    let marks = marks.enumerate().filter(|(_, mark)| *mark);
    marks.map(|(place, _)| place).collect()
}

impl Parts {
    /// Adds the declarations and extras of another scene.
    fn add(&mut self, other: &Self) {
        for (indices, others) in [
            (&mut self.forces, &other.forces),
            (&mut self.surfaces, &other.surfaces),
        ] {
            indices.extend(others);
            indices.sort_unstable();
            indices.dedup();
        }
        self.extras.projection |= other.extras.projection;
        self.extras.volume |= other.extras.volume;
        self.extras.variations |= other.extras.variations;
    }
}
