//! Certificates of all shipped models and of the models below, checked by a program in another language that shares no
//! code with the generator.

use std::path::{Path, PathBuf};
use std::process::{Command, Output};

use dalembert_cli::{Exit, models};
use dalembert_tests::command;
use dalembert_tests::parallel;
use serde_json::Value;

dalembert::model! {
    /// The potential of the density contains a logarithm and is regular on the whole line of `x`.
    pub Spiral {
        coordinates { x; y; th: angle; }
        lagrangian = (dot(x)^2 + dot(y)^2 + dot(th)^2)/2;
        constraints { c: dot(x) = (x^2 + 1)*dot(th); }
        claims { density: exact; conserved: energy; }
    }
}

dalembert::model! {
    /// A density that grows along a moving belt.
    pub Belt {
        coordinates { x; y; }
        parameters { c > 0 = 1; k > 0 = 1; }
        lagrangian = (dot(x)^2 + dot(y)^2)/2;
        constraints { belt: dot(x) = k; }
        forces { drag: -c*dot(y)*d(y); }
        claims { density: exact; not conserved: energy; }
    }
}

dalembert::model! {
    /// A density that exists only on the universal cover.
    pub Winding {
        coordinates { x; y; th: angle; }
        lagrangian = (dot(x)^2 + dot(y)^2 + dot(th)^2)/2;
        constraints { c: dot(x) = x*dot(th); }
        claims { density: locally_exact; }
    }
}

dalembert::model! {
    /// A charge in a magnetic field. Translations along `x` change the Lagrangian by a total derivative.
    pub Charge {
        coordinates { x; y; }
        parameters { e > 0 = 1/2; }
        lagrangian = (dot(x)^2 + dot(y)^2)/2 + x*dot(y);
        impacts { floor: y >= 0 => newton(e); side: x >= -1; }
        claims {
            symmetry: partial(x);
            conserved: dot(x) - y;
            conserved under side: energy;
            conserved under floor: dot(x) - y;
            not conserved under floor: energy;
        }
    }
}

dalembert::model! {
    /// A ball below a ceiling that ends its motion.
    pub Capped {
        coordinates { x; }
        lagrangian = dot(x)^2/2 - x;
        impacts { floor: x >= 0; ceiling: x <= 4 => stop; }
        claims { volume: kept; symplectic; invariant: d(x)^d(dot(x)); integrable: energy; }
    }
}

dalembert::model! {
    /// Cubic forces, whose divergence is not linear in the velocities.
    pub Cubic {
        coordinates { x; y; th: angle; }
        parameters { c > 0 = 1; }
        lagrangian = (dot(x)^2 + dot(y)^2 + dot(th)^2)/2;
        constraints { roll: dot(y) = dot(th); }
        forces { drag: -c*dot(x)^3*d(x); lift: dot(th)^3*d(x); }
        claims { density: none; }
    }
}

dalembert::model! {
    /// A density that depends on velocities, under a cubic force.
    pub Slowed {
        coordinates { x; y; }
        lagrangian = (dot(x)^2 + dot(y)^2)/2;
        forces { drag: -dot(x)^3*d(x); }
        claims { density: none; density = 1/abs(dot(x))^3; }
    }
}

dalembert::model! {
    /// Two constraints that are not linear in the velocities, and one that is.
    pub Bent {
        coordinates { x; y; z; u; w; s; }
        parameters { k > 0 = 1; g = 1; }
        lagrangian = (dot(x)^2 + dot(y)^2 + dot(z)^2 + dot(u)^2 + dot(w)^2 + dot(s)^2)/2 - g*z;
        constraints {
            cone: dot(x)^2 + dot(y)^2 = k^2*dot(z)^2;
            speed: dot(u)^2 + dot(w)^2 = k^2;
            slide: dot(s) = w*dot(w);
        }
        claims {
            conserved: (dot(x)^2 + dot(y)^2 + dot(z)^2)/2 + g*z;
            conserved: dot(x)/dot(y);
            conserved: dot(u)^2 + dot(w)^2;
            not conserved: energy;
        }
    }
}

