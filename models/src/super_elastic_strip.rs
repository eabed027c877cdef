//! A point in a strip whose walls increase its speed. Impacts accumulate, although volume is conserved.
//!
//! Facts: an impact multiplies the volume by `al^2 be`, which is 1 for the declared parameters. From `x = 0` with
//! `dot(x) = v0`, the n-th impact is at the time `(1/v0) (1 + 1/al + .. + 1/al^(n-1))`. For `al > 1` the impacts
//! accumulate at `al/(v0 (al - 1))`, where the speed is infinite. Source: W. Clark and A. Bloch, Examples 4 and 5;
//! Example 4 prints `al > 0` in place of `al > 1`.

dalembert::model_file!("src/super_elastic_strip.dal");
