//! True claims of models are proved. False claims are refuted at their line, with numbers that can be verified: negated
//! claims, and claims with a wrong sign, parameter, exponent or component.
//!
//! `dalembert_tests::witness` compares the numbers of a message with finite differences along the emitted motion, with
//! the emitted impact, and with brackets in double precision.

use dalembert::{Instance, StateVector};
use dalembert_codegen::claims::Verdict;
use dalembert_stability::text::{Large, shipped};
use dalembert_tests::claim::{Declaration, Witness, refusal};
use dalembert_tests::numeric::Numeric;
use dalembert_tests::sampling::{every_system, states};
use dalembert_tests::witness;

/// The message of a claim. It must refute the claim and point at its line.
#[track_caller]
fn refuted(declaration: &Declaration, claim: &str) -> String {
    let (source, line) = declaration.claiming(claim);
    let (message, lines) = refusal(&source);
    assert_eq!(lines, [line, line], "{message}");
    assert!(message.contains("` is refuted: "), "{message}");
    assert!(message.contains("\nhelp: "), "{message}");
    message
}

/// Claims that contradict a true one.
fn contradictions(claim: &str) -> Vec<String> {
    let words: Vec<&str> = claim.split_whitespace().collect();
    match words.as_slice() {
        ["density", ":", word] => ["exact", "locally_exact", "none"]
            .iter()
            .filter(|other| *other != word)
            .map(|other| format!("density: {other}"))
            .collect(),
        ["not", ..] => vec![words[1..].join(" ")],
        ["conserved", ..] => vec![format!("not {}", words.join(" "))],
        // Stated densities and symmetries have no negation; the tests below perturb them. `codegen/tests/hybrid_claims`
        // perturbs claims about motion and impacts together.
        [
            "density" | "symmetry" | "volume" | "symplectic" | "energy" | "integrable"
            | "involution",
            ..,
        ] => Vec::new(),
        other => panic!("{other:?}"),
    }
}

struct Contradicted {
    claims: usize,
    messages: usize,
    examples: usize,
}

impl Contradicted {
    fn contradict(&mut self, system: &Large) {
        let declaration = Declaration::of(&Instance::description(system).source);
        for claim in &declaration.claims {
            let proved = declaration.verdict(claim).verdict;
            assert!(matches!(proved, Verdict::Proved(_)), "{claim}: {proved:?}");
            self.claims += 1;
            for wrong in contradictions(claim) {
                let message = refuted(&declaration, &wrong);
                match Witness::of(&message) {
                    Some(_) => witness::check(&mut system.clone(), &wrong, &message),
                    None => holds_numerically(system, claim, &message),
                }
                if let Some(example) = Witness::example(&message) {
                    witness::check_example(&mut system.clone(), claim, &example);
                    self.examples += 1;
                }
                self.messages += 1;
            }
        }
    }
}

/// Asserts that a claim holds at random states. It is called if the refutation of a contradiction shows no numbers.
fn holds_numerically(system: &Large, claim: &str, message: &str) {
    let (head, value) = claim.split_once(':').expect("a claim");
    for state in states(&system.global().expect("the global form"), 5, 31) {
        let state = state.as_slice();
        let here = system.snapshot(0.3, state);
        let size = 1.0 + here.energy.abs();
        if head.trim() == "density" {
            let Some((_, potential)) = message.split_once("with G = ") else {
                // If G has no closed form, its differential must be closed; one state is enough.
                let curl = witness::curl(system, &here.q);
                assert!(curl < 1e-5, "{message}: {curl}");
                return;
            };
            // dG/dt + div = 0
            let potential = potential.lines().next().expect("a density");
            let potential = potential.split("; tested at").next().expect("a density");
            let divergence = system.report(0.3, state).number("divergence_mu_C");
            let rate = match potential {
                "0" => 0.0,
                other => witness::rate_of_potential(system, other, 0.3, state),
            };
            assert!(
                (rate + divergence).abs() < 1e-7,
                "{message}: {rate} {divergence}"
            );
        } else if let Some((_, surface)) = head.split_once("under") {
            let law = dalembert::law::Law::Elastic;
            let after = system.impact(surface.trim(), law, 0.3, state);
            let after = system.snapshot(0.3, &after);
            let [old, new] =
                [&here, &after].map(|snapshot| witness::at(system, value, snapshot, None));
            assert!((new - old).abs() < 1e-11 * size, "{claim}: {old} {new}");
        } else {
            let rate = witness::rate(system, value, 0.3, state);
            assert!(rate.abs() < 1e-7 * size, "{claim}: {rate}");
        }
    }
}

