//! Random declarations with claims whose truth is known by construction.

use crate::draw::Draw;
use crate::function::{Function, bump, function, number, shifted};

use Function::{Coordinate, Product, Sum};

/// A claim about a declaration, with its truth.
#[derive(Debug, Clone)]
pub struct Case {
    /// The family that it comes from.
    pub family: &'static str,
    /// Everything but the claim.
    pub declarations: String,
    /// The claim.
    pub claim: String,
    /// True if the claim is true.
    pub is_true: bool,
    /// True if one of the methods of `docs/proofs.md` decides the claim; otherwise it may stay open.
    pub is_decidable: bool,
}

/// A case of a random family.
pub fn case(draw: &mut Draw) -> Case {
    match draw.below(8) {
        0 | 1 => potential(draw),
        2 => leaf(draw),
        3 => quantity(draw),
        4 => systems(draw),
        5 => gauge(draw),
        6 => exceptional(draw),
        _ => wall(draw),
    }
}

const NAMES: [&str; 5] = ["x", "th", "s", "ph", "w"];
const IS_ANGLE: [bool; 5] = [false, true, false, true, false];

fn coordinates(count: usize) -> String {
    let each = (0..count).map(|i| match IS_ANGLE[i] {
        true => format!("{}: angle; ", NAMES[i]),
        false => format!("{}; ", NAMES[i]),
    });
    format!("coordinates {{ {}}}", each.collect::<String>())
}

fn flat(count: usize) -> String {
    let terms: Vec<String> = NAMES[..count]
        .iter()
        .map(|name| format!("dot({name})^2"))
        .collect();
    format!("lagrangian = ({})/2;", terms.join(" + "))
}

/// A drag along `x` that grows with the other velocities: `-dot(x)*alpha(qdot)*d(x)` with a form alpha without `d(x)`.
/// A density `exp(G)` needs `dG = alpha`.
fn potential(draw: &mut Draw) -> Case {
    let count = 3 + draw.below(3);
    let which: Vec<usize> = (1..count).collect();
    // NOTE: the drawn function may be constant, like the product of `exp(cos(th)^2)` and `exp(sin(th)^2)`. The sine
    // keeps the force from being zero, which would be refused.
    let sine = Function::Sin(Box::new(Coordinate(1)));
    let potential = Sum(vec![function(draw, &IS_ANGLE, &which, 2), sine]);
    let mut slopes: Vec<Vec<Function>> = which
        .iter()
        .map(|i| potential.slope(*i).into_iter().collect())
        .collect();
    let kind = draw.below(5);
    let mut is_smooth = true;
    match kind {
        // A constant slope along an angle: the form is closed, but has a period.
        1 => {
            let size = draw.choice(&["1", "1/7", "1e-3", "1e-9"]);
            slopes[0].push(number(size));
        }
        // A curl, everywhere.
        2 => {
            let size = draw.choice(&["1", "1e-3", "1e-9", "1e-15"]);
            let place = Coordinate(2);
            slopes[0].push(Product(vec![number(size), place]));
        }
        // A curl in a box.
        3 => {
            let lines: Vec<usize> = which.iter().copied().filter(|i| !IS_ANGLE[*i]).collect();
            let mut factors = vec![number(draw.choice(&["1", "1/100"])), bump(draw, &lines)];
            factors.push(Coordinate(2));
            slopes[0].push(Product(factors));
            is_smooth = false;
        }
        // The form stays exact: the slope along a line depends on that coordinate only.
        4 => slopes[1].push(shifted(draw, 2)),
        _ => {}
    }
    let rates: Vec<String> = which
        .iter()
        .zip(&slopes)
        .filter(|(_, slope)| !slope.is_empty())
        .map(|(i, slope)| format!("{}*dot({})", Sum(slope.clone()).text(&NAMES), NAMES[*i]))
        .collect();
    let rates = match rates.is_empty() {
        true => "dot(s)".to_owned(),
        false => rates.join(" + "),
    };
    let truth = match kind {
        1 => "locally_exact",
        2 | 3 => "none",
        _ => "exact",
    };
    let claimed = match is_smooth {
        true => draw.choice(&["exact", "locally_exact", "none"]),
        false => "exact",
    };
    Case {
        family: "potential",
        declarations: format!(
            "{} {} forces {{ drag: -dot(x)*({rates})*d(x); }}",
            coordinates(count),
            flat(count)
        ),
        claim: format!("density: {claimed}"),
        is_true: claimed == truth,
        is_decidable: true,
    }
}