dalembert::model! {
    /// Several impact laws with an affine constraint and moving walls.
    pub Laws {
        coordinates { x; y; th; }
        parameters { e in [0, 1] = 1/2; k = 1/3; }
        lagrangian = (dot(x)^2 + dot(y)^2 + dot(th)^2)/2;
        constraints { roll: dot(y) = x*dot(th) + k; }
        impacts {
            left: x >= 0 => restitution(e);
            right: y + x*t >= -1 => newton(e);
            low: y - th >= 0 => totally_plastic;
            high: 2 - y >= 0 => nonholonomic_plastic;
            far: x - t >= -3 => elastic;
        }
        claims {
            conserved under left: dot(y) - x*dot(th);
            density under right: factor = e^2;
            conserved under low: dot(x);
            not conserved under high: energy;
            conserved under far: dot(th) + x*dot(y);
            not conserved under far: dot(x);
        }
    }
}

dalembert::model! {
    /// The line `x = 0` in a plane has a door into a heavier medium, and elsewhere leads into a groove with an affine
    /// constraint.
    pub Doors {
        coordinates { x; y; }
        parameters { m > 0 = 2; k = 1/3; }
        modes {
            free {
                lagrangian = (dot(x)^2 + dot(y)^2)/2;
                claims { conserved under door: energy; conserved under slit: dot(x) + x*dot(y); }
            }
            heavy { lagrangian = m/2*(dot(x)^2 + dot(y)^2) - y; claims { conserved under out: energy; } }
            groove { lagrangian = (dot(x)^2 + dot(y)^2)/2; constraints { turned: dot(y) = x*dot(x) + k; } }
        }
        transitions {
            door: free -> heavy when x >= 0 when y >= 0;
            slit: free -> groove when x >= 0 otherwise;
            out: heavy -> free when x <= 0;
            back: groove -> free when x <= -1;
        }
    }
}

/// Invariant differential forms under first-order motion, constraints, forces, moving walls, refraction, instantaneous
/// constraints and transitions between fields.
const FORMS: &str = "
    pub Wall {
        coordinates { x; y; }
        lagrangian = (dot(x)^2 + dot(y)^2)/2 - y;
        impacts { moving: x - t^2/3 >= 0; left: 3 - x >= 0 => reset { dot(x) = -dot(x); y = y + 2; }; }
        claims { invariant: d(momentum(x))^d(x) + d(momentum(y))^d(y); invariant: d(x)^d(y)^d(dot(x))^d(dot(y)); }
    }
    pub Shear {
        coordinates { x; y; }
        field { dot(x) = 1; dot(y) = x; }
        claims { invariant: d(y) - x*d(x); invariant: d(dot(y))^d(y); }
    }
    pub Sleigh {
        coordinates { x; y; theta: angle; }
        parameters { a > 0 = 1/3; }
        lagrangian = (dot(x - a*cos(theta))^2 + dot(y - a*sin(theta))^2)/2 + dot(theta)^2/5;
        constraints { blade: dot(y)*cos(theta) = dot(x)*sin(theta); }
        claims { invariant: d(x)^d(y)^d(theta)^d(dot(x))^d(dot(theta))/(cos(theta)*dot(theta)); }
    }
    pub Damped {
        coordinates { x; }
        parameters { c > 0 = 1/3; }
        lagrangian = dot(x)^2/2 - x^4;
        forces { drag: -c*dot(x)*d(x); }
        impacts { floor: x >= 0; }
        claims { invariant: exp(c*t)*d(x)^d(dot(x)); }
    }
    pub Media {
        coordinates { x; y; }
        parameters { m1 > 0 = 1; m2 > 0 = 2; V = 1/5; }
        modes {
            left { lagrangian = m1/2*(dot(x)^2 + dot(y)^2) + y*dot(x)/3; }
            right { lagrangian = m2/2*(dot(x)^2 + dot(y)^2) - V + y*dot(x)/3; }
        }
        transitions { rightward: left -> right when x >= 0; leftward: right -> left when x <= 0; }
        claims { invariant: d(momentum(x))^d(x) + d(momentum(y))^d(y); }
    }
    pub Turned {
        coordinates { x; y; }
        parameters { k > 0 = 1; }
        modes {
            right { field { dot(x) = -2; dot(y) = 1; } }
            left { field { dot(x) = -k; dot(y) = 1; } }
        }
        transitions { leftward: right -> left when x <= 0; }
        claims { invariant: d(y); }
    }
    pub Roller {
        coordinates { x; y; theta; }
        parameters { k > 0 = 1/2; }
        lagrangian = (dot(x)^2 + dot(y)^2 + k*dot(theta)^2)/2 - y;
        impacts { wall: x >= 0 => elastic, instantaneous { no_slip: dot(y) = dot(theta) + x + 3; }; }
        claims {
            invariant: d(momentum(x))^d(x);
            conserved under wall: momentum(y) + momentum(theta);
            conserved under wall: dot(x)^2;
            not conserved under wall: dot(y);
        }
    }
    pub Groove {
        coordinates { x; y; }
        lagrangian = (dot(x)^2 + dot(y)^2)/2 - x;
        constraints { groove: dot(y) = 2*dot(x); }
        claims { symplectic; }
    }
    pub Belts {
        coordinates { x; y; }
        modes {
            right { field { dot(x) = -1; dot(y) = 0; } claims { density = y; density under leftward: factor = 1; } }
            left { field { dot(x) = -1; dot(y) = 0; } claims { density = -y; } }
        }
        transitions { leftward: right -> left when x <= 0; rightward: left -> right when x >= 0; }
    }";

