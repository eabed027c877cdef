//! Mathieu's equation `x'' + (delta + eps cos t) x = 0` as a first-order system. The motion meets the surface `period`
//! once in every period.
//!
//! Facts: for `eps = 0` and from rest at 1, x is `cos(sqrt(delta) t)`. For small `eps`, `x = 0` is unstable between
//! `delta = 1/4 -+ eps/2 - eps^2/8 +- eps^3/32 - eps^4/384`, where the trace of the map over a period passes -2.
//! Source: W. Clark, thesis, section 10.2.1; NIST, Digital Library of Mathematical Functions, 28.6(i), with
//! `a = 4 delta`, `q = 2 eps`.

dalembert::model_file!("src/mathieu.dal");
