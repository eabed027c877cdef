//! The machine of Appell and Hamel: a point whose speed along the ground is a multiple of its speed of falling.
//!
//! Facts: the point keeps its direction along the ground. Its speed `u` along the ground changes at the constant rate
//! `g k/(k^2 + 1)` and grows while it falls. At rest the constraint has no gradient and determines no motion.
//! Source: G. Hamel, *Theoretische Mechanik* (1949); W. Clark, thesis, Remark V.6 for the rule.

dalembert::model_file!("src/appell_hamel.dal");
