//! A point in an elliptical table, straight lines and specular reflection.
//!
//! Facts: the product of the angular momenta about the two foci is constant; in a circle the angular momentum
//! is, and the bounces turn by a constant angle.

dalembert::model_file!("src/point_billiard.dal");
