//! The systems of `reference/verdicts_visible.json` as a user writes them, each with what is true of it: that this file
//! compiles is the proof. That they are those systems is tested: metric, forms and potential agree at the golden point.

use dalembert_tests::claim::{Declaration, refusal};
use dalembert_tests::formula::{Scope, value};
use dalembert_tests::numeric::{Numeric, Snapshot};
use dalembert_tests::reference::{number, read};
use dalembert_tests::witness;
use serde_json::Value;

dalembert::model! {
    pub VerticalDisk {
        coordinates { x; y; theta: angle; phi: angle; }
        parameters { m > 0 = 2; I > 0 = 3; J > 0 = 5/7; R > 0 = 3/2; }
        lagrangian = m/2*(dot(x)^2 + dot(y)^2) + I/2*dot(theta)^2 + J/2*dot(phi)^2;
        constraints {
            rolling_x: dot(x) = R*cos(phi)*dot(theta);
            rolling_y: dot(y) = R*sin(phi)*dot(theta);
        }
        claims {
            density: exact;
            density = 1;
            conserved: energy;
            conserved: dot(theta);
            conserved: dot(phi);
        }
    }
}

dalembert::model! {
    pub Sleigh {
        coordinates { x; y; theta: angle; }
        parameters { m > 0 = 2; I > 0 = 3; a = 3/4; }
        let side = -sin(theta)*dot(x) + cos(theta)*dot(y);
        lagrangian = m/2*(dot(x)^2 + dot(y)^2) + a*m*dot(theta)*side + (I + m*a^2)/2*dot(theta)^2;
        constraints { blade: side = 0; }
        claims {
            density: none;
            density = 1/abs(dot(theta));
            conserved: energy;
            not conserved: dot(theta);
        }
    }
}

dalembert::model! {
    pub SleighBalancedKnifeEdge {
        coordinates { x; y; theta: angle; }
        parameters { m > 0 = 2; I > 0 = 3; }
        lagrangian = m/2*(dot(x)^2 + dot(y)^2) + I/2*dot(theta)^2;
        constraints { blade: -sin(theta)*dot(x) + cos(theta)*dot(y) = 0; }
        claims {
            density: exact;
            density = 1;
            conserved: energy;
            conserved: dot(theta);
        }
    }
}

dalembert::model! {
    pub KnifeEdgeOnIncline {
        coordinates { x; y; theta: angle; }
        parameters { m > 0 = 2; I > 0 = 3; gr = 1; }
        lagrangian = m/2*(dot(x)^2 + dot(y)^2) + I/2*dot(theta)^2 + 3/5*m*gr*x;
        constraints { blade: -sin(theta)*dot(x) + cos(theta)*dot(y) = 0; }
        claims {
            density: exact;
            density = 1;
            conserved: energy;
            conserved: dot(theta);
            not conserved: dot(x)*cos(theta) + dot(y)*sin(theta);
        }
    }
}

dalembert::model! {
    pub NhParticle {
        coordinates { x; y; z; }
        lagrangian = (dot(x)^2 + dot(y)^2 + dot(z)^2)/2;
        constraints { slope: d(z) - y*d(x) = 0; }
        claims {
            density: exact;
            density = sqrt(1 + y^2);
            conserved: energy;
            conserved: dot(y);
            conserved: sqrt(1 + y^2)*dot(x);
        }
    }
}

dalembert::model! {
    pub NhParticleExp {
        coordinates { x; y; z; }
        lagrangian = (dot(x)^2 + dot(y)^2 + dot(z)^2)/2;
        constraints { slope: d(z) - exp(y)*d(x) = 0; }
        claims {
            density: exact;
            density = sqrt(1 + exp(2*y));
            conserved: energy;
            conserved: sqrt(1 + exp(2*y))*dot(x);
        }
    }
}

dalembert::model! {
    pub NhParticleSum {
        coordinates { x; y; z; }
        lagrangian = (dot(x)^2 + dot(y)^2 + dot(z)^2)/2;
        constraints { slope: d(z) - (x + y)*d(x) = 0; }
        claims {
            density: none;
            density = sqrt(1 + (x + y)^2)/abs(dot(x) + dot(y));
            conserved: energy;
            conserved: dot(y);
        }
    }
}

