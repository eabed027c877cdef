//! A ball that bounces on a floor.
//!
//! Facts: with restitution `e` from rest at height `x0` the n-th impact is at
//! `sqrt(2 x0/g) (1 + 2 (e + .. + e^{n-1}))`, and the impacts accumulate where that series ends.
//! Source: W. Clark, thesis, Example IX.9.

dalembert::model_file!("src/bouncing_ball.dal");
