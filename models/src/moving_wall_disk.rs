//! The vertical rolling disk on an elliptical table that moves: surfaces that depend on time.
//!
//! Facts: an elastic impact reverses the gap rate `dh(qdot) + d_t h`. The energy increases by `-d_t h` times the impulse,
//! so that it is conserved only where the edge of the table does not move along its normal. If the edge approaches the
//! disk, the disk gains energy. Source: W. Clark and A. Bloch, Remark 5, on the disk of W. Clark, thesis, section 6.4.

dalembert::model_file!("src/moving_wall_disk.dal");
