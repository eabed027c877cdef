//! Transitions: surfaces at which one mode gives way to another.

use dalembert_expr::{ExprId, Pool};

use super::{Name, Topology};

/// Transition at a surface that leads to another mode.
#[derive(Debug, Clone, PartialEq, Eq)]
pub struct Transition {
    /// The index of the mode that is entered.
    pub enters: usize,
    /// The name of that mode.
    pub mode: String,
    /// The declared state with which it is entered. `None` if mechanics determines this state.
    pub map: Option<Map>,
    /// True if the surface counts from both sides, because another transition of the same mode has the opposite gap.
    pub has_no_side: bool,
    /// True if both modes have the same Lagrangian, so that only constraints and forces change.
    pub keeps_lagrangian: bool,
}

/// The state with which a mode is entered: expressions of the state before the transition, of parameters and of time,
/// in the order of the coordinates of the mode that is entered.
#[derive(Debug, Clone, PartialEq, Eq)]
pub struct Map {
    /// Names of these coordinates.
    pub names: Vec<String>,
    /// Positions.
    pub q: Vec<ExprId>,
    /// Velocities; empty if the mode is a first-order system.
    pub qdot: Vec<ExprId>,
}

impl Map {
    /// All given values.
    pub fn expressions(&self) -> impl Iterator<Item = ExprId> {
        self.q.iter().chain(&self.qdot).copied()
    }
}

impl Transition {
    /// All given values.
    pub fn expressions(&self) -> impl Iterator<Item = ExprId> {
        self.map.iter().flat_map(Map::expressions)
    }

    /// Transition as text: `-> rough`, `-> rough, reset { x = -x; }`.
    pub(super) fn text(&self, pool: &Pool) -> String {
        let mut text = format!("-> {}", self.mode);
        let Some(map) = &self.map else {
            return text;
        };
        let velocities = map.names.iter().map(|name| format!("dot({name})"));
        let names = map.names.iter().cloned().chain(velocities);
        let entries = names.zip(map.expressions());
        let entries: String = entries
            .map(|(name, value)| (name, pool.text(value)))
            .filter(|(name, value)| name != value)
            .map(|(name, value)| format!("{name} = {value}; "))
            .collect();
        text.push_str(&format!(", reset {{ {entries}}}"));
        text
    }
}

/// Data of a mode that other modes need before it is checked.
#[derive(Debug, Clone)]
pub(super) struct Peer {
    /// Name.
    pub(super) name: String,
    /// Its coordinates.
    pub(super) coordinates: Vec<(Name, Topology)>,
    /// True if it is a first-order system.
    pub(super) is_first_order: bool,
}
