//! A point on a plane in which a spherical cap replaces a disk, in coordinates of the plane: the metric changes at a
//! circle.
//!
//! Facts: motions are straight lines outside, and great circles inside. At the circle, the momentum along it and the
//! energy are conserved. Source: W. Clark and A. Bloch, Example 3, with the metric `1 + x^2/(1 - x^2 - y^2)` of the
//! sphere.

dalembert::model_file!("src/sphere_in_plane.dal");
