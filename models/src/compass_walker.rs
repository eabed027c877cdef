//! The simplest walker: a compass gait with feet of negligible mass, as a first-order system.
//!
//! `theta` is the angle of the stance leg from the normal of the slope, `phi` the angle between the legs. The unit of
//! length is the leg, the unit of time `sqrt(leg/g)`. The swing foot is on the slope where `phi = 2 theta`. Its contact
//! with the slope at `phi = 0`, where the legs pass each other, is ignored.
//!
//! Facts: on the slope `gamma = 0.009` the long gait begins its steps at `theta = 0.200310900544287`,
//! `omega = -0.199832473004977`. Its period doubles near `gamma = 0.0151`. Source: M. Garcia, A. Chatterjee, A. Ruina,
//! M. Coleman, *The simplest walking model: stability, complexity, and scaling*, J. Biomech. Eng. 120 (1998), equations
//! (1) to (4).

dalembert::model_file!("src/compass_walker.dal");