dalembert::model! {
    pub Heisenberg {
        coordinates { x; y; z; }
        lagrangian = (dot(x)^2 + dot(y)^2 + dot(z)^2)/2;
        constraints { contact: d(z) + y/2*d(x) - x/2*d(y) = 0; }
        claims {
            density: exact;
            density = 1;
            conserved: energy;
            symmetry: y*partial(x) - x*partial(y);
        }
    }
}

dalembert::model! {
    pub HeisenbergAniso {
        coordinates { x; y; z; }
        parameters { m1 > 0 = 2; m2 > 0 = 3; }
        lagrangian = (m1*dot(x)^2 + m2*dot(y)^2 + dot(z)^2)/2;
        constraints { contact: d(z) + y/2*d(x) - x/2*d(y) = 0; }
        claims {
            density: exact;
            density = 1;
            conserved: energy;
        }
    }
}

dalembert::model! {
    pub MartinetFlat {
        coordinates { x; y; z; }
        lagrangian = (dot(x)^2 + dot(y)^2 + dot(z)^2)/2;
        constraints { slope: d(z) - y^2*d(x) = 0; }
        claims {
            density: exact;
            density = sqrt(1 + y^4);
            conserved: energy;
            conserved: dot(y);
        }
    }
}

dalembert::model! {
    pub HolonomicRescaled {
        coordinates { x; y; z; }
        lagrangian = (dot(x)^2 + dot(y)^2 + dot(z)^2)/2;
        constraints { ellipsoid: exp(z)*(x*d(x) + 2*y*d(y) + 3*z*d(z)) = 0; }
        claims {
            density: exact;
            density = exp(z)*(x^2 + 4*y^2 + 9*z^2);
            conserved: energy;
            conserved: x^2 + 2*y^2 + 3*z^2;
        }
    }
}

dalembert::model! {
    pub HelicalCircle {
        coordinates { phi: angle; x; z; }
        parameters { k = 1/3; b > 0 = 1; }
        let slip = dot(z) - k*z*dot(phi) - b*dot(x);
        lagrangian = (dot(phi)^2 + dot(x)^2 + slip^2)/2;
        constraints { screw: slip = 0; }
        claims {
            density: locally_exact;
            conserved: energy;
        }
    }
}

dalembert::model! {
    pub Suslov {
        coordinates { phi: angle; theta in (0, pi); psi: angle; }
        parameters { I11 > 0 = 3; I22 > 0 = 4; I33 > 0 = 5; I12 = 1/2; I13 = 1/3; I23 = 1/4; }
        let w1 = sin(theta)*sin(psi)*dot(phi) + cos(psi)*dot(theta);
        let w2 = sin(theta)*cos(psi)*dot(phi) - sin(psi)*dot(theta);
        let w3 = cos(theta)*dot(phi) + dot(psi);
        lagrangian = (I11*w1^2 + I22*w2^2 + I33*w3^2)/2 + I12*w1*w2 + I13*w1*w3 + I23*w2*w3;
        constraints { no_spin: w3 = 0; }
        claims {
            density: none;
            density = 1/abs(I13*w1 + I23*w2);
            conserved: energy;
            conserved: (I11*w1^2 + I22*w2^2)/2 + I12*w1*w2;
        }
    }
}

dalembert::model! {
    pub Veselova {
        coordinates { phi: angle; theta in (0, pi); psi: angle; }
        parameters { I1 > 0 = 3; I2 > 0 = 4; I3 > 0 = 5; }
        let w1 = sin(theta)*sin(psi)*dot(phi) + cos(psi)*dot(theta);
        let w2 = sin(theta)*cos(psi)*dot(phi) - sin(psi)*dot(theta);
        let w3 = cos(theta)*dot(phi) + dot(psi);
        let mass = sin(theta)^2*(sin(psi)^2/I1 + cos(psi)^2/I2) + cos(theta)^2/I3;
        lagrangian = (I1*w1^2 + I2*w2^2 + I3*w3^2)/2;
        constraints { no_turn: dot(phi) + cos(theta)*dot(psi) = 0; }
        claims {
            density: exact;
            density = sqrt(mass);
            conserved: energy;
        }
    }
}

