//! First variations of runs, sections and periodic orbits, compiled once for loaded systems.

use dalembert::contract::Variational;
use dalembert::variations::orbit::ITERATIONS;
use dalembert::variations::{Arrival, Image, Orbit, OrbitError, Section, SectionError, Undefined};
use dalembert::{
    Event, Instance, Law, Observer, Run, Scene, SceneEffects, Tangent, Taylor, Tolerance,
    Variations,
};
use dalembert_cli::Integrator;
use dalembert_cli::suite::Setting;

use super::course::{Course, Drive, Driven};
use super::text::{Large, Model};

/// The tolerance of section maps.
const TOLERANCE: f64 = 1e-15;

/// Systems whose variations are compiled in this crate, so that a test only calls them.
pub trait Varied: Driven + Instance + Variational {
    /// Makes a run, and propagates tangents along it.
    fn vary(
        &self,
        drive: &mut Drive<Self>,
        tangents: &mut [Tangent<Self>],
    ) -> (Run<Self::State>, Result<(), Undefined>);

    /// Propagates tangents across one event.
    ///
    /// # Errors
    /// [`Undefined`] if the event has no derivative.
    fn cross(
        &self,
        event: &Event<Self::State>,
        tangents: &mut [Tangent<Self>],
    ) -> Result<(), Undefined>;

    /// Continues from a state to a section (see [`Section::arrive`]).
    ///
    /// # Errors
    /// [`SectionError`] if there is no arrival.
    fn arrive(
        returns: &Returns<'_, Self>,
        state: &Self::State,
        tangents: &mut [Tangent<Self>],
    ) -> Result<Arrival<Self::State>, SectionError>;

    /// Searches for a periodic orbit near a point (see [`Section::periodic`]).
    ///
    /// # Errors
    /// [`OrbitError`] if none is found.
    fn periodic(returns: &Returns<'_, Self>, near: &Self::State)
    -> Result<Orbit<Self>, OrbitError>;

    /// The image of a point, with its derivative with respect to a parameter (see [`Section::image`]).
    ///
    /// # Errors
    /// [`OrbitError`] if there is none.
    fn image(
        returns: &Returns<'_, Self>,
        point: &Self::State,
        parameter: usize,
    ) -> Result<Image<Self>, OrbitError>;
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

            fn image(
                returns: &Returns<'_, Self>,
                point: &Self::State,
                parameter: usize,
            ) -> Result<Image<Self>, OrbitError> {
                let mut section = returns.section();
                let anchor = section.anchor(point)?;
                section.image(&anchor, point, parameter)
            }
        }
    )*};
}
varied!(Model Large);

impl<M: Varied> Course<'_, M> {
    /// Makes the run by an integrator, and propagates tangents along it.
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

/// A surface as a section whose map is computed by power series.
#[derive(Debug, Clone, Copy)]
pub struct Returns<'a, M> {
    /// The system.
    pub system: &'a M,
    /// The surface.
    pub surface: usize,
    /// Number of returns in one application of the map.
    pub count: u32,
    /// Longest time of a return.
    pub horizon: f64,
    /// A law that replaces the declared one of the surface.
    pub law: Option<Law>,
}

impl<'a, M: Varied> Returns<'a, M> {
    /// The map of single returns to a surface.
    pub fn new(system: &'a M, surface: usize, horizon: f64) -> Self {
        Self {
            system,
            surface,
            count: 1,
            horizon,
            law: None,
        }
    }

    /// Continues from a state to the section.
    ///
    /// # Errors
    /// [`SectionError`] if there is no arrival.
    pub fn arrive(
        &self,
        state: &M::State,
        tangents: &mut [Tangent<M>],
    ) -> Result<Arrival<M::State>, SectionError> {
        M::arrive(self, state, tangents)
    }

    /// Searches for a periodic orbit near a point of the section.
    ///
    /// # Errors
    /// [`OrbitError`] if none is found.
    pub fn periodic(&self, near: &M::State) -> Result<Orbit<M>, OrbitError> {
        M::periodic(self, near)
    }

    /// The image of a point of the section, with its derivative with respect to a parameter.
    ///
    /// # Errors
    /// [`OrbitError`] if there is none.
    pub fn image(&self, point: &M::State, parameter: usize) -> Result<Image<M>, OrbitError> {
        M::image(self, point, parameter)
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
