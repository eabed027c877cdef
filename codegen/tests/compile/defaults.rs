//! Claims whose verdict is different at the declared defaults of the parameters.

use dalembert_codegen::compile;

const PARTICLE: &str = "pub Particle {
    coordinates { x; y; }
    parameters { k >= 0 = DEFAULT; c > 0 = 1; }
    lagrangian = dot(x)^2/2 + dot(y)^2/2;
    constraints { belt: dot(x) = k; }
    forces { drag: -c*dot(y)*d(y); }
    claims { CLAIM; }
}";

/// The messages of a declaration that is refused; empty if it is accepted.
fn messages(declaration: &str) -> String {
    let Err(refused) = compile(declaration.parse().expect("tokens")) else {
        return String::new();
    };
    refused
        .iter()
        .map(|refusal| refusal.message().to_owned())
        .collect()
}

fn particle(default: &str, claim: &str) -> String {
    let declaration = PARTICLE.replace("DEFAULT", default);
    messages(&declaration.replace("CLAIM", claim))
}

#[test]
fn a_density_that_has_a_pole_at_the_default_is_refused() {
    assert_eq!(particle("1/3", "density: exact"), "");
    let message = particle("0", "density: exact");
    assert!(message.contains("`density: exact` is refuted"), "{message}");
    assert!(message.contains("at the declared defaults"), "{message}");
    assert!(message.contains("k = 0"), "{message}");
    assert!(message.contains("delta"), "{message}");
}

/// A bead on a hoop that turns at the rate w: the energy in the frame at rest is conserved if w = 0.
#[test]
fn verdicts_name_defaults_at_which_a_quantity_is_conserved() {
    let bead = |default: &str, claim: &str| {
        format!(
            "pub Bead {{
                coordinates {{ theta: angle; }}
                parameters {{ w = {default}; g > 0 = 9.81; }}
                lagrangian = (dot(theta)^2 + w^2*sin(theta)^2)/2 + g*cos(theta);
                let lab = (dot(theta)^2 + w^2*sin(theta)^2)/2 - g*cos(theta);
                claims {{ {claim}; }}
            }}"
        )
    };
    let kept = "conserved at the declared defaults w = 0";
    let shown = |default: &str| {
        let text = bead(default, "not conserved: lab");
        let compiled = compile(text.parse().expect("tokens")).expect("a model");
        compiled.findings[0].note()
    };
    assert!(shown("0").contains(kept), "{}", shown("0"));
    assert!(
        !shown("1/2").contains("declared defaults"),
        "{}",
        shown("1/2")
    );
    let message = messages(&bead("0", "conserved: lab"));
    assert!(message.contains("`conserved: lab` is refuted"), "{message}");
    assert!(message.contains(kept), "{message}");
    let message = messages(&bead("1/2", "conserved: lab"));
    assert!(!message.contains("declared defaults"), "{message}");
}

#[test]
fn a_stated_density_without_value_at_the_default_is_no_theorem() {
    assert_eq!(particle("1/3", "density = exp(c*x/k)"), "");
    let message = particle("0", "density = exp(c*x/k)");
    assert!(message.contains("at the declared defaults"), "{message}");
}

#[test]
fn that_there_is_none_at_the_defaults_alone_is_not_refuted() {
    let message = particle("0", "density: none");
    assert!(
        message.contains("`density: none` is undecided"),
        "{message}"
    );
    assert!(message.contains("k = 0"), "{message}");
    let message = particle("1/3", "density: none");
    assert!(message.contains("`density: none` is refuted"), "{message}");
}

#[test]
fn an_obstruction_that_vanishes_at_the_defaults_is_refused() {
    let sleigh = "pub Sleigh {
        coordinates { x; y; theta: angle; }
        parameters { m > 0 = 1; I > 0 = 1; a = 1/2; b = DEFAULT; }
        let slip = -dot(x)*sin(theta) + dot(y)*cos(theta);
        lagrangian = m/2*(dot(x)^2 + dot(y)^2) + (I + m*(a+b)^2)/2*dot(theta)^2 + (a+b)*m*dot(theta)*slip;
        constraints { blade: slip = 0; }
        claims { density: none; }
    }";
    assert_eq!(messages(&sleigh.replace("DEFAULT", "1/3")), "");
    let message = messages(&sleigh.replace("DEFAULT", "-1/2"));
    assert!(message.contains("`density: none` is refuted"), "{message}");
    assert!(message.contains("a = 1/2, b = -1/2"), "{message}");
}
