//! Emitted implementations of `InvariantVolume`. Their text is the stored one. Their values are those of the
//! interpreter and of the reference, and the emitted motion preserves the volumes. There is none for a model without a
//! claim of a density, or if the logarithm of the density is neither a closed form nor an integral over the positions.
//! `golden.rs` says how to accept changes of the stored texts.

use dalembert::describe::Report;
use dalembert::math::larger;
use dalembert::{Described, Fault, Instance, InvariantVolume, StateVector, System};
use dalembert_models::{
    BallOnRotatingTable, HolonomicBeadOnEllipses, RollingBallEuler, RollingBallWall, RollingDisk,
    TwoWheelsRod,
};
use dalembert_tests::flow::Flow;
use dalembert_tests::golden;
use dalembert_tests::reference::{number, numbers, read};
use dalembert_tests::sampling::{Random, every_system, states};
use dalembert_tests::systems::{
    CurvedDual, FallingDisk, HelicalCircle, MixedDisk, NonholonomicParticle, OnePole, RouthSphere,
};
use dalembert_tests::volume::{WithVolume, divergence};

/// Calls a generic function for every system that claims a density and has one, in the order of [`every_system`].
macro_rules! of_each_claimed {
    ($function:ident) => {
        [
            $function::<BallOnRotatingTable>(),
            $function::<HolonomicBeadOnEllipses>(),
            $function::<RollingBallEuler>(),
            $function::<RollingBallWall>(),
            $function::<RollingDisk>(),
            $function::<TwoWheelsRod>(),
            $function::<FallingDisk>(),
            $function::<MixedDisk>(),
            $function::<NonholonomicParticle>(),
            $function::<HelicalCircle>(),
            $function::<CurvedDual>(),
            $function::<RouthSphere>(),
            $function::<OnePole>(),
        ]
    };
}

/// The emitted implementation of `InvariantVolume` for a declaration, formatted; empty if there is none.
fn emitted(source: &str) -> String {
    let tokens = dalembert_emit::try_expand(source.parse().expect("tokens")).expect(source);
    let mut file: syn::File = syn::parse2(tokens).expect("items");
    let items = std::mem::take(&mut file.items)
        .into_iter()
        .flat_map(|item| match item {
            syn::Item::Const(constant) => implementations(*constant.expr),
            other => vec![other],
        });
    let is_volume = |item: &syn::Item| {
        let syn::Item::Impl(item) = item else {
            return false;
        };
        let path = item.trait_.as_ref().map(|(path, _)| path);
        let last = path.and_then(|path| path.segments.last());
        last.is_some_and(|segment| segment.ident == "InvariantVolume")
    };
    file.items = items.filter(is_volume).collect();
    prettyplease::unparse(&file)
}

/// The items of a block.
fn implementations(block: syn::Expr) -> Vec<syn::Item> {
    let syn::Expr::Block(block) = block else {
        return Vec::new();
    };
    let statements = block.block.stmts.into_iter();
    let items = statements.filter_map(|statement| match statement {
        syn::Stmt::Item(item) => Some(item),
        _ => None,
    });
    items.collect()
}

#[test]
fn emitted_volumes_are_as_stored() {
    let compare = |name: &str, source: &str| golden::compare(name, &emitted(source));
    compare(
        "falling_disk_volume",
        FallingDisk::DESCRIPTION.source.value(),
    );
    compare("mixed_disk_volume", MixedDisk::DESCRIPTION.source.value());
}

/// Names of the reported quantities.
#[derive(Default)]
struct Names(Vec<String>);

impl Report for Names {
    fn scalar(&mut self, name: &str, _: f64) {
        self.0.push(name.to_owned());
    }
    fn vector(&mut self, name: &str, _: &[f64]) {
        self.0.push(name.to_owned());
    }
    fn matrix(&mut self, name: &str, _: usize, _: usize, _: &[f64]) {
        self.0.push(name.to_owned());
    }
}

fn name<S: Described + InvariantVolume>() -> &'static str {
    S::DESCRIPTION.name
}

#[test]
fn a_volume_is_emitted_and_reported_where_a_density_is_claimed_and_nowhere_else() {
    let mut with_volume = Vec::new();
    for system in every_system() {
        let description = system.description();
        let mut names = Names::default();
        let state = states(system, 1, 3)[0];
        system.inspect(0.0, &state, &mut names).expect("a state");
        let is_reported = names.0.iter().any(|name| name == "log_density");
        let is_emitted = !emitted(&description.source).is_empty();
        assert_eq!(is_emitted, is_reported, "{}", description.name);
        if is_emitted {
            with_volume.push(description.name);
        }
    }
    assert_eq!(with_volume, of_each_claimed!(name));
}

fn vector<S: Described>(values: &[f64]) -> S::Vector {
    S::Vector::of(values)
}