/// Brackets: canonical momenta in a magnetic field, affine constraints, integrable systems with and without walls.
const BRACKETS: &str = "
    pub Charged {
        coordinates { x; y; }
        parameters { b = 3; }
        lagrangian = (dot(x)^2 + dot(y)^2)/2 + b*x*dot(y);
        claims { involution: momentum(x), momentum(y); involution: dot(x) - b*y, energy; }
    }
    pub Belt {
        coordinates { x; y; th: angle; }
        parameters { k = 1/3; }
        lagrangian = (dot(x)^2 + dot(y)^2 + dot(th)^2)/2;
        constraints { roll: dot(y) = x*dot(th) + k; }
        claims { involution: x, y, th; involution: dot(x), y, th; }
    }
    pub Table {
        coordinates { x; y; }
        parameters { k > 0 = 2; }
        lagrangian = (dot(x)^2 + dot(y)^2)/2 + k/sqrt(1 + x^2 + y^2);
        impacts { post: x^2 + y^2 >= 1; rim: 9 - x^2 - y^2 >= 0; }
        initial { x = 2; }
        claims { integrable: energy, x*momentum(y) - y*momentum(x); }
    }
    pub Disk {
        coordinates { x; y; theta: angle; phi: angle; }
        parameters { m > 0 = 7/5; R > 0 = 3/8; I > 0 = 2/9; J > 0 = 1/7; }
        lagrangian = m/2*(dot(x)^2 + dot(y)^2) + I/2*dot(theta)^2 + J/2*dot(phi)^2;
        constraints { rolling_x: dot(x) = R*cos(phi)*dot(theta); rolling_y: dot(y) = R*sin(phi)*dot(theta); }
        claims { integrable: momentum(theta), momentum(phi); }
    }";

