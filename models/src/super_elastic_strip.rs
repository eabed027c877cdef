//! A point in a strip whose walls give it speed: impacts accumulate although no volume is lost.
//!
//! Facts: an impact multiplies volume by `al^2 be`, 1 for the declared parameters. From `x = 0` with speed `v0` the n-th impact
//! comes at `(1/v0) (1 + 1/al + .. + 1/al^(n-1))`; they accumulate at `al/(v0 (al - 1))`, where the speed is infinite.
//! Source: W. Clark and A. Bloch, Examples 4 and 5; `al > 1`, where Example 4 prints `al > 0`.

dalembert::model_file!("src/super_elastic_strip.dal");
