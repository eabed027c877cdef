//! A bouncing ball with a controlled force. The optimal input is minus the costate of the momentum, which is linear in
//! time between impacts.
//!
//! Facts: from rest at height 1/2, the extremals over the time 5 with 0, 1 and 2 impacts cost 8.0732484, 1.9530584 and
//! 0.2105698. With height 1 and momentum 0 at both ends, the force `m g` without an impact costs `m^2 g^2 T/2 = 10`,
//! and the extremal with one impact costs 3.46669914. Source of the model: W. Clark, thesis, section 9.6. The costs
//! were computed with this library.

dalembert::model_file!("src/controlled_ball.dal");
