//! Effects of an erased system, as its form declares them.

use super::system::Erased;
use crate::effects::Scene;
use crate::impacts::Impacts;
use crate::modes::InMode;
use crate::projection::Projection;

impl<const C: usize> Scene for Erased<'_, C> {
    type Effects = (
        Option<Projection<Self>>,
        Option<Impacts<Self>>,
        Option<InMode<Projection<Self>>>,
    );

    fn effects(&self) -> Self::Effects {
        let tables = &self.form().tables;
        let has_modes = !tables.modes.is_empty();
        (
            (tables.drifts && !has_modes).then(Projection::new),
            (tables.dimensions.surfaces > 0).then(|| Impacts::declared(self)),
            // A projection begins after the transition into a mode.
            (tables.drifts && has_modes).then(|| InMode::new(Projection::new())),
        )
    }
}
