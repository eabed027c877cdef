//! Billiard tables that several cases use.

use dalembert::Described;

use super::text::{Model, Text, shipped};

/// A free point of mass 1 in an ellipse with these half axes.
pub fn elliptic_table(ta: f64, tb: f64) -> Model {
    shipped("point_billiard").with([("m", 1.0), ("ta", ta), ("tb", tb)])
}

/// A free point in a rectangle.
pub static RECTANGLE: Text = Text::new(
    "Rectangle {
        coordinates { x; y; }
        parameters { a > 0 = 1; b > 0 = 1; }
        lagrangian = (dot(x)^2 + dot(y)^2)/2;
        impacts { left: x >= 0; right: x <= a; lower: y >= 0; upper: y <= b; }
    }",
);

// NOTE: this is the only compiled model, because loaded models have no kernels over numbers of more than double
// precision.
dalembert::model! {
    /// A free point in the square of side 2 with a disk of radius 1/2 in its middle.
    pub Sinai {
        coordinates { x; y; }
        lagrangian = (dot(x)^2 + dot(y)^2)/2;
        impacts { left: x >= -1; right: x <= 1; lower: y >= -1; upper: y <= 1; disk: x^2 + y^2 >= 1/4; }
    }
}

/// The same model, loaded from its text.
pub static SINAI: Text = Text::new(Sinai::DESCRIPTION.source.value());

/// A free point in a stadium: a square of side 2 between two half disks of radius 1.
pub static STADIUM: Text = Text::new(
    "Stadium {
        coordinates { x; y; }
        lagrangian = (dot(x)^2 + dot(y)^2)/2;
        impacts {
            lower: y >= -1 when x > -1 when x < 1;
            upper: y <= 1 when x > -1 when x < 1;
            left: 1 - (x + 1)^2 - y^2 >= 0 when x < -1;
            right: 1 - (x - 1)^2 - y^2 >= 0 when x > 1;
        }
    }",
);
