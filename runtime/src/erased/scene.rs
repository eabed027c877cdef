//! The effects of an erased system: those that its form has.

use super::system::Erased;
use crate::effects::Scene;
use crate::impacts::Impacts;
use crate::projection::Projection;

impl<const C: usize> Scene for Erased<C> {
    type Effects = (Option<Projection<Self>>, Option<Impacts<Self>>);

    fn effects(&self) -> Self::Effects {
        let tables = &self.form().tables;
        (
            tables.drifts.then(Projection::new),
            (tables.dimensions.surfaces > 0).then(|| Impacts::declared(self)),
        )
    }
}
