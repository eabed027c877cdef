//! Two wheels on parallel axles, joined by a rod that locks at its shortest and at its longest length.
//!
//! Fact: locking projects the velocity onto the motions of constant length of the rod. Both wheels then roll on at the
//! same speed.
//! Source: J. Cortes and A. Vinogradov, section 6.4, the inelastic case.

dalembert::model_file!("src/two_wheels_arrested.dal");
