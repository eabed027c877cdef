//! The vertical rolling disk on an elliptical table: a billiard in which both ends of the disk meet the edge of the table.
//!
//! Facts: between impacts `dot(theta)` and `dot(phi)` are constant, and the point of contact runs on a circle of radius
//! `|R dot(theta)/dot(phi)|`. On a circular table the pair of rates alternates between two values.
//! Source: W. Clark, thesis, section 6.4 (Figures 6.2 to 6.4: `ta = tb = 0.2` and `ta = 0.15`).

dalembert::model_file!(
    #[global]
    "src/rolling_disk.dal"
);
