//! Two wheels on parallel axles, joined by a rod that is arrested when it becomes shortest or longest.
//!
//! Fact: the arrest is the projection on the boundary of the constraints, after which both wheels roll on at the same speed.
//! Source: J. Cortes and A. Vinogradov, section 6.4, the inelastic case.

dalembert::model_file!("src/two_wheels_arrested.dal");