#[test]
fn what_contradicts_a_claim_of_a_shipped_model_is_refuted() {
    let mut contradicted = Contradicted {
        claims: 0,
        messages: 0,
        examples: 0,
    };
    for system in every_system() {
        contradicted.contradict(system);
    }
    assert!(contradicted.claims >= 35, "{} claims", contradicted.claims);
    assert!(
        contradicted.messages >= 35,
        "{} messages",
        contradicted.messages
    );
    let examples = contradicted.examples;
    assert!(examples >= 10, "{examples} examples");
}

/// Asserts that every claim is refuted, with a state whose numbers are right.
#[track_caller]
fn all_refuted(model: &str, claims: &[&str]) {
    let mut system = shipped(model).sized::<32>();
    let declaration = Declaration::of(&Instance::description(&system).source);
    for claim in claims {
        let message = refuted(&declaration, claim);
        witness::check(&mut system, claim, &message);
    }
}

#[test]
fn the_density_of_the_sleigh_has_one_exponent() {
    all_refuted(
        "chaplygin_sleigh",
        &[
            // The exponent in W. Clark's thesis, which counts the divergence three times (5.10).
            "density = 1/abs(dot(theta))^3",
            "density = 1/dot(theta)^2",
            "density = 1/sqrt(abs(dot(theta)))",
            "density = abs(dot(theta))",
            "density = 1",
            "density = 1/abs(dot(x))",
            "density = 1/abs(dot(theta)*(1 + x^2))",
            "density = exp(a*x)/abs(dot(theta))",
            "density = cos(theta)^2/abs(dot(theta))",
        ],
    );
    all_refuted(
        "chaplygin_sleigh",
        &["density: exact", "density: locally_exact"],
    );
}

#[test]
fn stated_densities_must_balance_the_divergence() {
    all_refuted(
        "rolling_disk",
        &[
            "density = 1 + x^2",
            "density = 1/abs(dot(x))",
            "density = exp(cos(phi))",
        ],
    );
    all_refuted(
        "rolling_ball_euler",
        &["density = sin(theta)", "density = 1/(1 + x^2 + y^2)"],
    );
    all_refuted(
        "holonomic_bead_on_ellipses",
        &[
            "density = 1",
            "density = x^2/A^4 + y^2/B^4 + 1",
            "density = sqrt(x^2/A^4 + y^2/B^4)",
        ],
    );
    all_refuted(
        "harmonic_oscillator",
        &["density = 1 + x^2", "density = m/2*dot(x)^2 - k/2*x^2"],
    );
}

#[test]
fn energies_with_a_wrong_sign_or_parameter_change() {
    all_refuted(
        "harmonic_oscillator",
        &[
            "conserved: m/2*dot(x)^2 - k/2*x^2",
            "conserved: m/2*dot(x)^2 + 2*k/2*x^2",
            "conserved: k/2*dot(x)^2 + 3*m/2*x^2",
        ],
    );
    all_refuted(
        "bouncing_ball",
        &[
            "conserved: m/2*dot(x)^2 - m*g*x",
            "conserved: energy + m*x",
            "conserved under floor: energy + dot(x)",
            "conserved under floor: dot(x)",
        ],
    );
    all_refuted(
        "double_pendulum",
        &[
            "conserved: energy + 2*m1*g*l1*cos(theta1)",
            "conserved: energy + m2*g*(l1*cos(theta1) + l2*cos(theta2))",
            "conserved: energy - (m1 + m2)*l1^2*dot(theta1)^2",
            "conserved: momentum(theta1)",
            "conserved: momentum(theta1) + momentum(theta2)",
        ],
    );
    all_refuted("chain2", &["conserved: energy + 2*m*g*l*cos(theta[1])"]);
    all_refuted(
        "chaplygin_sleigh",
        &[
            "conserved: energy - m*dot(x)^2",
            "conserved: energy - (I + m*a^2)*dot(theta)^2",
            "conserved: energy - a*m*dot(theta)*(dot(y)*cos(theta) - dot(x)*sin(theta)) + I*dot(theta)^2/2",
            "conserved: dot(theta)",
            "conserved: momentum(theta)",
            "conserved: (I + 2*m*a^2)*dot(theta)^2/2 + m/2*(dot(x)^2 + dot(y)^2)",
            "conserved under front_tip: energy - I*dot(theta)^2",
            "conserved under front_tip: dot(x)*cos(theta) + dot(y)*sin(theta)",
            "conserved under back_tip: dot(theta)",
        ],
    );
}

