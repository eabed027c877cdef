//! A planar double pendulum: two point masses on two rods, with absolute angles from the downward vertical.
//!
//! Facts: the energy is constant. For equal masses on equal rods, small oscillations have the angular frequencies
//! `sqrt((2 -+ sqrt 2) g/l)`.

dalembert::model_file!("src/double_pendulum.dal");
