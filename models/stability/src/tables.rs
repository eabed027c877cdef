//! Billiard tables that several cases use.

dalembert::model! {
    /// A free point in a rectangle.
    pub Rectangle {
        coordinates { x; y; }
        parameters { a > 0 = 1; b > 0 = 1; }
        lagrangian = (dot(x)^2 + dot(y)^2)/2;
        impacts { left: x >= 0; right: x <= a; lower: y >= 0; upper: y <= b; }
    }
}

dalembert::model! {
    /// A free point in the square of side 2 with a disk of radius 1/2 in its middle.
    pub Sinai {
        coordinates { x; y; }
        lagrangian = (dot(x)^2 + dot(y)^2)/2;
        impacts { left: x >= -1; right: x <= 1; lower: y >= -1; upper: y <= 1; disk: x^2 + y^2 >= 1/4; }
    }
}

dalembert::model! {
    /// A free point in a stadium: a square of side 2 between two half disks of radius 1.
    pub Stadium {
        coordinates { x; y; }
        lagrangian = (dot(x)^2 + dot(y)^2)/2;
        impacts {
            lower: y >= -1 when x > -1 when x < 1;
            upper: y <= 1 when x > -1 when x < 1;
            left: 1 - (x + 1)^2 - y^2 >= 0 when x < -1;
            right: 1 - (x - 1)^2 - y^2 >= 0 when x > 1;
        }
    }
}
