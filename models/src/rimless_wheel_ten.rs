//! A rimless wheel with ten spokes of different lengths rolls down a slope. There is one mode for each stance spoke.
//!
//! Facts: on one spoke the wheel is an inverted pendulum, and it loses speed when the next spoke lands. The square of
//! the angular rate changes from turn to turn by an affine map. There is therefore one limit cycle, and every motion
//! that does not stop converges to it.
//! Source: W. Clark, thesis, section 4.3 and Table 4.2. The angles of the triangles between feet and hub follow from
//! the law of cosines.

dalembert::model_file!("src/rimless_wheel_ten.dal");