/// `dot(x) = f(x)*dot(y)`: there is no density if `f` has a zero and `y` is an angle, since leaves then wind towards a
/// circle.
fn leaf(draw: &mut Draw) -> Case {
    let place = draw.choice(&["0", "1/3", "40", "-700", "2.5"]);
    let x = format!("(x - ({place}))");
    let (f, has_zero) = draw.choice(&[
        ("U", true),
        ("U^2", true),
        ("tanh(U)", true),
        ("1/(1 + U^2) - 1/2", true),
        ("exp(-U^2) - 1/2", true),
        ("1/(1 + exp(-5*U)) - 1/3", true),
        ("U^3 + U", true),
        ("sin(U)", true),
        ("sqrt(1 + U^2) - 2", true),
        ("U*exp(U)", true),
        ("1 + U^2", false),
        ("2 + sin(U)", false),
        ("exp(U/100)", false),
        ("sqrt(2 + U^2) + U", false),
        ("U^4 - U^3 + 2", false),
        ("1/(1 + U^2) + 1/1000000", false),
        ("2 + tanh(U)", false),
        ("exp(-U^2) + 1/10", false),
    ]);
    let f = f.replace('U', &x);
    let is_circle = !draw.one_in(4);
    let claimed = draw.choice(&["exact", "none"]);
    let kind = if is_circle { "y: angle" } else { "y" };
    let has_density = !(has_zero && is_circle);
    Case {
        family: "leaf",
        declarations: format!(
            "coordinates {{ x; {kind}; }} lagrangian = (dot(x)^2 + dot(y)^2)/2;
            constraints {{ roll: dot(x) = ({f})*dot(y); }}"
        ),
        claim: format!("density: {claimed}"),
        is_true: claimed == "exact" && has_density,
        is_decidable: claimed == "none" || !has_zero,
    }
}

/// Energy and momentum under a force that is identically 0, acts only in a box, or is small.
fn quantity(draw: &mut Draw) -> Case {
    let count = 3;
    let lines = [0, 2];
    let strength = function(draw, &IS_ANGLE, &[0, 1, 2], 1);
    let direction = draw.below(count);
    let (factor, acts) = match draw.below(6) {
        0 => (bump(draw, &lines).text(&NAMES), true),
        1 => (
            draw.choice(&["1", "1e-6", "1e-12", "1e-18"]).to_owned(),
            true,
        ),
        2 => {
            // The product of a ramp and the opposite ramp is 0.
            let ramp = shifted(draw, 0);
            let back = Product(vec![number("-1"), Sum(vec![ramp.clone()])]);
            let product = Product(vec![
                Function::Ramp(Box::new(ramp)),
                Function::Ramp(Box::new(back)),
            ]);
            (product.text(&NAMES), false)
        }
        3 => {
            let inner = function(draw, &IS_ANGLE, &[0, 1, 2], 1).text(&NAMES);
            (format!("(sin({inner})^2 + cos({inner})^2 - 1)"), false)
        }
        4 => {
            let inner = function(draw, &IS_ANGLE, &[0, 1, 2], 1).text(&NAMES);
            (format!("(abs({inner}) - sqrt(({inner})^2))"), false)
        }
        _ => {
            let [a, b] = [(); 2].map(|()| function(draw, &IS_ANGLE, &[0, 1, 2], 1).text(&NAMES));
            (
                format!("(({a} + {b})^2 - ({a} - {b})^2 - 4*{a}*{b})"),
                false,
            )
        }
    };
    // NOTE: the amplitude is never 0.
    let amplitude = match strength {
        Function::Number(_) => "1".to_owned(),
        other => format!("(2 + sin({}))", other.text(&NAMES)),
    };
    let name = NAMES[direction];
    // The force in the other two directions does no work.
    let [a, b] = [1, 2].map(|k| NAMES[(direction + k) % count]);
    let velocity = draw
        .choice(&["1", "-dot(V)", "-dot(V)^3"])
        .replace('V', name);
    let target = draw.choice(&["energy", "momentum"]);
    let target = match target {
        "momentum" => format!("momentum({name})"),
        other => other.to_owned(),
    };
    let is_negated = draw.one_in(2);
    Case {
        family: "quantity",
        declarations: format!(
            "{} {} forces {{ push: {amplitude}*{factor}*({velocity})*d({name}) + dot({a})*d({b}) - dot({b})*d({a}); }}",
            coordinates(count),
            flat(count)
        ),
        claim: format!(
            "{}conserved: {target}",
            if is_negated { "not " } else { "" }
        ),
        is_true: acts == is_negated,
        is_decidable: true,
    }
}

