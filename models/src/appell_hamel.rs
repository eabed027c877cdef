//! The machine of Appell and Hamel: a point whose speed along the ground is a multiple of its speed of falling.
//!
//! Facts: it keeps its direction along the ground, and its speed `u` there changes at the constant rate
//! `g k/(k^2 + 1)`, growing while it falls; where it is at rest the constraint has no gradient, and no motion follows from
//! it. Source: G. Hamel, *Theoretische Mechanik* (1949); W. Clark, thesis, Remark V.6 for the rule.

dalembert::model_file!("src/appell_hamel.dal");