/// The symplectic form on leaves of integrable constraints, and across transitions to leaves of another mode. The last
/// two models have constraints that are not linear in the velocities.
const LEAVES: &str = "
    pub Hoop {
        coordinates { x; y; }
        lagrangian = (dot(x)^2 + dot(y)^2)/2 - y;
        constraints { wire: x^2 + y^2 = 1 + t^2; }
        impacts { wall: x >= 0 => newton(1); }
        claims { symplectic; }
    }
    pub Slope {
        coordinates { x; y; z; }
        lagrangian = (dot(x)^2 + dot(y)^2 + dot(z)^2)/2 - y*z^2;
        constraints { held: exp(x*y)*(dot(z) - x*dot(x)) = 0; }
        claims { symplectic; }
    }
    pub Step {
        coordinates { x; y; }
        modes {
            near { lagrangian = (dot(x)^2 + dot(y)^2)/2; constraints { groove: dot(y) = dot(x); } }
            far {
                coordinates { z; }
                lagrangian = (dot(x)^2 + dot(y)^2 + dot(z)^2)/2 - x*z;
                constraints { groove: dot(y) = dot(x); shelf: dot(z) = 0; }
            }
        }
        transitions { go: near -> far when x <= 0 => reset { z = x - y; dot(z) = 0; }; }
        claims { symplectic; }
    }
    pub Shelf {
        coordinates { x; y; s; }
        modes {
            near { lagrangian = (dot(x)^2 + dot(y)^2 + dot(s)^2)/2; constraints { hold: dot(s) = 0; } claims { symplectic; } }
            far {
                coordinates { z; }
                lagrangian = (dot(x)^2 + dot(y)^2 + dot(s)^2 + dot(z)^2)/2;
                constraints { hold: dot(s) = 0; shelf: dot(z) = 0; }
                impacts { wall: x >= -1; }
                claims { symplectic; }
            }
        }
        transitions {
            go: near -> far when x <= 0 => reset { z = dot(y); dot(z) = 0; };
            back: far -> near when x >= 1 => reset { dot(s) = 0; };
        }
    }
    pub Wider {
        coordinates { x; }
        modes {
            line { lagrangian = dot(x)^2/2; claims { symplectic; } }
            plane {
                coordinates { y; z; }
                lagrangian = (dot(x)^2 + dot(y)^2 + dot(z)^2)/2 - x*z;
                constraints { shelf: dot(z) = 0; }
            }
        }
        transitions { go: line -> plane when x <= 0 => reset { y = 0; dot(y) = 0; z = 3; dot(z) = 0; }; }
    }
    pub Speed {
        coordinates { x; y; }
        lagrangian = (dot(x)^2 + dot(y)^2)/2 - y;
        constraints { speed: dot(x)^2 + dot(y)^2 = 4; }
        claims { invariant: d(dot(x)*exp(-y/4)); }
    }
    pub Free {
        coordinates { x; y; }
        lagrangian = (dot(x)^2 + dot(y)^2)/2;
        constraints { speed: dot(x)^2 + dot(y)^2 = 4; }
        claims { symplectic; }
    }
    pub Breathing {
        coordinates { z; x; }
        lagrangian = (2 + cos(t))*dot(z)^2/2 + dot(x)^2/2;
        forces { drag: -dot(z)*dot(z)*d(z); }
        claims { density: none; }
    }";

/// Creates a folder for certificates.
fn folder(name: &str) -> PathBuf {
    let folder = Path::new(env!("CARGO_TARGET_TMPDIR")).join(name);
    std::fs::create_dir_all(&folder).expect("a folder");
    folder
}

/// Writes the certificate of a model and returns its path. `forms:wall` names the model `wall` of [`FORMS`];
/// `brackets:` and `leaves:` work alike.
fn certificate(model: &str, folder: &Path) -> PathBuf {
    let path = folder.join(format!("{}.json", model.replace(':', "_")));
    let place = path.to_str().expect("a path");
    let mut model = model.to_owned();
    for (prefix, text) in [("forms", FORMS), ("brackets", BRACKETS), ("leaves", LEAVES)] {
        let texts = folder.join(format!("{prefix}.dal"));
        std::fs::write(&texts, text).expect("a file");
        if let Some((_, name)) = model.split_once(&format!("{prefix}:")) {
            model = format!("{}:{name}", texts.display());
        }
    }
    let mut models = dalembert_command::all();
    models.extend(models![
        Spiral, Belt, Winding, Charge, Capped, Cubic, Slowed, Bent, Laws, Doors
    ]);
    let finished = command::run(models, &["check", &model, "--certificate", place], "");
    assert_eq!(finished.exit, Exit::Reached, "{}", finished.output);
    path
}