dalembert::model! {
    pub HomogeneousBall {
        coordinates { x; y; phi: angle; theta in (0, pi); psi: angle; }
        parameters { m > 0 = 2; I > 0 = 3; r > 0 = 5/4; }
        let w_x = cos(phi)*dot(theta) + sin(phi)*sin(theta)*dot(psi);
        let w_y = sin(phi)*dot(theta) - cos(phi)*sin(theta)*dot(psi);
        let w_z = dot(phi) + cos(theta)*dot(psi);
        lagrangian = m/2*(dot(x)^2 + dot(y)^2) + I/2*(w_x^2 + w_y^2 + w_z^2);
        constraints {
            rolling_x: dot(x) - r*w_y = 0;
            rolling_y: dot(y) + r*w_x = 0;
        }
        claims {
            density: exact;
            density = 1;
            conserved: energy;
            conserved: w_x;
            conserved: w_z;
        }
    }
}

dalembert::model! {
    pub ChaplyginSphere {
        coordinates { x; y; phi: angle; theta in (0, pi); psi: angle; }
        parameters { m > 0 = 2; I1 > 0 = 3; I2 > 0 = 4; I3 > 0 = 5; r > 0 = 5/4; }
        let w1 = sin(theta)*sin(psi)*dot(phi) + cos(psi)*dot(theta);
        let w2 = sin(theta)*cos(psi)*dot(phi) - sin(psi)*dot(theta);
        let w3 = cos(theta)*dot(phi) + dot(psi);
        lagrangian = m/2*(dot(x)^2 + dot(y)^2) + (I1*w1^2 + I2*w2^2 + I3*w3^2)/2;
        constraints {
            rolling_x: dot(x) - r*(sin(phi)*dot(theta) - cos(phi)*sin(theta)*dot(psi)) = 0;
            rolling_y: dot(y) + r*(cos(phi)*dot(theta) + sin(phi)*sin(theta)*dot(psi)) = 0;
        }
        claims {
            density: exact;
            conserved: energy;
        }
    }
}

dalembert::model! {
    pub FallingDisk {
        coordinates { x; y; phi: angle; theta in (0, pi); psi: angle; }
        parameters { m > 0 = 2; I1 > 0 = 3; I3 > 0 = 5; R > 0 = 5/4; gr = 1; }
        let w3 = cos(theta)*dot(phi) + dot(psi);
        let height = R*sin(theta);
        lagrangian = m/2*(dot(x)^2 + dot(y)^2 + dot(height)^2) - m*gr*height
            + I1/2*(dot(theta)^2 + sin(theta)^2*dot(phi)^2) + I3/2*w3^2;
        constraints {
            rolling_x: dot(x) + R*(cos(phi)*w3 - sin(phi)*sin(theta)*dot(theta)) = 0;
            rolling_y: dot(y) + R*(sin(phi)*w3 + cos(phi)*sin(theta)*dot(theta)) = 0;
        }
        claims {
            density: exact;
            conserved: energy;
        }
    }
}

dalembert::model! {
    pub RollerRacer {
        coordinates { x; y; theta: angle; phi: angle; }
        parameters { m > 0 = 2; I1 > 0 = 3; I2 > 0 = 1/2; a = 1; b > 0 = 1/2; }
        lagrangian = m/2*(dot(x)^2 + dot(y)^2) + I1/2*dot(theta)^2 + I2/2*(dot(theta) + dot(phi))^2;
        constraints {
            body: -sin(theta)*dot(x) + cos(theta)*dot(y) = 0;
            handle: -sin(theta + phi)*dot(x) + cos(theta + phi)*dot(y) + (a*cos(phi) - b)*dot(theta) = b*dot(phi);
        }
        claims {
            density: none;
            density = sqrt(sin(phi)^2/m + a^2*cos(phi)^2/I1 + b^2/I2)/abs(dot(phi));
            conserved: energy;
        }
    }
}

dalembert::model! {
    pub BallInVerticalCylinder {
        coordinates { alpha: angle; z; phi: angle; theta in (0, pi); psi: angle; }
        parameters { m > 0 = 2; I > 0 = 3; r > 0 = 1/4; rho > 0 = 2; gr = 1; }
        let w_x = cos(phi)*dot(theta) + sin(phi)*sin(theta)*dot(psi);
        let w_y = sin(phi)*dot(theta) - cos(phi)*sin(theta)*dot(psi);
        let w_z = dot(phi) + cos(theta)*dot(psi);
        lagrangian = m/2*(rho^2*dot(alpha)^2 + dot(z)^2) + I/2*(w_x^2 + w_y^2 + w_z^2) - m*gr*z;
        constraints {
            around: rho*dot(alpha) + r*w_z = 0;
            up: dot(z) - r*(cos(alpha)*w_y - sin(alpha)*w_x) = 0;
        }
        claims {
            density: exact;
            density = 1;
            conserved: energy;
            conserved: dot(alpha);
        }
    }
}