/// The largest divergence of the emitted motion with respect to the emitted volume, relative to its terms, or to 1 if
/// that is larger. `change` of the logarithm of the density is added to it.
fn divergence_of<S: Described + InvariantVolume>(change: fn(f64) -> f64) -> f64 {
    let system = S::with_defaults();
    let flow = Flow {
        system: &system,
        independent: S::INDEPENDENT,
    };
    let n = S::DESCRIPTION.coordinates.len();
    let log_volume = |t: f64, at: &[f64]| {
        let q = vector::<S>(&at[..n]);
        let density = system.log_density(t, &q).expect("a density");
        system.log_volume(t, &q).expect("a volume") + change(density)
    };
    let mut random = Random::new(5);
    let mut largest = 0.0_f64;
    for _ in 0..5 {
        let positions = (0..n).map(|_| (0.2, 1.3));
        let ranges = positions.chain(S::INDEPENDENT.iter().map(|_| (-1.0, 1.0)));
        let at: Vec<f64> = ranges.map(|(a, b)| random.within(a, b)).collect();
        let motion = |t: f64, at: &[f64]| flow.motion(t, at);
        let [sum, terms] = divergence(0.3, &at, motion, log_volume);
        largest = larger(largest, sum.abs() / terms.max(1.0));
    }
    largest
}

fn assert_kept<S: Described + InvariantVolume>() {
    let divergence = divergence_of::<S>(|_| 0.0);
    let name = S::DESCRIPTION.name;
    println!("{name} {divergence:.1e}");
    // The bound allows for the errors of two nested differences of eighth order.
    assert!(divergence < 1e-9, "{name}: {divergence:e}");
}

#[test]
fn emitted_volumes_are_kept_by_the_emitted_motion() {
    of_each_claimed!(assert_kept);
}

#[test]
fn other_densities_are_not_kept() {
    for divergence in [
        divergence_of::<FallingDisk>(|density| density),
        divergence_of::<NonholonomicParticle>(|density| 2.0 * density),
        divergence_of::<HelicalCircle>(|density| -density),
    ] {
        assert!(divergence > 1e-3, "{divergence:e}");
    }
}

fn assert_interpreted<S: Described + InvariantVolume>() {
    let interpreted = WithVolume::declared(S::DESCRIPTION.source.value()).expect("a volume");
    let system = S::with_defaults();
    let volume = interpreted.program.volume.as_ref().expect("functions");
    assert_eq!(S::INDEPENDENT, volume.independent);
    assert_eq!(S::IS_SINGLE_VALUED, volume.is_single_valued);
    let mut random = Random::new(17);
    for _ in 0..5 {
        let values = interpreted.configuration(&mut random);
        let q = vector::<S>(&values);
        let [density, total] = [
            interpreted.log_density(0.2, &values),
            interpreted.log_volume(0.2, &values),
        ];
        assert_eq!(system.log_density(0.2, &q), Ok(density));
        assert_eq!(system.log_volume(0.2, &q), Ok(total));
    }
}

#[test]
fn emitted_volumes_are_what_the_interpreter_executes() {
    assert_interpreted::<BallOnRotatingTable>();
    assert_interpreted::<HolonomicBeadOnEllipses>();
    assert_interpreted::<FallingDisk>();
    assert_interpreted::<MixedDisk>();
    assert_interpreted::<HelicalCircle>();
}

/// Compares differences of `log_density` between points with those in `invariant_densities.json`. Returns their number.
fn compare_densities<S: Described + InvariantVolume>() -> usize {
    let file = read("invariant_densities");
    let systems = file["systems"].as_array().expect("systems").iter();
    let mut compared = 0;
    for entry in systems.filter(|entry| entry["system"] == S::DESCRIPTION.name) {
        let mut system = S::with_defaults();
        for (k, parameter) in S::DESCRIPTION.parameters.iter().enumerate() {
            let value = entry["parameters"].get(parameter.name);
            system.set_parameter(k, value.map_or(system.parameter(k), number));
        }
        let points = entry["points"].as_array().expect("points");
        let densities = points.iter().map(|point| {
            let q = vector::<S>(&numbers(&point["q"]));
            let found = system.log_density(0.0, &q).expect("a density");
            [found, number(&point["g"])]
        });
        let densities: Vec<[f64; 2]> = densities.collect();
        for [found, expected] in &densities[1..] {
            let [first_found, first_expected] = densities[0];
            let error = (found - first_found) - (expected - first_expected);
            assert!(error.abs() < 1e-13, "{}: {error:e}", S::DESCRIPTION.name);
            compared += 1;
        }
    }
    compared
}

#[test]
fn densities_differ_as_the_listed_ones() {
    assert_eq!(compare_densities::<RollingDisk>(), 2);
    assert_eq!(compare_densities::<RollingBallEuler>(), 2);
    assert_eq!(compare_densities::<HolonomicBeadOnEllipses>(), 2);
}

#[test]
fn a_stated_density_is_emitted_as_stated() {
    let density = |y: f64| NonholonomicParticle {}.log_density(0.0, &[0.3, y, -0.7].into());
    for y in [-2.0_f64, 0.0, 0.6] {
        let expected = (3.0 * (1.0 + y * y).sqrt()).ln();
        assert!((density(y).expect("a density") - expected).abs() < 1e-15);
    }
}

