//! A mass on a spring.
//!
//! Facts: `x = x0 cos(w t) + (v0/w) sin(w t)` with `w = sqrt(k/m)`; the energy is constant.

dalembert::model_file!("src/harmonic_oscillator.dal");
