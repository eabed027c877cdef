//! A point of mass 1 in the plane, under a constant force, between surfaces given as functions. Its runs are compiled
//! here, once.

use dalembert::erased::Bounded;
use dalembert::integrate::Chosen;
pub use dalembert::numbers::{Numbers, TaylorModel};
use dalembert::{
    Contact, Dop853, DormandPrince5, Event, EventLog, Fault, Gauss4, Gauss6, Impacting, Impacts,
    Jump, Law, Observer, Outcome, ParameterError, Rk4, Run, Simulation, StateVector, Stepper,
    System, Taylor, TaylorField, Tolerance, VectorField, jet::LENGTH,
};
use nalgebra::SVector;

pub use super::by_hand::Gap;

/// A position, or a velocity.
pub type Vector = SVector<f64, 2>;
/// A position and a velocity.
pub type State = SVector<f64, 4>;

/// A surface from its gap and the gradient of the gap. `c` makes constants: `gap!(c |x, y| c(1.0) - x, [-1.0, 0.0])`.
#[macro_export]
macro_rules! gap {
    ($c:ident |$x:ident, $y:ident| $gap:expr, $gradient:expr) => {{
        #[allow(unused_variables)]
        fn at([$x, $y]: [f64; 2]) -> (f64, [f64; 2]) {
            let $c = |number: f64| number;
            ($gap, $gradient)
        }
        #[allow(unused_variables)]
        fn along([$x, $y]: [$crate::particle::TaylorModel; 2]) -> $crate::particle::TaylorModel {
            let $c = <$crate::particle::TaylorModel as $crate::particle::Numbers>::of;
            $gap
        }
        $crate::particle::Gap { at, along }
    }};
}

/// Largest number of surfaces of a [`Particle`].
pub const MOST_SURFACES: usize = 8;

/// The point with its surfaces.
#[derive(Clone)]
pub struct Particle {
    /// The force.
    pub force: [f64; 2],
    /// The surfaces.
    pub surfaces: Vec<Gap>,
    /// The law of every surface.
    pub law: Law,
    /// True where a surface counts.
    pub active: fn(usize, [f64; 2]) -> bool,
    /// State after the law `reset`.
    pub reset: fn(usize, State) -> State,
}

impl Particle {
    /// The point under a force, between elastic surfaces that count everywhere.
    pub fn new<const S: usize>(force: [f64; 2], surfaces: [Gap; S]) -> Self {
        Self {
            force,
            surfaces: surfaces.to_vec(),
            law: Law::Elastic,
            active: |_, _| true,
            reset: |_, state| state,
        }
    }

    /// Gives every surface the law `reset`, with this function.
    pub fn with_reset(mut self, reset: fn(usize, State) -> State) -> Self {
        self.law = Law::Reset;
        self.reset = reset;
        self
    }

    /// Sets the law of every surface.
    pub fn with_law(mut self, law: Law) -> Self {
        self.law = law;
        self
    }

    fn of_surfaces(&self, value: impl Fn(&Gap) -> f64) -> Bounded<f64, MOST_SURFACES> {
        let mut values = self.zero_gaps();
        for (place, gap) in values.as_mut_slice().iter_mut().zip(&self.surfaces) {
            *place = value(gap);
        }
        values
    }
}

fn point(state: &State) -> [f64; 2] {
    [state[0], state[1]]
}

impl VectorField for Particle {
    type State = State;

    #[inline]
    fn rate(&self, _: f64, state: &State, rate: &mut State) -> Result<(), Fault> {
        *rate = State::new(state[2], state[3], self.force[0], self.force[1]);
        Ok(())
    }
}

impl TaylorField for Particle {
    type Parameters<L: Numbers> = [L; 2];
    type Row<L: Numbers> = [L; 4];
    type Gaps<L: Numbers> = [L; 0];
    type Firsts<L: Numbers> = [L; 4];
    type Jets<L: Numbers> = [[L; LENGTH]; 0];

    fn parameters(&self) -> [f64; 2] {
        self.force
    }

    fn begin<L: Numbers>(
        &self,
        [fx, fy]: &[L; 2],
        _: L,
        [_, _, vx, vy]: &[L; 4],
        firsts: &mut [L; 4],
    ) -> Result<(), Fault> {
        *firsts = [*vx, *vy, *fx, *fy];
        Ok(())
    }

