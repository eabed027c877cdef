//! The law `reset`: positions and velocities after an impact, as functions of the state before it.

use dalembert_expr::ExprId;

use super::super::resolve::{Resolver, Scope};
use super::super::{Reset, Topology};
use super::targets::Section;
use crate::diagnostics::Location;
use crate::spec::{Assignment, AssignmentTarget, Law, RESET};

impl Resolver<'_> {
    /// The map of a law that is a reset, `Some(None)` for any other law, `None` if the map was refused.
    pub(super) fn reset(&mut self, law: Option<&Law>, scope: &Scope) -> Option<Option<Reset>> {
        let Some(law) = law.filter(|law| law.name.text == RESET) else {
            return Some(None);
        };
        let errors = self.diagnostics.len();
        let mut reset = Reset::identity(self.symbols.coordinates.len(), law.item);
        let mut given: Vec<(AssignmentTarget, usize, Location)> = Vec::new();
        for entry in law.assignments.iter().flatten() {
            for (index, scope) in self.targets(&entry.declared, scope, Section::Reset) {
                self.assigned_once(&mut given, entry, index);
                let Some(value) = self.assigned(entry, index, scope) else {
                    break;
                };
                match entry.target {
                    AssignmentTarget::Position => reset.q[index] = Some(value),
                    AssignmentTarget::Velocity => reset.qdot[index] = Some(value),
                }
            }
        }
        (self.diagnostics.len() == errors).then_some(Some(reset))
    }

    /// Refuses a second value for the same quantity.
    fn assigned_once(
        &mut self,
        given: &mut Vec<(AssignmentTarget, usize, Location)>,
        entry: &Assignment,
        index: usize,
    ) {
        let at = entry.declared.name.at;
        let first = given
            .iter()
            .find(|(target, other, _)| (*target, *other) == (entry.target, index));
        if let Some((_, _, first)) = first {
            let name = &self.symbols.coordinates[index].name.display;
            let text = match entry.target {
                AssignmentTarget::Position => format!("`{name}` is reset twice"),
                AssignmentTarget::Velocity => format!("`dot({name})` is reset twice"),
            };
            let error = self.diagnostics.error(at, text);
            error
                .help("keep one of the two")
                .also(*first, "first reset here");
        }
        given.push((entry.target, index, at));
    }

    /// A value after an impact.
    fn assigned(&mut self, entry: &Assignment, index: usize, mut scope: Scope) -> Option<ExprId> {
        let written = &entry.value;
        let value = self.expression(written, &mut scope)?;
        let differentials = self.symbols.all_differentials();
        let text = "a reset contains no differentials";
        let help = "velocities are written `dot(x)`";
        self.forbid(written, &scope, value, &differentials, text, help)?;
        self.forbid_inputs(written, &scope, value)?;
        let topology = self.symbols.coordinates[index].topology;
        match (entry.target, topology) {
            (AssignmentTarget::Position, Topology::Angle) => {
                self.check_periodic_angle(&[written], &scope, value);
            }
            _ => self.check_periodic(&[written], &scope, value),
        }
        if entry.target == AssignmentTarget::Position {
            self.check_in_chart(written, index, value)?;
        }
        Some(value)
    }
}
