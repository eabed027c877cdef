//! Resolves the declared claims. Later stages decide them.

use dalembert_expr::{Assumption as Known, ExprId, Node, Sign};

use super::super::resolve::{DerivedNames, Resolver, Scope};
use super::super::{Claim, Coordinate, Name, Scene, StatedFunction, Statement, Surface};
use crate::diagnostics::listed;
use crate::spec;

/// Resolves all claims, and refuses those that are stated twice.
pub(super) fn resolve(
    resolver: &mut Resolver<'_>,
    surfaces: &[Surface],
    scenes: &[Scene],
) -> Vec<Claim> {
    let spec = resolver.spec;
    resolver.derived_names = DerivedNames::Claims;
    let mut claims: Vec<Claim> = Vec::new();
    for claim in &spec.claims {
        let Some((statement, text)) = resolver.statement(&claim.statement, surfaces) else {
            continue;
        };
        let scene = match &claim.scene {
            None => None,
            Some(word) => {
                let found = resolver.scene(word, scenes).filter(|scene| {
                    resolver.check_surface_of(claim, &statement, &scenes[*scene], surfaces)
                });
                match found {
                    Some(scene) => Some(scene),
                    None => continue,
                }
            }
        };
        let is_same = |other: &&Claim| other.text == text && other.scene == scene;
        if let Some(first) = claims.iter().find(is_same) {
            let (at, first) = (spec.location(claim.item), spec.location(first.item));
            let error = resolver
                .diagnostics
                .error(at, format!("`{text}` claimed again"));
            error
                .help("keep one of the two")
                .also(first, "first claimed here");
            continue;
        }
        claims.push(Claim {
            statement,
            text,
            is_assumed: claim.is_assumed,
            scene,
            item: claim.item,
        });
    }
    claims
}

fn listed_as_written(functions: &[StatedFunction]) -> String {
    let texts: Vec<&str> = (functions.iter())
        .map(|function| function.written.as_str())
        .collect();
    texts.join(", ")
}

