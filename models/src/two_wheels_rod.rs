//! Two wheels on parallel axles, joined by a rod that slides between two stops.
//!
//! Facts: both rolling constraints are integrable (`x - r theta` is constant). An elastic stop exchanges momentum
//! between the wheels. Source: J. Cortes and A. Vinogradov, section 6.4.

dalembert::model_file!("src/two_wheels_rod.dal");
