//! First variations of runs, and sections and their periodic orbits, compiled once for the systems that are loaded.

use dalembert::contract::Variational;
use dalembert::variations::orbit::ITERATIONS;
use dalembert::variations::{Arrival, Orbit, OrbitError, Section, SectionError, Undefined};
use dalembert::{
    Event, Instance, Law, Observer, Run, Scene, SceneEffects, Tangent, Taylor, Tolerance,
    Variations,
};
use dalembert_cli::Integrator;
use dalembert_cli::suite::Setting;

use super::course::{Course, Drive, Driven};
use super::text::{Large, Model};

/// The tolerance of the maps of sections.
const TOLERANCE: f64 = 1e-15;

/// Systems whose runs are varied in this crate: a test only calls them.
pub trait Varied: Driven + Instance + Variational {
    /// Makes a run, and carries directions along it.
    fn vary(
        &self,
        drive: &mut Drive<Self>,
        tangents: &mut [Tangent<Self>],
    ) -> (Run<Self::State>, Result<(), Undefined>);

    /// Carries directions across one event.
    ///
    /// # Errors
    /// [`Undefined`].
    fn cross(
        &self,
        event: &Event<Self::State>,
        tangents: &mut [Tangent<Self>],
    ) -> Result<(), Undefined>;

    /// Goes on from a state to a section (see [`Section::arrive`]).
    ///
    /// # Errors
    /// [`SectionError`].
    fn arrive(
        returns: &Returns<'_, Self>,
        state: &Self::State,
        tangents: &mut [Tangent<Self>],
    ) -> Result<Arrival<Self::State>, SectionError>;

    /// Looks for a periodic orbit near a point (see [`Section::periodic`]).
    ///
    /// # Errors
    /// [`OrbitError`].
    fn periodic(returns: &Returns<'_, Self>, near: &Self::State)
    -> Result<Orbit<Self>, OrbitError>;
}

macro_rules! varied {
    ($($system:ty)*) => {$(
        impl Varied for $system {
            fn vary(
                &self,
                drive: &mut Drive<Self>,
                tangents: &mut [Tangent<Self>],
            ) -> (Run<Self::State>, Result<(), Undefined>) {
                let mut variations = Variations::new(self, tangents);
                let run = self.drive(drive, &mut variations);
                (run, variations.tangents().map(|_| ()))
            }

            fn cross(
                &self,
                event: &Event<Self::State>,
                tangents: &mut [Tangent<Self>],
            ) -> Result<(), Undefined> {
                let mut variations = Variations::new(self, tangents);
                let _ = variations.event(event);
                variations.tangents().map(|_| ())
            }

            fn arrive(
                returns: &Returns<'_, Self>,
                state: &Self::State,
                tangents: &mut [Tangent<Self>],
            ) -> Result<Arrival<Self::State>, SectionError> {
                returns.section().arrive(state, tangents)
            }

            fn periodic(
                returns: &Returns<'_, Self>,
                near: &Self::State,
            ) -> Result<Orbit<Self>, OrbitError> {
                returns.section().periodic(near, ITERATIONS)
            }
        }
    )*};
}
varied!(Model Large);

impl<M: Varied> Course<'_, M> {
    /// Makes the run by an integrator, and carries directions along it.
    pub fn vary(
        self,
        integrator: Integrator,
        tangents: &mut [Tangent<M>],
    ) -> (Run<M::State>, Result<(), Undefined>) {
        let system = self.system();
        let mut drive = self.under(Setting::free(integrator));
        system.vary(&mut drive, tangents)
    }
}

/// A surface as a section, mapped by power series.
#[derive(Debug, Clone, Copy)]
pub struct Returns<'a, M> {
    /// The system.
    pub system: &'a M,
    /// The surface.
    pub surface: usize,
    /// How many returns are one.
    pub count: u32,
    /// The most time that a return takes.
    pub horizon: f64,
    /// Another law on the surface than the declared one.
    pub law: Option<Law>,
}

impl<'a, M: Varied> Returns<'a, M> {
    /// Single returns to a surface.
    pub fn new(system: &'a M, surface: usize, horizon: f64) -> Self {
        Self {
            system,
            surface,
            count: 1,
            horizon,
            law: None,
        }
    }

    /// Goes on from a state to the section.
    ///
    /// # Errors
    /// [`SectionError`].
    pub fn arrive(
        &self,
        state: &M::State,
        tangents: &mut [Tangent<M>],
    ) -> Result<Arrival<M::State>, SectionError> {
        M::arrive(self, state, tangents)
    }

    /// Looks for a periodic orbit near a point of the section.
    ///
    /// # Errors
    /// [`OrbitError`].
    pub fn periodic(&self, near: &M::State) -> Result<Orbit<M>, OrbitError> {
        M::periodic(self, near)
    }
}

impl<M: Scene + Variational> Returns<'_, M> {
    fn section(&self) -> Section<'_, M, Taylor<M>, M::Effects> {
        let mut effects = self.system.effects();
        if let Some(law) = self.law {
            effects.set_law(self.surface, law);
        }
        let taylor = Taylor::new(Tolerance::new(TOLERANCE).expect("a positive tolerance"));
        Section::new(self.system, taylor, effects, self.surface, self.horizon)
            .with_returns(self.count)
    }
}
