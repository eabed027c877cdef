//! Section E, second part: arithmetic of generated code.

use dalembert::math::larger;
use dalembert::{Impacting, Instance, StateVector, System};
use dalembert_cli::suite::{Case, Report, Run, Setting, notes, refusal};

use super::course::{Course, Random, U, vector};
use super::tables::elliptic_table;
use super::text::{Text, shipped, value};

/// A rotor with outputs that lose digits by cancellation, and with accurate forms of them.
static ROTOR: Text = Text::new(
    "Rotor {
        coordinates { theta; }
        lagrangian = dot(theta)^2/2;
        outputs {
            cosine: cos(theta);
            cancels: 1 - cos(theta);
            root_cancels: sqrt(1 + theta) - 1;
            kept: 2*sin(theta/2)^2;
            root_kept: theta/(sqrt(1 + theta) + 1);
        }
    }",
);

/// Indices of the rotor's outputs.
const COSINE: usize = 0;
const CANCELS: usize = 1;
const KEPT: usize = 3;
const ROOT_KEPT: usize = 4;

/// A potential with a removable singularity at 0.
static REMOVABLE: Text = Text::new(
    "Removable {
        coordinates { x; }
        lagrangian = dot(x)^2/2 + sin(x)/x;
    }",
);

/// The cases.
pub const CASES: &[Case] = &[
    Case {
        id: "E10",
        title: "an angle of 1e8 in a cosine",
        right: "cos(1e8) = -0.36338508935569055",
        bound: "4 u 1e8, and u 1e8 per step",
        run: Run::Integrators(large_angle),
        ..Case::QUICK
    },
    Case {
        id: "E11",
        title: "sin(x)/x at 0",
        right: "no value as written",
        bound: "`non_finite`, not a silent NaN",
        run: Run::Steps(removable),
        ..Case::QUICK
    },
    Case {
        id: "E12",
        title: "constants: 1e400, 0^-1, sqrt(-2), (-8)^(1/3); and 1/2 = 2/4",
        right: "refused with the constant; exact",
        bound: "a message; 2 u",
        run: Run::Once(constants),
        ..Case::QUICK
    },
    Case {
        id: "E13",
        title: "1 - cos(x) and sqrt(1 + x) - 1 at 1e-8",
        right: "x^2/2; x/2 - x^2/8",
        bound: "marked in the notes, with a form that is right to 1e-12",
        run: Run::Once(cancellation),
        ..Case::QUICK
    },
    Case {
        id: "E14",
        title: "a generated gap against integers, at 1000 random rational points",
        right: "1 - 4x^2/9 - y^2 for multiples of 1/1024",
        bound: "2^10 u of the sum of terms",
        run: Run::Once(against_integers),
        ..Case::QUICK
    },
    Case {
        id: "E15",
        title: "a generated gap with separate and with fused multiplication",
        right: "the same values",
        bound: "16 u of the sum of terms; `tests/strict.rs` compares builds bit for bit",
        run: Run::Once(fused),
        ..Case::QUICK
    },
];

fn large_angle(setting: Setting, report: &mut Report) {
    let end = Course::new(&ROTOR.model(), &[0.0], &[1.0], 1e8).run(setting);
    report.class(&end.outcome, "done");
    let bound = (4.0 + end.counters.accepted as f64) * U * 1e8;
    report.near("theta", end.q[0], 1e8, bound);
    report.near(
        "cosine",
        output(end.q[0], COSINE),
        -0.363_385_089_355_690_6,
        bound,
    );
}

/// An output of the rotor, by index, at an angle.
fn output(theta: f64, index: usize) -> f64 {
    let rotor = ROTOR.model();
    let state = rotor
        .state_unchecked(0.0, &vector(&[theta]), &vector(&[0.0]))
        .expect("a state");
    let mut outputs = [0.0; 5];
    rotor.outputs(0.0, &state, &mut outputs).expect("outputs");
    outputs[index]
}

fn removable(setting: Setting, report: &mut Report) {
    let end = Course::new(&REMOVABLE.model(), &[0.0], &[0.0], 1.0).run(setting);
    report.class(&end.outcome, "non_finite");
}

fn constants(report: &mut Report) {
    for (constant, words) in [
        ("1e400", "out of the range of doubles"),
        ("0^-1", "division by zero"),
        ("sqrt(-2)", "not a real number"),
        ("(-8)^(1/3)", "not a real number"),
    ] {
        let source =
            format!("C {{ coordinates {{ x; }} lagrangian = dot(x)^2/2 - ({constant})*x; }}");
        let said = refusal(&source).unwrap_or_else(|| "accepted".to_owned());
        let right = said.contains(words);
        report.equal(
            constant,
            if right { words } else { &said }.to_owned(),
            words.to_owned(),
        );
    }
    report.near(
        "1/2",
        value(&shipped("double_pendulum").model(), "m1") / 2.0,
        0.5,
        0.0,
    );
}

fn cancellation(report: &mut Report) {
    let x = 1e-8_f64;
    let notes = notes(&ROTOR.model().description().source);
    let marked = [
        (
            "`1 - cos(theta)`",
            "write `2*sin(theta/2)^2`",
            output(x, KEPT),
            0.5 * x * x,
        ),
        (
            "`sqrt(theta + 1) - 1`",
            "write `theta/(sqrt(theta + 1) + 1)`",
            output(x, ROOT_KEPT),
            0.5 * x - 0.125 * x * x,
        ),
    ];
    for (difference, form, kept, right) in marked {
        let found = notes.contains(difference) && notes.contains(form);
        report.equal(format!("{difference} is marked"), found, true);
        report.near(form, kept, right, 1e-12 * right);
    }
    let lost = output(x, CANCELS) - 0.5 * x * x;
    report.equal("loses its digits as written", lost.abs() > 1e-17, true);
}

fn against_integers(report: &mut Report) {
    let table = elliptic_table(1.5, 1.0);
    let mut random = Random::new(14);
    let mut worst = 0.0_f64;
    for _ in 0..1000 {
        let [a, b] = [0, 1].map(|_| random.between(-2000.0, 2000.0).round());
        let q = [a / 1024.0, b / 1024.0];
        let state = table
            .state_unchecked(0.0, &vector(&q), &vector(&[0.0, 0.0]))
            .expect("a state");
        let unit = 9.0 * 1_048_576.0;
        let exact = (unit - 4.0 * a * a - 9.0 * b * b) / unit;
        let terms = 1.0 + (4.0 * a * a + 9.0 * b * b) / unit;
        worst = larger(
            worst,
            (table.gaps(0.0, &state).as_slice()[0] - exact).abs() / terms,
        );
    }
    report.error("gap over its terms", worst, 1024.0 * U);
}

fn fused(report: &mut Report) {
    let (ta, tb) = (1.3_f64, 0.7_f64);
    let table = elliptic_table(ta, tb);
    let mut random = Random::new(15);
    let mut worst = 0.0_f64;
    for _ in 0..1000 {
        let [x, y] = [0, 1].map(|_| random.between(-2.0, 2.0));
        let state = table
            .state_unchecked(0.0, &vector(&[x, y]), &vector(&[0.0, 0.0]))
            .expect("a state");
        let (x, y) = (x / ta, y / tb);
        let gap = (-y).mul_add(y, (-x).mul_add(x, 1.0));
        let terms = 1.0 + x * x + y * y;
        worst = larger(
            worst,
            (table.gaps(0.0, &state).as_slice()[0] - gap).abs() / terms,
        );
    }
    report.error("gap over its terms", worst, 16.0 * U);
}