/// Name in the file and model, in the order of the file.
fn systems() -> Vec<(&'static str, Box<dyn Numeric>)> {
    macro_rules! named {
        ($($name:literal $model:ident)*) => { vec![$(($name, Box::new($model::default()) as Box<dyn Numeric>),)*] };
    }
    named! {
        "vertical_disk" VerticalDisk
        "chaplygin_sleigh" Sleigh
        "sleigh_balanced_knife_edge" SleighBalancedKnifeEdge
        "knife_edge_on_incline" KnifeEdgeOnIncline
        "nh_particle" NhParticle
        "nh_particle_exp" NhParticleExp
        "nh_particle_sum" NhParticleSum
        "heisenberg" Heisenberg
        "heisenberg_aniso" HeisenbergAniso
        "martinet_flat" MartinetFlat
        "holonomic_rescaled" HolonomicRescaled
        "helical_circle" HelicalCircle
        "suslov" Suslov
        "veselova" Veselova
        "homogeneous_ball" HomogeneousBall
        "chaplygin_sphere" ChaplyginSphere
        "falling_disk" FallingDisk
        "roller_racer" RollerRacer
        "ball_in_vertical_cylinder" BallInVerticalCylinder
    }
}

/// A formula of the file as claims write it: `**` is a power, `x_dot` a velocity.
fn translated(formula: &Value, coordinates: &[&str]) -> String {
    let mut text = formula.as_str().expect("a formula").replace("**", "^");
    for name in coordinates {
        text = text.replace(&format!("{name}_dot"), &format!("dot({name})"));
    }
    text
}

/// A system of the file at its golden point.
struct Golden<'g> {
    system: &'g Value,
    coordinates: Vec<&'g str>,
    parameters: Vec<(&'g str, f64)>,
    q: Vec<f64>,
}

impl<'g> Golden<'g> {
    fn of(system: &'g Value) -> Self {
        let golden = &system["golden"];
        let text = |value: &'g Value| value.as_str().expect("a name");
        let list = |key: &str| system[key].as_array().expect("a list");
        let coordinates: Vec<&str> = list("coordinates")
            .iter()
            .map(|own| text(&own["name"]))
            .collect();
        let names = list("params").iter().map(|own| text(&own["name"]));
        Self {
            system,
            parameters: names
                .map(|name| (name, number(&golden["params"][name])))
                .collect(),
            q: coordinates
                .iter()
                .map(|name| number(&golden["point"][*name]))
                .collect(),
            coordinates,
        }
    }

    fn value(&self, formula: &Value, qdot: &[f64]) -> f64 {
        let state = Snapshot {
            t: 0.0,
            q: self.q.clone(),
            qdot: qdot.to_vec(),
            p: Vec::new(),
            energy: f64::NAN,
        };
        let scope = Scope {
            coordinates: &self.coordinates,
            parameters: &self.parameters,
            state: &state,
            partial: None,
        };
        value(&translated(formula, &self.coordinates), &scope)
    }

    /// `2 T` at a velocity that is the sum of the unit vectors of these coordinates.
    fn twice_kinetic(&self, units: &[usize]) -> f64 {
        let mut qdot = vec![0.0; self.q.len()];
        units.iter().for_each(|i| qdot[*i] += 1.0);
        2.0 * self.value(&self.system["kinetic"], &qdot)
    }
}

fn close(name: &str, own: f64, expected: f64) {
    let error = (own - expected).abs();
    assert!(
        error <= 1e-13 * (1.0 + expected.abs()),
        "{name}: {own} for {expected}"
    );
}