impl Resolver<'_> {
    /// The resolved statement, with its canonical text.
    fn statement(
        &mut self,
        written: &spec::Statement,
        surfaces: &[Surface],
    ) -> Option<(Statement, String)> {
        Some(match written {
            spec::Statement::Existence(existence) => {
                let word = match existence {
                    spec::Existence::Global => "exact",
                    spec::Existence::Local => "locally_exact",
                    spec::Existence::None => "none",
                };
                (Statement::Existence(*existence), format!("density: {word}"))
            }
            spec::Statement::Density(value) => {
                let expr = self.quantity(value)?;
                self.check_periodic(&[value], &Scope::default(), expr);
                if self.pool.is_syntactic_zero(expr) || self.pool.sign(expr).is_nonpositive() {
                    let text = format!("`{value}` is not positive anywhere");
                    return self.refuse(value.at, text, "a density is positive");
                }
                (Statement::Density(expr), format!("density = {value}"))
            }
            spec::Statement::Conserved {
                value,
                under,
                holds,
            } => self.conserved(value, under.as_ref(), *holds, surfaces)?,
            spec::Statement::Invariant(written) => {
                let form = self.invariant_form(written)?;
                (Statement::Invariant(form), format!("invariant: {written}"))
            }
            spec::Statement::Involution(written) => {
                let functions = self.functions(written)?;
                let text = format!("involution: {}", listed_as_written(&functions));
                (Statement::Involution(functions), text)
            }
            spec::Statement::Integrable(written) => self.integrable(written)?,
            spec::Statement::VolumeKept => (Statement::VolumeKept, "volume: kept".to_owned()),
            spec::Statement::Symplectic => (Statement::Symplectic, "symplectic".to_owned()),
            spec::Statement::Factor { under, value } => self.factor(under, value, surfaces)?,
            spec::Statement::EnergyNotIncreasing(under) => {
                let surface = self.surface(under, surfaces)?;
                let name = &surfaces[surface].name.display;
                let text = format!("energy under {name}: not increasing");
                (Statement::EnergyNotIncreasing(surface), text)
            }
            spec::Statement::Symmetry(field) => {
                let components = self.vector_field(field)?;
                (
                    Statement::Symmetry(components),
                    format!("symmetry: {field}"),
                )
            }
        })
    }

    fn conserved(
        &mut self,
        value: &spec::Scalar,
        under: Option<&spec::Declared>,
        holds: bool,
        surfaces: &[Surface],
    ) -> Option<(Statement, String)> {
        let expr = self.quantity(value)?;
        self.forbid_inputs(value, &Scope::default(), expr)?;
        self.check_periodic(&[value], &Scope::default(), expr);
        let (under, across) = match under {
            Some(declared) => {
                let surface = self.surface(declared, surfaces)?;
                let name = &surfaces[surface].name.display;
                self.check_known_behind(value, expr, &surfaces[surface])?;
                (Some(surface), format!(" under {name}"))
            }
            None => (None, String::new()),
        };
        let not = if holds { "" } else { "not " };
        let statement = Statement::Conserved {
            value: expr,
            under,
            holds,
        };
        Some((statement, format!("{not}conserved{across}: {value}")))
    }

    fn integrable(&mut self, written: &[spec::Scalar]) -> Option<(Statement, String)> {
        let functions = self.functions(written)?;
        for (value, function) in written.iter().zip(&functions) {
            self.check_periodic(&[value], &Scope::default(), function.value);
        }
        self.check_count(written)?;
        let text = format!("integrable: {}", listed_as_written(&functions));
        Some((Statement::Integrable(functions), text))
    }

    fn factor(
        &mut self,
        under: &spec::Declared,
        value: &spec::Scalar,
        surfaces: &[Surface],
    ) -> Option<(Statement, String)> {
        let expr = self.quantity(value)?;
        self.check_periodic(&[value], &Scope::default(), expr);
        let surface = self.surface(under, surfaces)?;
        let sign = self.pool.sign(expr);
        let is_negative = sign.is_nonpositive() && sign != Sign::Zero;
        if is_negative {
            let text = format!("`{value}` is not positive anywhere");
            return self.refuse(value.at, text, "volumes are counted without a sign");
        }
        let name = &surfaces[surface].name.display;
        let statement = Statement::Factor {
            value: expr,
            under: surface,
        };
        Some((statement, format!("density under {name}: factor = {value}")))
    }

    /// Refuses a quantity with a coordinate that the mode behind a transition does not have.
    fn check_known_behind(
        &mut self,
        value: &spec::Scalar,
        expr: ExprId,
        surface: &Surface,
    ) -> Option<()> {
        let Some(transition) = &surface.transition else {
            return Some(());
        };
        let peer = &self.modes[transition.enters];
        let is_unknown = |(i, coordinate): &(usize, &Coordinate)| {
            let momentum = self.symbols.derived.momenta.get(*i).copied();
            let symbols: Vec<_> = [coordinate.q, coordinate.qdot]
                .into_iter()
                .chain(momentum)
                .collect();
            self.pool.depends_on_any(expr, &symbols)
                && peer
                    .coordinates
                    .iter()
                    .all(|(name, _)| *name != coordinate.name)
        };
        let mut coordinates = self.symbols.coordinates.iter().enumerate();
        let Some((_, unknown)) = coordinates.find(is_unknown) else {
            return Some(());
        };
        let (name, mode) = (&unknown.name.display, &peer.name);
        let text = format!(
            "`{name}` is no coordinate of `{mode}`, which `{}` leads to",
            surface.name.display
        );
        let help = "claim a quantity that both modes have";
        self.refuse(value.at, text, help)
    }

    /// The functions of a claim about several functions. Their derivatives must be periodic.
    fn functions(&mut self, written: &[spec::Scalar]) -> Option<Vec<StatedFunction>> {
        let moving = [self.symbols.positions(), self.symbols.velocities()].concat();
        let values: Vec<Option<ExprId>> = (written.iter())
            .map(|value| {
                let expr = self.quantity(value)?;
                self.forbid_inputs(value, &Scope::default(), expr)?;
                self.check_periodic_derivatives(&[value], &Scope::default(), expr, &moving);
                Some(expr)
            })
            .collect();
        let values: Vec<ExprId> = values.into_iter().collect::<Option<_>>()?;
        for (index, value) in values.iter().enumerate() {
            if values[..index].contains(value) {
                let text = format!("`{}` twice", written[index]);
                let help = "a function has the bracket 0 with itself";
                return self.refuse(written[index].at, text, help);
            }
        }
        let stated = values.into_iter().zip(written);
        let stated = stated.map(|(value, written)| StatedFunction {
            value,
            written: written.to_string(),
        });
        Some(stated.collect())
    }

    /// Refuses more or fewer functions than D has dimensions.
    fn check_count(&mut self, written: &[spec::Scalar]) -> Option<()> {
        let coordinates = self.symbols.coordinates.len();
        let freedom = coordinates.checked_sub(self.multipliers.len())?;
        if written.len() == freedom {
            return Some(());
        }
        let at = written.get(freedom).or(written.last())?.at;
        let text = format!(
            "{} for {freedom} degrees of freedom",
            match written.len() {
                1 => "1 function".to_owned(),
                count => format!("{count} functions"),
            }
        );
        let help = "an integrable system has as many functions as degrees of freedom; `involution: ..;` takes any";
        self.refuse(at, text, help)
    }

    /// A function of time, positions and velocities.
    fn quantity(&mut self, written: &spec::Scalar) -> Option<ExprId> {
        let mut scope = Scope::default();
        let expr = self.expression(written, &mut scope)?;
        let differentials = self.symbols.all_differentials();
        let text = "a claim contains no differentials";
        let help = "velocities are written `dot(x)`";
        self.forbid(written, &scope, expr, &differentials, text, help)?;
        Some(expr)
    }

    /// The index of the scene of this name.
    fn scene(&mut self, word: &spec::Word, scenes: &[Scene]) -> Option<usize> {
        let found = scenes.iter().position(|scene| scene.name == word.text);
        found.or_else(|| {
            // A refused scene is missing here, and its error is reported already.
            if self
                .spec
                .scenes
                .iter()
                .any(|scene| scene.name.text == word.text)
            {
                return None;
            }
            let help = match scenes {
                [] if word.text == spec::WHOLE => "write `claims { .. }`".to_owned(),
                [] => "the model declares no scenes".to_owned(),
                _ => {
                    let names = scenes.iter().map(|scene| scene.name.as_str());
                    format!("the scenes are {}", listed(names))
                }
            };
            let text = format!("`{}` is not a scene", word.text);
            self.refuse(word.at, text, &help)
        })
    }

    /// True if the scene of a claim uses the surface that the claim names; reports an error otherwise.
    fn check_surface_of(
        &mut self,
        claim: &spec::Claim,
        statement: &Statement,
        scene: &Scene,
        surfaces: &[Surface],
    ) -> bool {
        let Some(surface) = statement.surface() else {
            return true;
        };
        if scene.parts.surfaces.contains(&surface) {
            return true;
        }
        let (scene, surface) = (&scene.name, &surfaces[surface].name.display);
        let text = format!("the scene `{scene}` does not use the surface `{surface}`");
        let help = format!("add `{surface}` to the scene, or leave the claim out");
        let at = self.spec.location(claim.item);
        self.refuse::<()>(at, text, &help).is_some()
    }

    /// The index of the surface of a declared name.
    fn surface(&mut self, declared: &spec::Declared, surfaces: &[Surface]) -> Option<usize> {
        let members: Vec<(Name, Scope)> = self.members(declared);
        let (name, _) = members.first()?;
        let display = &name.display;
        // The name of a member of a family of transitions ends with its number.
        let member = name.member.map(|member| format!("{}{member}", name.field));
        let is_member = |surface: &Surface| {
            surface.transition.is_some() && member.as_ref() == Some(&surface.name.display)
        };
        let mut all = surfaces.iter();
        let found = all.position(|surface| surface.name.display == *display || is_member(surface));
        if let Some(surface) = found.filter(|found| !surfaces[*found].law.goes_on()) {
            let name = &surfaces[surface].name.display;
            let text = format!("the motion ends at `{name}`: there is no state after it");
            return self.refuse(declared.name.at, text, "leave it out");
        }
        found.or_else(|| {
            let names: Vec<&str> = surfaces
                .iter()
                .map(|surface| surface.name.display.as_str())
                .collect();
            let help = match (self.modes.is_empty(), names.is_empty()) {
                (true, true) => "the model declares no surfaces".to_owned(),
                (true, false) => format!("the surfaces are {}", listed(names)),
                (false, _) => "a claim about a transition stands in the mode that it leaves: `modes { slow { claims { .. } } }`".to_owned(),
            };
            let text = format!("`{display}` is not a surface");
            self.refuse(declared.name.at, text, &help)
        })
    }

    /// The components of a field `sum of f_i partial(x_i)`.
    fn vector_field(&mut self, written: &spec::Scalar) -> Option<Vec<ExprId>> {
        let partials: Vec<_> = self
            .symbols
            .coordinates
            .iter()
            .map(|coordinate| format!("partial({})", coordinate.name.display))
            .collect();
        let partials: Vec<_> = partials
            .iter()
            .map(|name| self.pool.symbol(name, name, Known::None))
            .collect();
        self.partials.clone_from(&partials);
        let resolved = self.quantity(written);
        self.partials.clear();
        let field = resolved?;
        let mut rest = field;
        let mut components = Vec::new();
        for partial in &partials {
            let component = self.pool.diff(field, *partial);
            let term = self.pool.variable(*partial);
            let term = self.pool.mul(component, term);
            rest = self.pool.sub(rest, term);
            components.push(component);
        }
        let mut moving = self.symbols.velocities();
        moving.extend(&partials);
        let is_field = components
            .iter()
            .all(|component| !self.pool.depends_on_any(*component, &moving))
            && super::super::degree::is_zero(&self.pool, rest);
        let vanishes =
            |expr: &ExprId| matches!(self.pool.node(*expr), Node::Number(n) if n.is_zero());
        if !is_field || components.iter().all(vanishes) {
            let text = format!("`{written}` is not a vector field");
            let help = "write a sum such as `partial(theta) - y*partial(x) + x*partial(y)`";
            return self.refuse(written.at, text, help);
        }
        self.partials = partials;
        self.check_periodic(&[written], &Scope::default(), field);
        self.partials.clear();
        Some(components)
    }
}
