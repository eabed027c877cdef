//! The simplest walker, a compass gait with feet of vanishing mass against the hip: a first-order system.
//!
//! `theta` is the angle of the stance leg from the normal of the slope, `phi` the angle between the legs. Lengths are measured
//! in legs, times in `sqrt(leg/g)`. The foot of the swinging leg is at the height of the slope where `phi = 2 theta`; the scuff at
//! `phi = 0`, where the legs pass each other, is ignored.
//!
//! Facts: on the slope `gamma = 0.009` the long gait begins its steps at `theta = 0.200310900544287`, `omega = -0.199832473004977`.
//! Its multipliers lead to a period doubling near `gamma = 0.0151`. Source: M. Garcia, A. Chatterjee, A. Ruina, M. Coleman,
//! *The simplest walking model: stability, complexity, and scaling*, J. Biomech. Eng. 120 (1998), equations (1) to (4).

dalembert::model_file!("src/compass_walker.dal");
