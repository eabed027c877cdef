//! Transitions: the mode that is entered, and the state in it after the transition.

use dalembert_expr::ExprId;

use super::super::resolve::{Resolver, Scope};
use super::super::transition::{Map, Peer, Transition};
use super::super::{Law, Name, Surface, Topology};
use super::surfaces::are_opposite;
use crate::diagnostics::{Location, listed, nearest};
use crate::spec::{self, Assignment, AssignmentTarget, Declared, Index, RESET};

impl Resolver<'_> {
    /// The transition of a surface, `Some(None)` for a surface without one, `None` if the transition was refused.
    pub(super) fn transition(
        &mut self,
        surface: &spec::Surface,
        scope: &Scope,
    ) -> Option<Option<Transition>> {
        let Some(word) = &surface.enters else {
            return Some(None);
        };
        let modes = self.modes;
        let Some(enters) = modes.iter().position(|mode| mode.name == word.text) else {
            let names = modes.iter().map(|mode| mode.name.as_str());
            let help = match nearest(&word.text, names.clone()) {
                Some(near) => format!("did you mean `{near}`?"),
                None => format!("the modes are {}", listed(names)),
            };
            return self.refuse(word.at, format!("unknown mode `{}`", word.text), &help);
        };
        let peer = &modes[enters];
        let map = match &surface.law {
            Some(law) if law.name.text == RESET => {
                let at = self.spec.location(surface.item);
                Some(self.map(law, scope, peer, at)?)
            }
            Some(law) if law.name.text != "elastic" || !law.arguments.is_empty() => {
                let text = format!("`{}` is no law of a transition", law.name.text);
                let help = "a transition is `elastic`, which need not be written, or a `reset { .. }`; \
                            a constraint that holds after it belongs to the mode that is entered";
                return self.refuse(law.name.at, text, help);
            }
            _ => {
                self.check_same_coordinates(peer, word.at)?;
                None
            }
        };
        Some(Some(Transition {
            enters,
            mode: peer.name.clone(),
            map,
            has_no_side: false,
            keeps_lagrangian: false,
        }))
    }

    /// Refuses a transition without a reset into a mode with other coordinates. Such a transition keeps the state.
    fn check_same_coordinates(&mut self, peer: &Peer, at: Location) -> Option<()> {
        let names = self
            .symbols
            .coordinates
            .iter()
            .map(|coordinate| &coordinate.name.display);
        let others = peer.coordinates.iter().map(|(name, _)| &name.display);
        if names.eq(others) {
            return Some(());
        }
        let text = format!("`{}` has other coordinates", peer.name);
        let help = "give their values when it is entered: `=> reset { x = ..; dot(x) = ..; }`";
        self.refuse(at, text, help)
    }

    /// The map from the state before the transition to the state in the mode entered.
    fn map(&mut self, law: &spec::Law, scope: &Scope, peer: &Peer, at: Location) -> Option<Map> {
        let errors = self.diagnostics.len();
        let n = peer.coordinates.len();
        let (mut q, mut qdot) = (vec![None; n], vec![None; n]);
        let mut given: Vec<(AssignmentTarget, usize)> = Vec::new();
        for entry in law.assignments.iter().flatten() {
            for (index, scope) in self.entered_coordinates(&entry.declared, scope, peer) {
                if given.contains(&(entry.target, index)) {
                    let name = &peer.coordinates[index].0.display;
                    let text = format!("`{name}` is given twice");
                    self.refuse::<()>(entry.declared.name.at, text, "keep one of the two");
                }
                given.push((entry.target, index));
                let topology = peer.coordinates[index].1;
                let Some(value) = self.entry_value(entry, topology, scope) else {
                    break;
                };
                match entry.target {
                    AssignmentTarget::Position => q[index] = Some(value),
                    AssignmentTarget::Velocity => qdot[index] = Some(value),
                }
            }
        }
        if self.diagnostics.len() > errors {
            return None;
        }
        let q = self.kept(q, peer, at, AssignmentTarget::Position)?;
        let qdot = match peer.is_first_order {
            true => Vec::new(),
            false => self.kept(qdot, peer, at, AssignmentTarget::Velocity)?,
        };
        let names = peer
            .coordinates
            .iter()
            .map(|(name, _)| name.display.clone());
        Some(Map {
            names: names.collect(),
            q,
            qdot,
        })
    }

    /// The values of a map. A value that is not given is kept; the mode that is left must have a coordinate of that
    /// name.
    fn kept(
        &mut self,
        given: Vec<Option<ExprId>>,
        peer: &Peer,
        at: Location,
        target: AssignmentTarget,
    ) -> Option<Vec<ExprId>> {
        let mut values = Vec::new();
        let mut missing = Vec::new();
        for (value, (name, _)) in given.into_iter().zip(&peer.coordinates) {
            let counterpart = self
                .symbols
                .coordinates
                .iter()
                .find(|coordinate| coordinate.name == *name);
            let symbol = counterpart.map(|coordinate| match target {
                AssignmentTarget::Position => coordinate.q,
                AssignmentTarget::Velocity => coordinate.qdot,
            });
            match (value, symbol) {
                (Some(value), _) => values.push(value),
                (None, Some(symbol)) => values.push(self.pool.variable(symbol)),
                (None, None) => missing.push(match target {
                    AssignmentTarget::Position => name.display.clone(),
                    AssignmentTarget::Velocity => format!("dot({})", name.display),
                }),
            }
        }
        if missing.is_empty() {
            return Some(values);
        }
        let names = listed(missing.iter().map(String::as_str));
        let text = format!(
            "no value is given for {names} when `{}` is entered",
            peer.name
        );
        let help = format!("write `{} = ..;` in the reset", missing[0]);
        self.refuse(at, text, &help)
    }

    /// The value of one component of the state in the mode entered.
    fn entry_value(
        &mut self,
        entry: &Assignment,
        topology: Topology,
        mut scope: Scope,
    ) -> Option<ExprId> {
        let written = &entry.value;
        let value = self.expression(written, &mut scope)?;
        let differentials = self.symbols.all_differentials();
        let text = "a reset contains no differentials";
        let help = "velocities are written `dot(x)`";
        self.forbid(written, &scope, value, &differentials, text, help)?;
        self.forbid_inputs(written, &scope, value)?;
        match (entry.target, topology) {
            (AssignmentTarget::Position, Topology::Angle) => {
                self.check_periodic_angle(&[written], &scope, value);
            }
            _ => self.check_periodic(&[written], &scope, value),
        }
        Some(value)
    }

    /// The coordinates of another mode that a declared name denotes: their indices, each with the scope in which the
    /// assigned value is resolved.
    fn entered_coordinates(
        &mut self,
        declared: &Declared,
        scope: &Scope,
        peer: &Peer,
    ) -> Vec<(usize, Scope)> {
        let (field, at) = (declared.name.text.as_str(), declared.name.at);
        let fields = peer.coordinates.iter().map(|(name, _)| name.field.as_str());
        if !fields.clone().any(|known| known == field) {
            let help = match nearest(field, fields.clone()) {
                Some(near) => format!("did you mean `{near}`?"),
                None => format!("its coordinates are {}", listed(fields)),
            };
            let text = format!("`{field}` is no coordinate of `{}`", peer.name);
            self.refuse::<()>(at, text, &help);
            return Vec::new();
        }
        let place = |member: Option<usize>| {
            let is_it = |(name, _): &(Name, Topology)| name.field == field && name.member == member;
            peer.coordinates.iter().position(is_it)
        };
        let members: Vec<(Option<usize>, Scope)> = match &declared.index {
            None => vec![(None, scope.clone())],
            Some(Index::One(index)) => {
                let member = self.integer(index, &mut scope.clone());
                let member = member.and_then(|member| usize::try_from(member).ok());
                vec![(member, scope.clone())]
            }
            Some(Index::Each(binder)) => {
                let range = self.range(binder, &mut scope.clone()).into_iter().flatten();
                let bound = range.map(|member| {
                    let mut scope = scope.clone();
                    scope.bind(&binder.name.text, self.pool.int(member).into());
                    (usize::try_from(member).ok(), scope)
                });
                bound.collect()
            }
        };
        let mut found = Vec::new();
        for (member, scope) in members {
            match place(member) {
                Some(index) => found.push((index, scope)),
                None => {
                    let text = format!("`{field}` of `{}` has no such member", peer.name);
                    self.refuse::<()>(at, text, "members are counted from 1");
                    break;
                }
            }
        }
        found
    }
}

/// Marks the transitions whose surface is crossed by another transition in the opposite direction.
pub(super) fn mark_sides(resolver: &mut Resolver<'_>, surfaces: &mut [Surface]) {
    for index in 0..surfaces.len() {
        let is_transition = |surface: &Surface| surface.law == Law::Transition;
        let has_opposite = is_transition(&surfaces[index])
            && surfaces.iter().any(|surface| {
                is_transition(surface) && are_opposite(resolver, surface, &surfaces[index])
            });
        if let Some(transition) = &mut surfaces[index].transition {
            transition.has_no_side = has_opposite;
        }
    }
}
