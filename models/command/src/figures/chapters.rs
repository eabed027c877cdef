//! Headings of the gallery: those of the thesis in its order, then those of the paper, then others.

pub const WALKERS: &str = "Walkers (W. Clark, thesis, chapter 4)";
pub const BILLIARDS: &str = "Nonholonomic billiards (thesis, chapter 6)";
pub const VARIATIONS: &str = "Variational problems (thesis, chapters 8 and 9)";
pub const TONGUES: &str = "Tongues (thesis, chapter 10)";
pub const DENSITIES: &str = "Accumulating impacts and invariant densities (W. Clark and A. Bloch)";
pub const CHAOS: &str = "Sensitive motion";
pub const COST: &str = "The cost of accuracy";