/// Known systems in other coordinates.
fn systems(draw: &mut Draw) -> Case {
    let a = draw.choice(&["0", "1/5", "1e-6", "-3"]);
    let (shear, stretch) = (
        draw.choice(&["0", "1", "-2/3"]),
        draw.choice(&["1", "3", "1/7"]),
    );
    // x = u + shear*sin(v), y = stretch*v
    let x = format!("(u + {shear}*sin(v))");
    let y = format!("({stretch}*v)");
    let claimed = draw.choice(&["exact", "none"]);
    let (declarations, has_density) = match draw.below(3) {
        // Chaplygin's sleigh has a density if and only if its centre of mass is over the blade.
        0 => (
            format!(
                "coordinates {{ u; v; th: angle; }} parameters {{ m > 0 = 1; J > 0 = 1; }}
                let slip = -dot({x})*sin(th) + dot({y})*cos(th);
                lagrangian = m/2*(dot({x})^2 + dot({y})^2) + (J + m*({a})^2)/2*dot(th)^2 + ({a})*m*dot(th)*slip;
                constraints {{ blade: slip = 0; }}"
            ),
            a == "0",
        ),
        // A rolling disk.
        1 => (
            format!(
                "coordinates {{ u; v; th: angle; ph: angle; }} parameters {{ m > 0 = 1; R > 0 = 1; }}
                lagrangian = m/2*(dot({x})^2 + dot({y})^2) + m*R^2/4*dot(th)^2 + m*R^2/8*dot(ph)^2;
                constraints {{ a: dot({x}) = R*cos(ph)*dot(th); b: dot({y}) = R*sin(ph)*dot(th); }}"
            ),
            true,
        ),
        // A particle on the contact distribution.
        _ => (
            format!(
                "coordinates {{ u; v; z; }} lagrangian = (dot({x})^2 + dot({y})^2 + dot(z)^2)/2;
                constraints {{ c: dot(z) = {y}*dot({x}); }}"
            ),
            true,
        ),
    };
    Case {
        family: "systems",
        declarations,
        claim: format!("density: {claimed}"),
        is_true: (claimed == "exact") == has_density,
        is_decidable: true,
    }
}

/// Translations of a Lagrangian with an added form. They are symmetries if and only if the Lie derivative of the form
/// along them is closed.
fn gauge(draw: &mut Draw) -> Case {
    let count = 3;
    let added = function(draw, &IS_ANGLE, &[0, 1, 2], 2);
    let mut terms: Vec<String> = (0..count)
        .filter_map(|i| {
            Some(format!(
                "{}*dot({})",
                added.slope(i)?.text(&NAMES),
                NAMES[i]
            ))
        })
        .collect();
    let kind = draw.below(3);
    match kind {
        1 => terms.push("x*dot(th)".to_owned()),
        2 => terms.push("sin(x)*dot(s)".to_owned()),
        _ => {}
    }
    terms.push("0".to_owned());
    let (translation, is_growing) =
        draw.choice(&[("partial(x)", false), ("partial(x) + t*partial(x)", true)]);
    Case {
        family: "gauge",
        declarations: format!(
            "{} lagrangian = (dot(x)^2 + dot(th)^2 + dot(s)^2)/2 + {};",
            coordinates(count),
            terms.join(" + ")
        ),
        claim: format!("symmetry: {translation}"),
        // Along the growing translation `x*dot(th)` changes by `(1 + t)*dot(th)`, whose form is not closed.
        is_true: match kind {
            1 => !is_growing,
            2 => false,
            _ => true,
        },
        is_decidable: true,
    }
}

/// A parameter whose default may be 0. At 0 no density exists.
fn exceptional(draw: &mut Draw) -> Case {
    let (value, is_zero) =
        draw.choice(&[("0", true), ("1", false), ("1/3", false), ("1e-9", false)]);
    let drag = draw.choice(&["c", "c*(2 + sin(y))", "c*exp(-y^2)"]);
    let claimed = draw.choice(&["exact", "none"]);
    let has_density = !is_zero && drag == "c";
    Case {
        family: "exceptional",
        declarations: format!(
            "coordinates {{ x; y; }} parameters {{ k >= 0 = {value}; c > 0 = 1; }}
            lagrangian = (dot(x)^2 + dot(y)^2)/2;
            constraints {{ belt: dot(x) = k; }} forces {{ drag: -{drag}*dot(y)*d(y); }}"
        ),
        claim: format!("density: {claimed}"),
        is_true: (claimed == "exact") == has_density,
        is_decidable: false,
    }
}

/// Elastic impacts on a part of a curve.
fn wall(draw: &mut Draw) -> Case {
    let side = draw.choice(&["x > 0", "x < 0", "x > 2", "y > 1"]);
    let (quantity, holds) = draw.choice(&[
        ("energy", true),
        ("dot(y)", true),
        ("dot(x)^2", true),
        ("dot(x)", false),
        ("x*dot(y)", true),
        ("dot(x)*dot(y)", false),
        ("(x - 3)*dot(x)", true),
    ]);
    // The wall is at -3 for `x < 0`, and at both 3 and -3 for `y > 1`.
    let is_other = side == "x < 0" || side == "y > 1";
    let holds = holds && !(quantity.starts_with("(x - 3)") && is_other);
    let is_negated = draw.one_in(2);
    Case {
        family: "wall",
        declarations: format!(
            "coordinates {{ x; y; }} lagrangian = (dot(x)^2 + dot(y)^2)/2;
            impacts {{ w: (x - 3)*(x + 3) <= 0 when {side}; }}"
        ),
        claim: format!(
            "{}conserved under w: {quantity}",
            if is_negated { "not " } else { "" }
        ),
        is_true: holds != is_negated,
        is_decidable: false,
    }
}
