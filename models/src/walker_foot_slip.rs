//! A walker on a slope whose foot slips: a leg with a mass at its top, friction at the foot, and a new stance leg at
//! every step.
//!
//! `x_c` is the position of the centre of mass along the slope, `theta` the angle of the stance leg. The velocity of
//! the foot is `dot(x_c) + lf dot(theta) cos(theta)`. A step at `theta = -delta` changes the stance leg: the new leg
//! has the angle `delta`, and `cos(2 delta)` times the rate of the old one. The velocity of the foot does not change.
//!
//! Facts: [`DimensionlessWalker`](crate::DimensionlessWalker) is this system in other units.
//! Source: W. Clark, thesis, section 4.2 (4.5 to 4.7). Here the centripetal term of (4.7) is subtracted and multiplied
//! by `lf`.

dalembert::model_file!("src/walker_foot_slip.dal");
