//! A ball that bounces on a floor.
//!
//! Facts: from rest at height `x0`, with restitution `e`, the n-th impact is at the time
//! `sqrt(2 x0/g) (1 + 2 (e + .. + e^{n-1}))`. The impacts accumulate at the limit of these times.
//! Source: W. Clark, thesis, Example IX.9.

dalembert::model_file!("src/bouncing_ball.dal");
