//! Headings of the gallery, in the order of the thesis, then of the paper.

pub const WALKERS: &str = "Walkers (W. Clark, thesis, chapter 4)";
pub const BILLIARDS: &str = "Nonholonomic billiards (thesis, chapter 6)";
pub const VARIATIONS: &str = "Variational problems (thesis, chapters 8 and 9)";
pub const TONGUES: &str = "Tongues (thesis, chapter 10)";
pub const DENSITIES: &str = "Accumulating impacts and invariant densities (W. Clark and A. Bloch)";
pub const CHAOS: &str = "Sensitive motion";
pub const COST: &str = "What accuracy costs";