#[test]
fn a_density_on_unwrapped_angles_says_so() {
    const { assert!(!HelicalCircle::IS_SINGLE_VALUED && FallingDisk::IS_SINGLE_VALUED) };
    let density = |phi: f64| HelicalCircle {}.log_density(0.0, &[phi, 0.3, -0.7].into());
    let turn =
        density(1.0 + std::f64::consts::TAU).expect("a density") - density(1.0).expect("a density");
    assert!((turn + std::f64::consts::TAU / 3.0).abs() < 1e-14, "{turn}");
}

/// The particle with these claims.
fn particle(claims: &str) -> String {
    format!(
        "Particle {{ coordinates {{ x; y; z; }} lagrangian = (dot(x)^2 + dot(y)^2 + dot(z)^2)/2;
            constraints {{ slope: dot(z) = y*dot(x); }} {claims} }}"
    )
}

#[test]
fn what_is_open_or_about_other_things_emits_no_volume() {
    for claims in [
        "",
        "claims { conserved: energy; conserved: dot(y); }",
        "claims { density = sqrt(1 + y^2)*dot(y)^2; }",
        "claims { assume density = sqrt(1 + y^2)*(2 + abs(x)/x); }",
    ] {
        assert_eq!(emitted(&particle(claims)), "", "{claims}");
    }
    let found = emitted(&particle("claims { density: exact; }"));
    assert!(found.contains("fn log_density"), "{found}");
    // A stated density needs no search.
    let stated = emitted(&particle("claims { density = sqrt(1 + y^2); }"));
    assert!(stated.contains("fn log_density"), "{stated}");
}

#[test]
fn a_density_without_a_formula_is_an_integral() {
    const { assert!(RouthSphere::IS_INTEGRAL && CurvedDual::IS_INTEGRAL && !FallingDisk::IS_INTEGRAL) };
    let sphere = RouthSphere::default();
    let (m, i, j, r, l) = (sphere.m, sphere.I, sphere.J, sphere.R, sphere.l);
    // Logarithm of Chaplygin's density of a body of revolution, ln det m - 1/2 ln(I J + m (r, I r)), with r from the
    // centre of mass to the point of contact.
    let expected = |q: &<RouthSphere as System>::Vector| {
        let (sin, cos) = q[3].sin_cos();
        let [across, along] = [r * sin, r * cos + l];
        let mut mass = Mass::default();
        let state = sphere
            .state_unchecked(0.0, q, &[0.0; 5].into())
            .expect("a state");
        sphere
            .inspect(0.0, &state, &mut mass)
            .expect("a regular state");
        let [a, b, c, d] = mass.0;
        (a * d - b * c).ln() - 0.5 * (i * j + m * (i * across * across + j * along * along)).ln()
    };
    let offset = |q: &<RouthSphere as System>::Vector| {
        sphere.log_density(0.0, q).expect("a density") - expected(q)
    };
    let reference = offset(&[0.4, -0.2, 0.3, 1.0, 0.7].into());
    for (phi, theta) in [(-2.0, 0.2), (3.0, 2.0), (0.0, 3.0), (40.0, 1.3)] {
        let difference = offset(&[0.1, 3.0, phi, theta, -0.7].into()) - reference;
        assert!(difference.abs() < 1e-12, "{phi} {theta}: {difference}");
    }
}

#[test]
fn an_integral_across_a_pole_is_a_fault() {
    let density = |x: f64| OnePole {}.log_density(0.0, &[x, 0.2, 0.1].into());
    let there = density(2.0).expect("a density") - density(0.5).expect("a density");
    assert!(there.is_finite());
    assert!(matches!(
        density(-1.0),
        Err(Fault::SingularConstraint { .. })
    ));
}

#[test]
fn a_density_that_is_no_integral_either_is_said_to_emit_nothing() {
    let source = "Damped { coordinates { x; } lagrangian = dot(x)^2/2;
        forces { drag: -dot(x)/(1 + t^4)*d(x); } claims { density: exact; } }";
    assert_eq!(emitted(source), "");
    let tokens = dalembert_emit::try_expand(source.parse().expect("tokens"));
    let text = tokens.expect("a model").to_string();
    assert!(
        text.contains("`InvariantVolume` is not implemented: G depends on time"),
        "{text}"
    );
}

/// The reported constraint mass matrix of two constraints.
#[derive(Default)]
struct Mass([f64; 4]);

impl Report for Mass {
    fn scalar(&mut self, _: &str, _: f64) {}
    fn vector(&mut self, _: &str, _: &[f64]) {}
    fn matrix(&mut self, name: &str, _: usize, _: usize, values: &[f64]) {
        if name == "constraint_mass" {
            self.0.copy_from_slice(values);
        }
    }
}

#[test]
fn dependent_velocities_that_do_not_follow_are_a_fault() {
    let system = MixedDisk::default();
    let q = [0.3, 0.4, 0.2, std::f64::consts::FRAC_PI_2].into();
    assert!(system.log_density(0.0, &q).is_ok());
    let fault = system.log_volume(0.0, &q);
    assert!(
        matches!(fault, Err(Fault::SingularConstraint { constraint: 1, condition }) if condition > 1e15),
        "{fault:?}"
    );
}
