//! Compares the numbers of operations of generated and handwritten functions.

use dalembert::Described;
use dalembert_codegen::program::{Form, Function, Input, Op, Program};
use dalembert_codegen::{mechanics, model, program, spec};
use dalembert_models::{
    BallOnRotatingTable, BouncingBall, Chain2, Chain3, Chain4, Chain8, Chain16, ChaplyginSleigh,
    DoublePendulum, HarmonicOscillator, HolonomicBeadOnEllipses, PointBilliard, RollingBallEuler,
    RollingDisk, TwoWheelsRod,
};

use super::chain::{self, Chain};
use super::counted::{Counted, operations};
use super::number::Number;
use super::{
    bead, bouncing_ball, chaplygin_sleigh, double_pendulum, harmonic_oscillator, point_billiard,
    rolling_ball, rolling_disk, two_wheels,
};

/// Largest ratio of operations of a generated function to those of the handwritten one, except for [`LARGER`].
const MOST: f64 = 1.1;

/// Larger ratios. Generated code computes the reciprocal of a mass and multiplies by it. It adds an impulse to the
/// state where a handwritten impact changes a sign. It does not cancel common factors that may vanish. A model with
/// integrable constraints runs in global form, without a frame.
const LARGER: [(&str, f64); 6] = [
    ("bouncing_ball (q, p) rate", 1.34),
    ("bouncing_ball (q, p) impact", 3.0),
    ("harmonic_oscillator (q, p) rate", 1.34),
    ("holonomic_bead_on_ellipses (q, p) impact", 2.2),
    ("rolling_ball_euler (q, u) impact", 1.19),
    ("two_wheels_rod (q, u) impact", 1.73),
];

/// Numbers of operations of a generated function and of the handwritten one.
#[derive(Debug, Clone)]
struct Pair {
    name: String,
    generated: usize,
    by_hand: usize,
}

/// The generated functions of a model.
struct Generated {
    name: &'static str,
    program: Program,
}

impl Generated {
    /// The functions of the form in which the model runs.
    fn of<S: Described>(_: &S) -> Self {
        Self {
            name: S::DESCRIPTION.name,
            program: lowered::<S>().main,
        }
    }

    /// The functions of the global form of a model that runs in another form.
    fn global<S: Described>(_: &S) -> Self {
        Self {
            name: S::DESCRIPTION.name,
            program: lowered::<S>().global.expect("a second form"),
        }
    }

    fn pair(&self, function: &str, generated: usize, by_hand: usize) -> Pair {
        let form = match self.program.form {
            Form::Global => "q, p",
            Form::Reduced => "q, u",
            Form::FirstOrder => "q",
        };
        Pair {
            name: format!("{} ({form}) {function}", self.name),
            generated,
            by_hand,
        }
    }

    fn rate(&self, by_hand: usize) -> Pair {
        self.pair("rate", self.program.rate.cost.total(), by_hand)
    }

    /// The generated energy, with the operations of the velocities if it needs them.
    fn energy(&self, by_hand: usize) -> Pair {
        let mut inputs = self.program.energy.ops.iter();
        let velocity = match inputs.any(|op| matches!(op, Op::Input(Input::Velocity(_)))) {
            true => self.program.velocity.cost.total(),
            false => 0,
        };
        self.pair(
            "energy",
            velocity + self.program.energy.cost.total(),
            by_hand,
        )
    }

    /// An elastic impact on the first surface: the operations of the impulse and of its addition to the state.
    fn impact(&self, by_hand: usize) -> Pair {
        let blows = &self.program.impacting.as_ref().expect("surfaces").blows;
        let blow: &Function = blows[0].as_ref().expect("an impulse");
        let direction = blow.outputs.len() - 2;
        self.pair("impact", blow.cost.total() + 2 * direction, by_hand)
    }
}

fn lowered<S: Described>() -> program::Lowered {
    let source = S::DESCRIPTION.source.parse().expect("tokens");
    let spec = spec::parse(source).expect("a declaration");
    let mut model = model::check(&spec).expect("a model");
    let derivation = mechanics::derive(&mut model);
    program::lower(&model, &derivation, None)
}

fn chain<const N: usize, S: Chain<N> + Described>(system: &S) -> [Pair; 2] {
    let generated = Generated::of(system);
    let motion = |theta| chain::motion(system.rods(), theta, [Counted::of(0.2); N]);
    let energy = |theta| chain::energy_of(system.rods(), theta, [Counted::of(0.2); N]);
    [
        generated.rate(operations(motion)),
        generated.energy(operations(energy)),
    ]
}

fn chains() -> Vec<Pair> {
    let mut pairs = Vec::new();
    pairs.extend(chain(&Chain2::default()));
    pairs.extend(chain(&Chain3::default()));
    pairs.extend(chain(&Chain4::default()));
    pairs.extend(chain(&Chain8::default()));
    pairs.extend(chain(&Chain16::default()));
    pairs
}