    fn advance<L: Numbers>(
        &self,
        _: &[L; 2],
        unit: L,
        order: usize,
        firsts: &[L; 4],
        coefficients: &mut [[L; 4]; LENGTH],
        _: &mut [[L; 0]; LENGTH],
        _: &mut Self::Jets<L>,
    ) {
        let [vx, vy, fx, fy] = firsts.map(|rate| unit * rate);
        let half = L::of(0.5) * unit;
        coefficients[1..=order].fill([L::ZERO; 4]);
        coefficients[1] = [vx, vy, fx, fy];
        coefficients[2] = [half * fx, half * fy, L::ZERO, L::ZERO];
    }
}

impl System for Particle {
    type Vector = Vector;
    type Impulse = Vector;

    fn position(&self, state: &State) -> Vector {
        Vector::new(state[0], state[1])
    }

    fn velocity(&self, _: f64, state: &State) -> Result<Vector, Fault> {
        Ok(Vector::new(state[2], state[3]))
    }

    fn momentum(&self, t: f64, state: &State) -> Result<Vector, Fault> {
        self.velocity(t, state)
    }

    fn state_unchecked(&self, _: f64, q: &Vector, qdot: &Vector) -> Result<State, Fault> {
        Ok(State::new(q[0], q[1], qdot[0], qdot[1]))
    }

    fn state_from_momenta(&self, t: f64, q: &Vector, p: &Vector) -> Result<State, Fault> {
        self.state_unchecked(t, q, p)
    }

    fn energy(&self, _: f64, s: &State) -> Result<f64, Fault> {
        Ok(0.5 * (s[2] * s[2] + s[3] * s[3]) - self.force[0] * s[0] - self.force[1] * s[1])
    }

    fn kick(&self, state: &mut State, size: f64, direction: &Vector) {
        state[2] += size * direction[0];
        state[3] += size * direction[1];
    }

    fn check_parameters(&self) -> Result<(), ParameterError> {
        Ok(())
    }
}

impl Impacting for Particle {
    type Gaps = Bounded<f64, MOST_SURFACES>;

    fn surface_count(&self) -> usize {
        self.surfaces.len()
    }

    fn zero_gaps(&self) -> Self::Gaps {
        Bounded::all(self.surfaces.len(), 0.0)
    }

    fn gaps(&self, _: f64, state: &State) -> Self::Gaps {
        self.of_surfaces(|gap| (gap.at)(point(state)).0)
    }

    fn gap_along(
        &self,
        surface: usize,
        _: TaylorModel,
        component: &dyn Fn(usize) -> TaylorModel,
    ) -> TaylorModel {
        (self.surfaces[surface].along)([component(0), component(1)])
    }

    fn gap_rates(&self, _: f64, state: &State) -> Result<Self::Gaps, Fault> {
        Ok(self.of_surfaces(|gap| {
            let gradient = (gap.at)(point(state)).1;
            gradient[0] * state[2] + gradient[1] * state[3]
        }))
    }

    fn surface_active(&self, surface: usize, _: f64, state: &State) -> bool {
        (self.active)(surface, point(state))
    }

    fn law(&self, _: usize) -> Law {
        self.law
    }

    fn reset(&self, surface: usize, t: f64, state: &State) -> Result<Option<Jump<Vector>>, Fault> {
        if self.law != Law::Reset {
            return Ok(None);
        }
        let after = (self.reset)(surface, *state);
        Ok(Some(Jump {
            position: self.position(&after),
            velocity: self.velocity(t, &after)?,
        }))
    }

    fn contact(&self, surface: usize, _: f64, state: &State) -> Result<Contact<Vector>, Fault> {
        let [a, b] = (self.surfaces[surface].at)(point(state)).1;
        let rate = a * state[2] + b * state[3];
        let compliance = a * a + b * b;
        if compliance <= 0.0 {
            return Err(Fault::SingularSurface { surface });
        }
        Ok(Contact {
            gap_rate: rate,
            constrained_rate: rate,
            surface_rate: 0.0,
            constrained_compliance: compliance,
            free_compliance: compliance,
            direction: Vector::new(a, b),
        })
    }
}

/// A floor at `x = 0`.
pub const FLOOR: Gap = gap!(c | x, y | x, [1.0, 0.0]);

/// A ceiling at `x = 1`.
pub const CEILING: Gap = gap!(c | x, y | c(1.0) - x, [-1.0, 0.0]);

/// A floor at `x = 1`, whose gap has rounding errors.
pub const RAISED_FLOOR: Gap = gap!(c | x, y | x - c(1.0), [1.0, 0.0]);

/// The first impacts of a run.
pub type Log = EventLog<State, 256>;

