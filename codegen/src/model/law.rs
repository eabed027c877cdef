//! Declared impact laws. The runtime has a law of the same name for each.

use dalembert_expr::{ExprId, Pool, SymbolId};

use super::{Coordinate, Model, Surface};
use crate::spec::{INSTANTANEOUS, ItemId, RESET, STOP};

/// A declared impact law; coefficients are expressions of the parameters.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Law {
    /// `elastic`
    Elastic,
    /// `restitution(e)`
    Restitution(ExprId),
    /// `newton(e)`
    Newton(ExprId),
    /// `nonholonomic_plastic`
    NonholonomicPlastic,
    /// `impact_plastic`
    ImpactPlastic,
    /// `totally_plastic`
    TotallyPlastic,
    /// `reset { .. }`: the map is [`Surface::reset`](super::Surface::reset).
    Reset,
    /// `stop`: the motion ends at the surface.
    Stop,
    /// Not a law that can be written. The surface leads to another mode; see
    /// [`Surface::transition`](super::Surface::transition).
    Transition,
}

impl Law {
    /// The law of this name with this coefficient; `None` if there is no such law.
    pub(super) fn named(name: &str, coefficient: Option<ExprId>) -> Option<Self> {
        Some(match (name, coefficient) {
            ("elastic", None) => Self::Elastic,
            ("restitution", Some(e)) => Self::Restitution(e),
            ("newton", Some(e)) => Self::Newton(e),
            ("nonholonomic_plastic", None) => Self::NonholonomicPlastic,
            ("impact_plastic", None) => Self::ImpactPlastic,
            ("totally_plastic", None) => Self::TotallyPlastic,
            (RESET, None) => Self::Reset,
            (STOP, None) => Self::Stop,
            _ => return None,
        })
    }

    /// Name of the law in the language; `transition` for a transition.
    pub fn name(self) -> &'static str {
        match self {
            Self::Elastic => "elastic",
            Self::Restitution(_) => "restitution",
            Self::Newton(_) => "newton",
            Self::NonholonomicPlastic => "nonholonomic_plastic",
            Self::ImpactPlastic => "impact_plastic",
            Self::TotallyPlastic => "totally_plastic",
            Self::Reset => RESET,
            Self::Stop => STOP,
            Self::Transition => "transition",
        }
    }

    /// True if the motion goes on after an impact with this law.
    pub fn goes_on(self) -> bool {
        self != Self::Stop
    }

    /// Coefficient of restitution, if the law has one.
    pub fn coefficient(self) -> Option<ExprId> {
        match self {
            Self::Restitution(e) | Self::Newton(e) => Some(e),
            Self::Elastic
            | Self::NonholonomicPlastic
            | Self::ImpactPlastic
            | Self::TotallyPlastic
            | Self::Reset
            | Self::Stop
            | Self::Transition => None,
        }
    }
}

/// Values set by the law `reset`, by coordinate: expressions of the state before the impact, of parameters and of time.
/// `None` keeps the value.
#[derive(Debug, Clone, PartialEq, Eq)]
pub struct Reset {
    /// Positions after the impact.
    pub q: Vec<Option<ExprId>>,
    /// Velocities after the impact.
    pub qdot: Vec<Option<ExprId>>,
    /// Place of the declaration.
    pub item: ItemId,
}

impl Model {
    /// True if the declared reset of a surface changes nothing that its gap depends on.
    pub fn keeps_gap(&self, surface: &Surface) -> bool {
        let Some(reset) = &surface.reset else {
            return false;
        };
        let set = reset.replacements(&self.coordinates).into_iter();
        let set: Vec<SymbolId> = set.map(|(symbol, _)| symbol).collect();
        !self.pool.depends_on_any(surface.gap, &set)
    }
}

impl Reset {
    /// A reset of `n` coordinates that changes nothing.
    pub(super) fn identity(n: usize, item: ItemId) -> Self {
        Self {
            q: vec![None; n],
            qdot: vec![None; n],
            item,
        }
    }

    /// True if a position is set.
    pub fn moves(&self) -> bool {
        self.q.iter().any(Option::is_some)
    }

    /// All values that are set.
    pub fn expressions(&self) -> impl Iterator<Item = ExprId> {
        self.q.iter().chain(&self.qdot).flatten().copied()
    }

    /// Replacements of coordinates and velocities: the symbols that are set, with their values after the impact.
    pub fn replacements(&self, coordinates: &[Coordinate]) -> Vec<(SymbolId, ExprId)> {
        let positions = coordinates
            .iter()
            .map(|coordinate| coordinate.q)
            .zip(&self.q);
        let velocities = coordinates
            .iter()
            .map(|coordinate| coordinate.qdot)
            .zip(&self.qdot);
        positions
            .chain(velocities)
            .filter_map(|(symbol, value)| Some((symbol, (*value)?)))
            .collect()
    }

    fn text(&self, pool: &Pool, coordinates: &[Coordinate]) -> String {
        let entries = self.replacements(coordinates).into_iter();
        let entries: String = entries
            .map(|(symbol, value)| format!("{} = {}; ", pool.symbol_name(symbol), pool.text(value)))
            .collect();
        format!("{RESET} {{ {entries}}}")
    }
}

impl Model {
    /// Indices of the surfaces at which the motion does not end. Claims about impacts refer to these surfaces.
    pub fn acting_surfaces(&self) -> Vec<usize> {
        let acts = |surface: &usize| self.surfaces[*surface].law.goes_on();
        (0..self.surfaces.len()).filter(acts).collect()
    }

    /// Law of a surface as declared, with the names of its instantaneous constraints:
    /// `newton(e), instantaneous { no_slip }`.
    pub fn law_text(&self, surface: usize) -> String {
        let Surface {
            law,
            reset,
            transition,
            instantaneous,
            ..
        } = &self.surfaces[surface];
        if let Some(transition) = transition {
            return transition.text(&self.pool);
        }
        let text = match (law.coefficient(), reset) {
            (Some(e), _) => format!("{}({})", law.name(), self.pool.text(e)),
            (None, Some(reset)) => reset.text(&self.pool, &self.coordinates),
            (None, None) => law.name().to_owned(),
        };
        let names: Vec<&str> = (instantaneous.iter())
            .map(|constraint| constraint.name.display.as_str())
            .collect();
        match names.is_empty() {
            true => text,
            false => format!("{text}, {INSTANTANEOUS} {{ {} }}", names.join(", ")),
        }
    }
}
