//! A planar double pendulum: two point masses on two rods, absolute angles from the downward vertical.
//!
//! Facts: the energy is constant; small oscillations of equal masses on equal rods have the frequencies
//! `sqrt((2 -+ sqrt 2) g/l)`.

dalembert::model_file!("src/double_pendulum.dal");
