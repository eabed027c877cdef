//! The Chaplygin sleigh on an elliptical table: a billiard in which both tips of the blade meet the edge of the table.
//!
//! Facts: the free sleigh with the energy `E` has the forward speed `v = V tanh(s t + c)` and the turning rate
//! `omega = sqrt(2 E/K) sech(s t + c)`, where `K = I + m a^2`, `V = sqrt(2 E/m)` and `s = a m V/K`. In the end its centre
//! of mass is ahead.
//! Source: W. Clark, thesis, section 7.5; W. Clark and A. Bloch, section 8.1.

dalembert::model_file!(
    #[global]
    "src/chaplygin_sleigh.dal"
);
