//! A field that is discontinuous at a line, with crossing and sliding.
//!
//! Fact: where both fields lead to the line, the motion slides along it with the combination of both fields that is
//! tangent to it. Elsewhere it crosses the line. Source: W. Clark and A. Bloch, section 7 (discontinuous fields), with
//! the sliding motion of Filippov.

dalembert::model_file!("src/filippov_field.dal");