#[test]
fn momenta_with_a_wrong_parameter_change() {
    all_refuted(
        "rolling_disk",
        &[
            "conserved: momentum(x)",
            "conserved: dot(x) - I*cos(phi)*dot(phi)",
            "conserved: y*dot(theta) + R*sin(phi)*dot(phi)",
            "conserved under leading_edge: dot(theta)",
            "conserved under leading_edge: dot(phi)",
            "conserved under leading_edge: energy - J*dot(phi)^2",
            "conserved under trailing_edge: (I + 2*m*R^2)*dot(theta)^2 + J*dot(phi)^2",
        ],
    );
    all_refuted(
        "rolling_ball_euler",
        &[
            "conserved: dot(phi)*cos(theta) - dot(psi)",
            "conserved: dot(phi) + dot(psi)",
            "conserved under table_edge: dot(x)",
            "conserved under table_edge: dot(phi) + dot(psi)*cos(theta)",
        ],
    );
    all_refuted(
        "ball_on_rotating_table",
        &["conserved: dot(phi)*cos(theta) - dot(psi)"],
    );
    all_refuted(
        "holonomic_bead_on_ellipses",
        &[
            "conserved: x^2/A^2 - y^2/B^2",
            "conserved: x^2/B^2 + y^2/A^2",
            "conserved: dot(x)",
            "conserved under line: dot(y)",
        ],
    );
    all_refuted(
        "point_billiard",
        &[
            "conserved: x*dot(y)",
            "conserved under wall: x*dot(y) - y*dot(x)",
            "conserved under wall: x*dot(y)/tb^2 - y*dot(x)/ta^2",
            "conserved under wall: dot(x)^2 - dot(y)^2",
        ],
    );
    all_refuted(
        "two_wheels_rod",
        &[
            "conserved: x1 - r2*theta1",
            "conserved under rod_max: dot(theta1)",
            "conserved under rod_max: r1*dot(theta1) - r2*dot(theta2)",
        ],
    );
}

#[test]
fn fields_with_a_wrong_sign_or_a_component_less_are_no_symmetries() {
    all_refuted(
        "rolling_disk",
        &[
            "symmetry: partial(phi) + y*partial(x) + x*partial(y)",
            "symmetry: partial(phi) - y*partial(x) - x*partial(y)",
            "symmetry: partial(phi) + y*partial(x) - x*partial(y)",
            "symmetry: y*partial(x) - x*partial(y)",
            "symmetry: partial(phi)",
            "symmetry: partial(phi) - y*partial(x)",
            "symmetry: R*partial(x) + y*partial(theta)",
        ],
    );
    all_refuted(
        "chaplygin_sleigh",
        &[
            "symmetry: partial(theta) + y*partial(x) + x*partial(y)",
            "symmetry: partial(theta) + y*partial(x) - x*partial(y)",
            "symmetry: partial(theta)",
            "symmetry: x*partial(y) - y*partial(x)",
            "symmetry: partial(theta) - y*partial(x)",
            // The vector field of W. Clark's thesis (V.35), with the sign that is printed there.
            "symmetry: partial(theta) - a*sin(theta)*partial(x) - a*cos(theta)*partial(y)",
        ],
    );
    all_refuted(
        "double_pendulum",
        &[
            "symmetry: partial(theta1)",
            "symmetry: partial(theta1) + partial(theta2)",
        ],
    );
    all_refuted(
        "harmonic_oscillator",
        &["symmetry: partial(x)", "symmetry: x*partial(x)"],
    );
    all_refuted("point_billiard", &["symmetry: y*partial(x) + x*partial(y)"]);
    all_refuted("holonomic_bead_on_ellipses", &["symmetry: partial(x)"]);
}
