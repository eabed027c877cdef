//! A rimless wheel with ten spokes of different lengths that rolls down a slope. Each spoke that stands is a mode.
//!
//! Facts: on one spoke the wheel is an inverted pendulum. When the next spoke lands, the wheel loses speed. The square
//! of the rate is mapped affinely from turn to turn, so that there is one limit cycle, to which every motion tends that
//! does not stop. Source: W. Clark, thesis, section 4.3 and Table 4.2, with the angles of the triangles between feet
//! and hub by the law of cosines.

dalembert::model_file!("src/rimless_wheel_ten.dal");
