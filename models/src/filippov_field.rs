//! A field that is discontinuous at a line: crossing and sliding.
//!
//! Fact: where both sides lead to the line the motion slides along it, with the combination of both fields that is tangent to
//! it; else it crosses. Source: W. Clark and A. Bloch, section 7 (discontinuous fields), with the sliding motion of Filippov.

dalembert::model_file!("src/filippov_field.dal");
