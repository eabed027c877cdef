//! A point on a plane in which a disk is replaced by the half of a sphere that stands on it, seen from above: a metric that
//! changes at a circle.
//!
//! Facts: outside motions are straight lines, inside great circles; at the circle the momentum along it stays, and the energy.
//! Source: W. Clark and A. Bloch, Example 3, with the metric `1 + x^2/(1 - x^2 - y^2)` that the sphere has.

dalembert::model_file!("src/sphere_in_plane.dal");
