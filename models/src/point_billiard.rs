//! A point on an elliptical table, with straight lines and specular reflection.
//!
//! Facts: the product of the angular momenta about the two foci is constant. In a circle the angular momentum is
//! constant, and successive bounces are a constant angle apart.

dalembert::model_file!("src/point_billiard.dal");
