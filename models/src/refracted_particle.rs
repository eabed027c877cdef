//! A particle that crosses the line `x = 0`, where mass and potential change: Snell's law.
//!
//! Facts: the momentum along the line and the energy are conserved. If the energy does not suffice, the particle is
//! reflected.
//! Sources: J. Cortes and A. Vinogradov, section 4.5.2; W. Clark and A. Bloch, section 3.5.

dalembert::model_file!("src/refracted_particle.dal");
