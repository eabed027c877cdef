//! The vertical rolling disk on an elliptical table that moves: surfaces that depend on time.
//!
//! Facts: an elastic impact reverses the gap rate `dh(qdot) + d_t h`. It conserves the energy only where the edge is at
//! rest: the energy increases by `-d_t h` times the impulse. An approaching edge makes the disk faster. Source: W.
//! Clark and A. Bloch, Remark 5, on the disk of W. Clark, thesis, section 6.4.

dalembert::model_file!("src/moving_wall_disk.dal");
