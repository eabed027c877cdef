//! A bead on a family of similar ellipses: one integrable constraint.
//!
//! Facts: the speed is constant, and so is `f = x^2/A^2 + y^2/B^2`. The invariant density is `m^{11}`, the square of the
//! norm of `df` in the inverse metric.
//! Source: W. Clark, thesis, section 5.3.

dalembert::model_file!("src/holonomic_bead_on_ellipses.dal");
