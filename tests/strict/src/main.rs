//! Prints hashes of the bits of long runs of two integrators, for a model with many elementary functions, a constraint
//! and impacts.

use std::ops::ControlFlow;

use dalembert::{
    Dop853, DormandPrince5, Event, Observer, Outcome, Scene, Segment, Simulation, Stepper, System, Tolerance,
    VectorField,
};

dalembert::model! {
    /// A skate in a potential with many functions, between two walls.
    pub Skate {
        coordinates { x; y; theta: angle; }
        parameters { m > 0 = 1; I > 0 = 1/5; k > 0 = 2; a > 0 = 1/3; }
        let r2 = x^2 + y^2;
        let smooth(u) = exp(-u)/5 + ln(1 + u)/7 + log1p(u/9)/8 + asinh(x/2)/9 + tanh(x*y)/9 + sinh(x/3)/9 + cosh(y/2)/9;
        let rational = (1 + r2)^(1/3)/6 + (2 + r2)^(2/5)/9 + sqrt(1 + r2)/9 + smooth(r2);
        let circular = atan(x + y)/8 + asin(x/(4 + r2))/9 + acos(y/(4 + r2))/9 + tan(x/(3 + r2))/9 + atan2(y, 3 + r2)/9;
        lagrangian = m/2*(dot(x)^2 + dot(y)^2) + I/2*dot(theta)^2 + a/9*dot(theta)*dot(x)*cos(theta)
            - k/2*r2 - rational - circular;
        constraints { blade: sin(theta)*d(x) - cos(theta)*d(y) = 0; }
        impacts { right: 3/4 - x - y^2/20 >= 0; left: x + 3/4 >= 0; }
    }
}

/// A hash of numbers by their bits (FNV-1a).
#[derive(Clone, Copy)]
struct Hash(u64);

impl Hash {
    const EMPTY: Self = Self(0xcbf2_9ce4_8422_2325);

    fn add(&mut self, numbers: &[f64]) {
        for byte in numbers.iter().flat_map(|number| number.to_bits().to_le_bytes()) {
            self.0 = (self.0 ^ u64::from(byte)).wrapping_mul(0x0000_0100_0000_01b3);
        }
    }
}

impl Observer<Skate> for Hash {
    fn step(&mut self, segment: &mut Segment<'_, <Skate as VectorField>::State>) -> ControlFlow<()> {
        let middle = (segment.t_start() + segment.t_end()) / 2.0;
        if let Ok(state) = segment.at(middle) {
            self.add(state.as_slice());
        }
        ControlFlow::Continue(())
    }

    fn event(&mut self, event: &Event<<Skate as VectorField>::State>) -> ControlFlow<()> {
        self.add(&[event.t]);
        self.add(event.after.as_slice());
        ControlFlow::Continue(())
    }
}

/// The hash of a run, and the number of its impacts.
fn run(skate: &Skate, stepper: impl Stepper<Skate>) -> Result<(Hash, u64), Box<dyn std::error::Error>> {
    let (q, qdot) = ([0.1, -0.2, 0.3], [1.9, 0.4, 1.3]);
    let state = skate.state_projected(0.0, &q.into(), &qdot.into())?;
    let mut hash = Hash::EMPTY;
    let run = Simulation::new(skate, stepper, skate.effects()).run(0.0, state, 4000.0, &mut hash)?;
    assert_eq!(run.outcome, Outcome::Done);
    hash.add(run.state.as_slice());
    hash.add(&[run.t, skate.energy(run.t, &run.state)?]);
    Ok((hash, run.counters.impacts))
}

fn main() -> Result<(), Box<dyn std::error::Error>> {
    let skate = Skate::default();
    let (high, impacts) = run(&skate, Dop853::new(Tolerance::new(1e-10)?))?;
    let (low, _) = run(&skate, DormandPrince5::new(Tolerance::new(1e-7)?))?;
    println!("{:016x} {:016x} after {impacts} impacts", high.0, low.0);
    Ok(())
}
