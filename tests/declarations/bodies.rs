//! Declarations of rigid bodies and trains, with given kinetic energies and constraints.

/// Angular velocity in Euler angles: `b1`, `b2`, `b3` in the body frame, `s1`, `s2`, `s3` in space.
pub const BODY: &str = "
    let b1 = dot(phi)*sin(theta)*sin(psi) + dot(theta)*cos(psi);
    let b2 = dot(phi)*sin(theta)*cos(psi) - dot(theta)*sin(psi);
    let b3 = dot(phi)*cos(theta) + dot(psi);
    let s1 = dot(theta)*cos(phi) + dot(psi)*sin(theta)*sin(phi);
    let s2 = dot(theta)*sin(phi) - dot(psi)*sin(theta)*cos(phi);
    let s3 = dot(phi) + dot(psi)*cos(theta);";

/// Euler angles as coordinates.
pub const EULER: &str = "phi: angle; theta in (0, pi); psi: angle;";

/// A body with a fixed point.
pub fn top(parameters: &str, kinetic: &str, constraint: &str) -> String {
    format!(
        "Body {{ coordinates {{ {EULER} }} parameters {{ {parameters} }} {BODY}
            lagrangian = ({kinetic})/2; constraints {{ axis: {constraint} = 0; }} }}"
    )
}

/// A ball of radius 1 that rolls on a plane. `offset` has the body coordinates of its centre of mass, measured from the
/// centre and separated by commas; `more` has further constraints.
pub fn ball(offset: &str, inertia: &str, more: &str) -> String {
    format!(
        "Ball {{
            coordinates {{ x; y; {EULER} }}
            parameters {{ m > 0 = 2; A > 0 = 3; B > 0 = 4; C > 0 = 5; l = 1/4; k = 1/5; }}
            {BODY}
            let sp = sin(psi); let cp = cos(psi); let st = sin(theta); let ct = cos(theta);
            let sf = sin(phi); let cf = cos(phi);
            let rx(a, b, c) = (cf*cp - sf*ct*sp)*a + (-cf*sp - sf*ct*cp)*b + sf*st*c;
            let ry(a, b, c) = (sf*cp + cf*ct*sp)*a + (-sf*sp + cf*ct*cp)*b - cf*st*c;
            let rz(a, b, c) = st*sp*a + st*cp*b + ct*c;
            lagrangian = m/2*(dot(x + rx({offset}))^2 + dot(y + ry({offset}))^2 + dot(rz({offset}))^2)
                + ({inertia})/2;
            constraints {{ rolling_x: dot(x) - s2 = 0; rolling_y: dot(y) + s1 = 0; {more} }}
        }}"
    )
}

/// A sleigh that pulls `count` trailers with masses at their axles.
pub fn train(count: usize) -> String {
    let mut angles = String::from("x; y; theta0: angle; ");
    let mut constraints = String::from("blade: -sin(theta0)*d(x) + cos(theta0)*d(y) = 0; ");
    let mut definitions = String::from("let x0 = x; let y0 = y; ");
    let mut kinetic = String::from("m/2*(dot(x)^2 + dot(y)^2) + I/2*dot(theta0)^2");
    for i in 1..=count {
        let (angle, before) = (format!("theta{i}"), i - 1);
        angles += &format!("{angle}: angle; ");
        definitions += &format!(
            "let x{i} = x{before} - l{i}*cos({angle}); let y{i} = y{before} - l{i}*sin({angle}); "
        );
        constraints += &format!("c{i}: -sin({angle})*d(x{i}) + cos({angle})*d(y{i}) = 0; ");
        kinetic += &format!(" + m{i}/2*(dot(x{i})^2 + dot(y{i})^2) + J{i}/2*dot({angle})^2");
    }
    let parameters: String = (1..=count)
        .map(|i| format!("l{i} = {}/3; m{i} > 0 = {i}/2; J{i} > 0 = {i}; ", i + 1))
        .collect();
    format!(
        "Train {{ coordinates {{ {angles} }} parameters {{ m > 0 = 2; I > 0 = 1; {parameters} }} {definitions}
            lagrangian = {kinetic}; constraints {{ {constraints} }} }}"
    )
}