fn free_models() -> Vec<Pair> {
    let (ball, oscillator) = (BouncingBall::default(), HarmonicOscillator::default());
    let (point, pendulum) = (PointBilliard::default(), DoublePendulum::default());
    let of_ball = Generated::of(&ball);
    let of_oscillator = Generated::of(&oscillator);
    let of_point = Generated::of(&point);
    let of_pendulum = Generated::of(&pendulum);
    vec![
        of_ball.rate(operations(|state| bouncing_ball::rate(&ball, state))),
        of_ball.energy(operations(|state| bouncing_ball::energy(&ball, state))),
        of_ball.impact(operations(|state| bouncing_ball::impact(&ball, state))),
        of_oscillator.rate(operations(|state| {
            harmonic_oscillator::rate(&oscillator, state)
        })),
        of_oscillator.energy(operations(|state| {
            harmonic_oscillator::energy(&oscillator, state)
        })),
        of_point.rate(operations(|state| point_billiard::rate(&point, state))),
        of_point.energy(operations(|state| point_billiard::energy(&point, state))),
        of_point.impact(operations(|state| point_billiard::impact(&point, state))),
        of_pendulum.rate(operations(|state| double_pendulum::rate(&pendulum, state))),
        of_pendulum.energy(operations(|state| {
            double_pendulum::energy(&pendulum, state)
        })),
    ]
}

fn constrained_models() -> Vec<Pair> {
    let (disk, sleigh) = (RollingDisk::default(), ChaplyginSleigh::default());
    let bead = HolonomicBeadOnEllipses::default();
    let of_disk = Generated::global(&disk);
    let of_sleigh = Generated::global(&sleigh);
    let of_bead = Generated::of(&bead);
    vec![
        of_disk.rate(operations(|state| rolling_disk::rate(&disk, state))),
        of_disk.energy(operations(|state| rolling_disk::energy(&disk, state))),
        of_disk.impact(operations(|state| rolling_disk::impact(&disk, 0, state))),
        of_sleigh.rate(operations(|state| chaplygin_sleigh::rate(&sleigh, state))),
        of_sleigh.energy(operations(|state| chaplygin_sleigh::energy(&sleigh, state))),
        of_sleigh.impact(operations(|state| {
            chaplygin_sleigh::impact(&sleigh, 0, state)
        })),
        of_bead.rate(operations(|state| bead::rate(&bead, state))),
        of_bead.energy(operations(|state| bead::energy(&bead, state))),
        of_bead.impact(operations(|state| bead::impact(&bead, state))),
    ]
}

fn reduced_models() -> Vec<Pair> {
    let (disk, sleigh) = (RollingDisk::default(), ChaplyginSleigh::default());
    let (ball, wheels) = (RollingBallEuler::default(), TwoWheelsRod::default());
    let on_table = BallOnRotatingTable::default();
    let of_disk = Generated::of(&disk);
    let of_sleigh = Generated::of(&sleigh);
    let of_ball = Generated::of(&ball);
    let of_wheels = Generated::of(&wheels);
    let of_table = Generated::of(&on_table);
    vec![
        of_disk.rate(operations(|state| rolling_disk::reduced_rate(&disk, state))),
        of_disk.energy(operations(|state| {
            rolling_disk::reduced_energy(&disk, state)
        })),
        of_disk.impact(operations(|state| {
            rolling_disk::reduced_impact(&disk, 0, state)
        })),
        of_sleigh.rate(operations(|state| {
            chaplygin_sleigh::reduced_rate(&sleigh, state)
        })),
        of_sleigh.energy(operations(|state| {
            chaplygin_sleigh::reduced_energy(&sleigh, state)
        })),
        of_sleigh.impact(operations(|state| {
            chaplygin_sleigh::reduced_impact(&sleigh, 0, state)
        })),
        of_ball.rate(operations(|state| rolling_ball::rate(&ball, state))),
        of_ball.energy(operations(|state| rolling_ball::energy(&ball, state))),
        of_ball.impact(operations(|state| rolling_ball::impact(&ball, state))),
        of_table.rate(operations(|state| {
            rolling_ball::rate_on_table(&on_table, state)
        })),
        of_table.energy(operations(|state| {
            rolling_ball::energy_on_table(&on_table, state)
        })),
        of_wheels.rate(operations(|state| two_wheels::rate(&wheels, state))),
        of_wheels.energy(operations(|state| two_wheels::energy(&wheels, state))),
        of_wheels.impact(operations(|state| two_wheels::impact(&wheels, state))),
    ]
}

impl Pair {
    fn ratio(&self) -> f64 {
        self.generated as f64 / self.by_hand as f64
    }

    fn most(&self) -> f64 {
        LARGER
            .iter()
            .find(|(name, _)| *name == self.name)
            .map_or(MOST, |&(_, most)| most)
    }
}

#[test]
fn generated_functions_take_no_more_operations_than_is_known() {
    for pair in [
        chains(),
        free_models(),
        constrained_models(),
        reduced_models(),
    ]
    .concat()
    {
        let (ratio, most) = (pair.ratio(), pair.most());
        println!(
            "{:<46} {:>5} {:>5} {ratio:.2}",
            pair.name, pair.generated, pair.by_hand
        );
        assert!(ratio <= most + 0.01, "{}: {ratio:.2}", pair.name);
    }
}