/// A state.
pub fn at(x: f64, y: f64, vx: f64, vy: f64) -> State {
    State::new(x, y, vx, vy)
}

/// Runs with every integrator that suits the particle and with several step sizes. `check` gets each run, its events
/// and the name of the integrator.
pub fn with_every_integrator(
    particle: &Particle,
    state: State,
    t_end: f64,
    mut check: impl FnMut(&Run<State>, &Log, &str),
) {
    each_run(particle, state, t_end, &mut check);
}

fn each_run(
    particle: &Particle,
    state: State,
    t_end: f64,
    check: &mut dyn FnMut(&Run<State>, &Log, &str),
) {
    let tolerance = Tolerance::new(1e-12).expect("a valid setting");
    macro_rules! check {
        ($name:literal, $stepper:expr) => {
            let mut log = Log::new();
            let run = run_with(particle, $stepper, state, t_end, &mut log);
            check(&run, &log, $name);
        };
    }
    for max_step in [f64::INFINITY, 0.25, 1e-3] {
        check!(
            "dop853",
            Dop853::new(tolerance)
                .with_max_step(max_step)
                .expect("a valid setting")
        );
        check!(
            "dopri5",
            DormandPrince5::new(tolerance)
                .with_max_step(max_step)
                .expect("a valid setting")
        );
        check!(
            "taylor",
            Taylor::new(tolerance)
                .with_max_step(max_step)
                .expect("a valid setting")
        );
    }
    for step in [0.25, 1e-3] {
        check!("rk4", Rk4::new(tolerance).with_step(step));
        check!("gauss4", Gauss4::new(tolerance).with_step(step));
        check!("gauss6", Gauss6::new(tolerance).with_step(step));
    }
}

/// A run with an integrator.
pub fn run_with(
    particle: &Particle,
    mut stepper: impl Stepper<Particle>,
    state: State,
    t_end: f64,
    log: &mut Log,
) -> Run<State> {
    let effects = Impacts::declared(particle);
    drive(
        particle,
        Chosen::new(&mut stepper),
        effects,
        (0.0, state, t_end),
        log,
    )
}

/// A run by Dormand and Prince's method of order 8.
pub fn run(particle: &Particle, state: State, t_end: f64, log: &mut Log) -> Run<State> {
    observed(particle, Impacts::declared(particle), (state, t_end), log)
}

/// Same as [`run`], from the time `t` to `t_end`.
pub fn run_on(particle: &Particle, t: f64, state: State, t_end: f64, log: &mut Log) -> Run<State> {
    let mut stepper = Dop853::new(Tolerance::new(1e-12).expect("a valid setting"));
    let effects = Impacts::declared(particle);
    let stepper = Chosen::new(&mut stepper);
    drive(particle, stepper, effects, (t, state, t_end), log)
}

/// Same as [`run`], with given effects and an observer.
pub fn observed(
    particle: &Particle,
    effects: Impacts<Particle>,
    (state, t_end): (State, f64),
    observer: &mut dyn Observer<Particle>,
) -> Run<State> {
    let mut stepper = Dop853::new(Tolerance::new(1e-12).expect("a valid setting"));
    drive(
        particle,
        Chosen::new(&mut stepper),
        effects,
        (0.0, state, t_end),
        observer,
    )
}

fn drive(
    particle: &Particle,
    stepper: Chosen<'_, Particle>,
    effects: Impacts<Particle>,
    (t, state, t_end): (f64, State, f64),
    mut observer: &mut dyn Observer<Particle>,
) -> Run<State> {
    Simulation::new(particle, stepper, effects)
        .run(t, state, t_end, &mut observer)
        .expect("a start")
}

/// The times of impacts.
pub fn times(log: &Log) -> Vec<f64> {
    log.iter().map(|event: &Event<State>| event.t).collect()
}

/// Asserts that a run reached its end.
///
/// # Panics
/// Otherwise.
pub fn assert_done(run: &Run<State>, case: &str) {
    assert_eq!(run.outcome, Outcome::Done, "{case} at t = {}", run.t);
}

/// Asserts that the impacts of a run have these times, up to the tolerance.
///
/// # Panics
/// Otherwise.
#[track_caller]
pub fn assert_times(log: &Log, exact: &[f64], tolerance: f64, case: &str) {
    let times = times(log);
    assert_eq!(times.len(), exact.len(), "{case}: {times:?}");
    for (time, exact) in times.iter().zip(exact) {
        assert!(
            (time - exact).abs() <= tolerance,
            "{case}: {time} for {exact}"
        );
    }
}
