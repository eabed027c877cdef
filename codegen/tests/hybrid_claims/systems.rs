//! Declarations with the placeholder `CLAIM` for a claim.

/// A ball above a floor with this impact law.
pub(super) fn ball(law: &str) -> String {
    format!(
        "pub Ball {{ coordinates {{ x; }} parameters {{ m > 0 = 1; g > 0 = 1; c in [0, 1] = 0.7; k > 0 = 2; }}
        lagrangian = m/2*dot(x)^2 - m*g*x; impacts {{ floor: x >= 0 => {law}; }} CLAIM }}"
    )
}

/// A particle in the plane with these surfaces.
pub(super) fn particle(surfaces: &str) -> String {
    format!(
        "pub Particle {{ coordinates {{ x; y; }} parameters {{ a > 0 = 5/4; b > 0 = 16/25; d1 = 1/3; }}
        lagrangian = (dot(x)^2 + dot(y)^2)/2; impacts {{ {surfaces} }} CLAIM }}"
    )
}

/// A walker without friction. Its step is a reset that sets the rate of the angle to `rate`.
pub(super) fn walker(rate: &str) -> String {
    format!(
        "pub Walker {{ coordinates {{ x_c; theta; }}
        parameters {{ m > 0 = 1; I > 0 = 1/4; lf > 0 = 1/2; g = 1; alpha = 1/10; delta > 0 = 3/10; }}
        lagrangian = m/2*(lf^2*dot(theta)^2*sin(theta)^2 + dot(x_c)^2) + I/2*dot(theta)^2
            - g*m*(lf*cos(alpha)*cos(theta) - x_c*sin(alpha));
        impacts {{ step: theta >= -delta => reset {{ theta = theta + 2*delta; dot(theta) = {rate};
            dot(x_c) = dot(x_c) + lf*cos(delta)*(1 - cos(2*delta))*dot(theta); }}; }} CLAIM }}"
    )
}

/// A rolling disk with this wall.
pub(super) fn disk(wall: &str) -> String {
    format!(
        "pub Disk {{ coordinates {{ x; y; theta: angle; phi: angle; }}
        parameters {{ m > 0 = 7/5; R > 0 = 3/8; I > 0 = 2/9; J > 0 = 1/7; e in [0, 1] = 1/2; }}
        lagrangian = m/2*(dot(x)^2 + dot(y)^2) + I/2*dot(theta)^2 + J/2*dot(phi)^2;
        constraints {{ rolling_x: dot(x) = R*cos(phi)*dot(theta); rolling_y: dot(y) = R*sin(phi)*dot(theta); }}
        impacts {{ {wall} }} CLAIM }}"
    )
}

/// A first-order system with impacts.
pub(super) fn field(rates: &str, impacts: &str) -> String {
    format!(
        "pub Field {{ coordinates {{ x; y; }} parameters {{ k > 0 = 1/2; }} field {{ {rates} }} impacts {{ {impacts} }} CLAIM }}"
    )
}

/// Constant fields on both sides of `x = 0`. The claim is in the right mode; the left mode claims `density`.
pub(super) fn crossing(right: [&str; 2], left: [&str; 2], density: &str) -> String {
    let field = |[x, y]: [&str; 2]| format!("field {{ dot(x) = {x}; dot(y) = {y}; }}");
    format!(
        "pub Crossing {{ coordinates {{ x; y; }} modes {{ right {{ {} CLAIM }} left {{ {} claims {{ density = {density}; }} }} }}
        transitions {{ leftward: right -> left when x <= 0; rightward: left -> right when x >= 0; }} }}",
        field(right),
        field(left)
    )
}

/// A particle in two media; the claim is in the left mode.
pub(super) fn media(left: &str, right: &str) -> String {
    format!(
        "pub Media {{ coordinates {{ x; y; }} parameters {{ m1 > 0 = 1; m2 > 0 = 2; V = 1/5; }}
        modes {{ left {{ lagrangian = {left}; CLAIM }} right {{ lagrangian = {right}; }} }}
        transitions {{ rightward: left -> right when x >= 0; leftward: right -> left when x <= 0; }} }}"
    )
}

/// A particle in grooves of different directions on both sides of `x = 0`; the claim is in the left mode.
pub(super) fn grooves(left: &str, right: &str) -> String {
    format!(
        "pub Grooves {{ coordinates {{ x; y; }} lagrangian = (dot(x)^2 + dot(y)^2)/2;
        modes {{ left {{ constraints {{ groove: {left}; }} CLAIM }} right {{ constraints {{ groove: {right}; }} }} }}
        transitions {{ rightward: left -> right when x >= 0; }} }}"
    )
}

/// A wheel that passes from one spoke to the next, by a reset into a mode with another metric.
pub(super) fn spokes(rate: &str) -> String {
    format!(
        "pub Spokes {{ coordinates {{ x; }} parameters {{ l1 > 0 = 1.7; l2 > 0 = 1.9; h > 0 = 0.65; g > 0 = 1; }}
        let pendulum(r) = r^2*dot(x)^2/2 - g*r*cos(x);
        modes {{ first {{ lagrangian = pendulum(l1); CLAIM }} second {{ lagrangian = pendulum(l2); }} }}
        transitions {{ step: first -> second when x <= -h => reset {{ x = x + 2*h; dot(x) = {rate}; }}; }} }}"
    )
}