fn checked(files: &[PathBuf]) -> Output {
    let program = Path::new(env!("CARGO_MANIFEST_DIR")).join("../python/check_certificate.py");
    let output = Command::new("python3").arg(program).args(files).output();
    output.expect("`python3` on the path (its standard library is enough)")
}

#[test]
fn an_independent_program_confirms_every_proof_of_the_shipped_models() {
    let folder = folder("certificates");
    let models = dalembert_command::all();
    let names: Vec<&str> = models
        .iter()
        .map(|model| model.description().name)
        .collect();
    let others = [
        "spiral",
        "belt",
        "winding",
        "charge",
        "capped",
        "cubic",
        "slowed",
        "bent",
        "laws",
        "doors",
        "forms:wall",
        "forms:shear",
        "forms:sleigh",
        "forms:damped",
        "forms:media",
        "forms:turned",
        "forms:roller",
        "forms:groove",
        "forms:belts",
        "brackets:charged",
        "brackets:belt",
        "brackets:table",
        "brackets:disk",
        "leaves:hoop",
        "leaves:slope",
        "leaves:step",
        "leaves:shelf",
        "leaves:wider",
        "leaves:speed",
        "leaves:free",
        "leaves:breathing",
    ];
    let names = names.iter().chain(&others);
    let files: Vec<PathBuf> = names.map(|name| certificate(name, &folder)).collect();
    let parts: Vec<&[PathBuf]> = files.chunks(files.len().div_ceil(4)).collect();
    let mut text = String::new();
    for output in parallel::each(&parts, |part| checked(part)) {
        text.push_str(&String::from_utf8_lossy(&output.stdout));
        let errors = String::from_utf8_lossy(&output.stderr);
        assert!(output.status.success(), "{text}{errors}");
    }
    let held = text.lines().filter(|line| line.starts_with("holds "));
    assert!(held.count() >= 150, "{text}");
    let unchecked = text.lines().find(|line| line.starts_with("unchecked "));
    assert_eq!(unchecked, None, "{text}");
}

