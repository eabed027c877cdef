//! A rimless wheel of ten spokes of different lengths that rolls down a slope: a mode for each spoke that stands.
//!
//! Facts: on one spoke the wheel is a pendulum upside down; where the next one lands speed is lost, and the square of the rate is
//! mapped affinely from turn to turn, so that there is one limit cycle and every motion that goes on tends to it.
//! Source: W. Clark, thesis, section 4.3 and Table 4.2, with the angles of the triangles between feet and hub by the law of
//! cosines.

dalembert::model_file!("src/rimless_wheel_ten.dal");
