//! The Chaplygin sleigh on an elliptical table, a billiard with both tips of the blade.
//!
//! Facts: with `K = I + m a^2` the free sleigh has `v = V tanh(s t + c)`, `omega = sqrt(2E/K) sech(s t + c)`,
//! `V = sqrt(2E/m)`, `s = a m V/K`. It always ends with its centre of mass ahead.
//! Source: W. Clark, thesis, section 7.5; W. Clark and A. Bloch, section 8.1.

dalembert::model_file!("src/chaplygin_sleigh.dal");
