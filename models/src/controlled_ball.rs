//! A bouncing ball with a force: the optimal input is minus the costate of the momentum, linear in time between impacts.
//!
//! Facts: from rest at height 1/2 the extremals of time 5 with 0, 1 and 2 impacts cost 8.0732484, 1.9530584 and 0.2105698. With the
//! height 1 and momentum 0 at both ends the force `m g` costs `m^2 g^2 T/2 = 10` without an impact, and one with an impact 3.46669914.
//! Source: W. Clark, thesis, section 9.6; the costs are computed.

dalembert::model_file!("src/controlled_ball.dal");