#[test]
fn the_declared_systems_are_those_of_the_file() {
    let file = read("verdicts_visible");
    let listed = file["systems"].as_array().expect("systems");
    let mut declared = systems();
    assert_eq!(declared.len(), listed.len());
    for ((name, model), system) in declared.iter_mut().zip(listed) {
        assert_eq!(system["name"], **name);
        let golden = Golden::of(system);
        let names: Vec<&str> = model
            .description()
            .coordinates
            .iter()
            .map(|own| own.name)
            .collect();
        assert_eq!(names, golden.coordinates, "{name}");
        for (parameter, value) in &golden.parameters {
            assert!(model.set(parameter, *value), "{name}: {parameter}");
        }
        let n = golden.q.len();
        let rest = vec![0.0; n];
        let state = model.state(0.0, &golden.q, &rest);
        let report = model.report(0.0, &state);
        let potential = golden.value(&system["potential"], &rest);
        close(name, report.number("energy"), potential);
        let metric = &report.0["metric"];
        for i in 0..n {
            for j in 0..n {
                let [both, first, second] =
                    [&[i, j][..], &[i], &[j]].map(|units| golden.twice_kinetic(units));
                close(name, metric[n * i + j], (both - first - second) / 2.0);
            }
        }
        let forms = system["eta"].as_array().expect("forms");
        assert_eq!(model.description().constraints.len(), forms.len());
        for (dual, form) in report.0["W"].chunks(n).zip(forms) {
            for (k, row) in metric.chunks(n).enumerate() {
                let own: f64 = row.iter().zip(dual).map(|(g, w)| g * w).sum();
                close(name, own, golden.value(&form[k], &rest));
            }
        }
    }
}

#[test]
fn densities_of_each_kind_are_claimed_where_the_file_has_them() {
    let file = read("verdicts_visible");
    let listed = file["systems"].as_array().expect("systems");
    for ((name, model), system) in systems().iter().zip(listed) {
        let verdict = &system["verdict"];
        let expected = match (&verdict["local_exists"], &verdict["global_exists"]) {
            (Value::Bool(true), Value::Bool(true)) => "exact",
            (Value::Bool(true), _) => "locally_exact",
            _ => "none",
        };
        let declaration = Declaration::of(model.description().source);
        let has = |claim: &str| declaration.claims.iter().any(|own| own.starts_with(claim));
        assert!(has(&format!("density : {expected}")), "{name}");
        assert!(has("conserved : energy"), "{name}");
        assert!(
            has("density =") || system["momentum_density"].is_null(),
            "{name}"
        );
    }
}

#[test]
fn what_contradicts_the_file_is_refuted() {
    for (name, model) in &mut systems() {
        let declaration = Declaration::of(model.description().source);
        let is_none = declaration.claims.iter().any(|own| own == "density : none");
        for word in ["exact", "locally_exact", "none"] {
            let claim = format!("density: {word}");
            if declaration.claims.contains(&format!("density : {word}")) {
                continue;
            }
            let (source, line) = declaration.claiming(&claim);
            let (message, lines) = refusal(&source);
            assert_eq!(lines, [line, line], "{name}");
            assert!(
                message.starts_with(&format!("`{claim}` is refuted: ")),
                "{message}"
            );
            if is_none || message.contains("\nperiod = ") {
                witness::check(model.as_mut(), &claim, &message);
            }
        }
    }
}

#[test]
fn energy_is_kept_by_the_emitted_motion_and_densities_balance_its_divergence() {
    for (name, model) in &systems() {
        let declaration = Declaration::of(model.description().source);
        let file = read("verdicts_visible");
        let listed = file["systems"].as_array().expect("systems");
        let system = listed
            .iter()
            .find(|own| own["name"] == **name)
            .expect("a system");
        let q = Golden::of(system).q;
        let qdot: Vec<f64> = (0..q.len()).map(|i| 0.4 - 0.3 * i as f64).collect();
        let state = model.projected(0.0, &q, &qdot);
        let rate = witness::rate(model.as_ref(), "energy", 0.0, &state);
        assert!(rate.abs() < 1e-9, "{name}: {rate}");
        let divergence = model.report(0.0, &state).number("divergence_mu_C");
        for claim in &declaration.claims {
            let Some(density) = claim.strip_prefix("density =") else {
                continue;
            };
            // Definitions of a model are not known outside of it.
            if density.contains('w') || density.contains("mass") {
                continue;
            }
            let rate = witness::rate(model.as_ref(), &format!("ln({density})"), 0.0, &state);
            assert!(
                (rate + divergence).abs() < 1e-8,
                "{name}: {rate} {divergence}"
            );
        }
    }
}