/// Changes that make a claim of a certificate false: the model, the path in the parts of the document, the new value.
const TAMPERED: [(&str, &str, &str); 30] = [
    (
        "double_pendulum",
        "/0/content/claims/0/value",
        r#""energy + theta1/1000000000000""#,
    ),
    ("double_pendulum", "/0/content/claims/0/holds", "false"),
    (
        "double_pendulum",
        "/0/content/claims/0/primes/0",
        "2305843009213577281",
    ),
    (
        "holonomic_bead_on_ellipses",
        "/0/content/claims/0/density/terms/0/coefficient",
        r#""1/2""#,
    ),
    (
        "holonomic_bead_on_ellipses",
        "/0/content/claims/0/kind",
        r#""no_density""#,
    ),
    (
        "chaplygin_sleigh",
        "/0/content/claims/0/kind",
        r#""locally_exact""#,
    ),
    (
        "chaplygin_sleigh",
        "/0/content/claims/1/value",
        r#""1/abs(dot(theta))^2""#,
    ),
    (
        "chaplygin_sleigh",
        "/0/content/claims/3/value",
        r#""dot(x)""#,
    ),
    ("chaplygin_sleigh", "/0/content/claims/5/field/0", r#""y""#),
    // States at the start of a mode.
    (
        "rimless_wheel_five",
        "/0/content/surfaces/0/transition/state/qdot/0",
        r#""dot(x)""#,
    ),
    (
        "spring_mass_walker",
        "/1/content/surfaces/0/transition/state/q/2",
        r#""back""#,
    ),
    (
        "tent_map",
        "/1/content/surfaces/0/transition/state/q/1",
        r#""y*1000000001/1000000000""#,
    ),
    (
        "doors",
        "/0/content/surfaces/0/transition/keeps_lagrangian",
        "true",
    ),
    (
        "doors",
        "/2/content/constraints/0/form/0",
        r#""-x - 1/1000000000""#,
    ),
    ("laws", "/0/content/surfaces/1/coefficient", r#""e^2""#),
    // An invariant form, and the motion beyond a surface.
    (
        "forms:damped",
        "/0/content/claims/0/terms/0/coefficient",
        r#""exp(c*t*1000000001/1000000000)""#,
    ),
    (
        "forms:turned",
        "/1/content/motion/rates/1",
        r#""1 + 1/1000000000""#,
    ),
    // A field that leads back to a surface, with densities of opposite signs.
    ("forms:belts", "/1/content/motion/rates/0", r#""1""#),
    // Brackets without and with affine constraints, a wall, and two dependent functions.
    (
        "brackets:charged",
        "/0/content/claims/1/values/0",
        r#""dot(x) - (b + 1/1000000000)*y""#,
    ),
    (
        "brackets:belt",
        "/0/content/claims/0/values/2",
        r#""th + momentum(y)/1000000000""#,
    ),
    (
        "brackets:table",
        "/0/content/surfaces/0/gap",
        r#""x^2 + 1000000001/1000000000*y^2 - 1""#,
    ),
    (
        "brackets:disk",
        "/0/content/claims/0/values/0",
        r#""dot(phi)^2""#,
    ),
    // Constraints that are not integrable in time or in space, and a transition across leaves.
    (
        "leaves:hoop",
        "/0/content/constraints/0/affine",
        r#""-2*t - x/1000000000""#,
    ),
    (
        "leaves:slope",
        "/0/content/constraints/0/form/0",
        r#""-x*exp(x*y)*(1 + y/1000000000)""#,
    ),
    (
        "leaves:step",
        "/0/content/surfaces/0/transition/state/q/2",
        r#""x - y + dot(x)/1000000000""#,
    ),
    // A wall of a mode with leaves; two maps to a mode with more coordinates; a form; a potential.
    (
        "leaves:shelf",
        "/1/content/surfaces/0/gap",
        r#""x + 1 + z/1000000000""#,
    ),
    (
        "leaves:wider",
        "/0/content/surfaces/0/transition/state/qdot/1",
        r#""dot(x)/1000000""#,
    ),
    (
        "leaves:wider",
        "/0/content/surfaces/0/transition/state/q/2",
        r#""3 + dot(x)/1000000000""#,
    ),
    (
        "leaves:speed",
        "/0/content/claims/0/terms/0/differentials/0",
        r#""dot(x)*exp(-y/4*1000000001/1000000000)""#,
    ),
    (
        "leaves:free",
        "/0/content/motion/potential",
        r#""y/1000000000""#,
    ),
];

#[test]
fn a_certificate_that_was_tampered_with_fails() {
    let folder = folder("tampered_certificates");
    for (model, place, value) in TAMPERED {
        let path = certificate(model, &folder);
        let text = std::fs::read_to_string(&path).expect("a file");
        let mut document: Value = serde_json::from_str(&text).expect("JSON");
        *document["parts"].pointer_mut(place).expect(place) =
            serde_json::from_str(value).expect("JSON");
        std::fs::write(&path, document.to_string()).expect("a file");
        let output = checked(&[path]);
        let told = String::from_utf8_lossy(&output.stdout);
        assert_eq!(output.status.code(), Some(1), "{model} {place}: {told}");
        let failed = told
            .lines()
            .filter(|line| line.starts_with("FAILED"))
            .count();
        assert_eq!(failed, 1, "{model} {place}: {told}");
    }
}
