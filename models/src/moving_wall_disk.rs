//! The vertical rolling disk on an elliptical table that moves: surfaces that depend on time.
//!
//! Facts: an elastic impact turns the rate of the gap, `dh(qdot) + d_t h`, and keeps the energy only where the edge is at rest:
//! it gains `-d_t h` times the impulse. Against an edge that comes the disk becomes faster.
//! Source: W. Clark and A. Bloch, Remark 5, on the disk of W. Clark, thesis, section 6.4.

dalembert::model_file!("src/moving_wall_disk.dal");
