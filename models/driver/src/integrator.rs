//! The integrators by name, and the forms of the equations that they integrate.

use dalembert::integrate::{
    ClassicalRungeKutta, ComposedPrinciple, Dop853Scheme, DormandPrince5Scheme, Gauss, Method,
    MidpointPrinciple, Scheme, TAYLOR, Tolerance, ToleranceError, taylor_to_dop853,
};
use dalembert::jet::Work;

/// Integrators of runs.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Integrator {
    /// Dormand and Prince of order 8(5,3), dense output of order 7.
    Dop853,
    /// Dormand and Prince of order 5(4), dense output of order 4.
    Dopri5,
    /// Taylor series of an order that depends on the tolerance and the model, often 12 or more at 1e-9 and 19 or more
    /// at 1e-15.
    Taylor,
    /// Fixed step: the classical Runge-Kutta method of order 4.
    Rk4,
    /// Fixed step: Gauss collocation of order 4, symplectic without constraints.
    Gauss4,
    /// Fixed step: Gauss collocation of order 6, symplectic without constraints.
    Gauss6,
    /// Fixed step: discrete Lagrange-d'Alembert principle of order 2; constraints hold to rounding.
    Dla2,
    /// Fixed step: composition of [`Dla2`](Self::Dla2) of order 4.
    Dla4,
}

impl Integrator {
    /// All integrators.
    pub const fn every() -> &'static [Self] {
        &[
            Self::Dop853,
            Self::Dopri5,
            Self::Taylor,
            Self::Rk4,
            Self::Gauss4,
            Self::Gauss6,
            Self::Dla2,
            Self::Dla4,
        ]
    }

    /// The name on the command line and in files.
    pub const fn name(self) -> &'static str {
        match self {
            Self::Dop853 => Dop853Scheme::NAME,
            Self::Dopri5 => DormandPrince5Scheme::NAME,
            Self::Rk4 => ClassicalRungeKutta::NAME,
            Self::Gauss4 => Gauss::<2>::NAME,
            Self::Gauss6 => Gauss::<3>::NAME,
            Self::Dla2 => MidpointPrinciple::NAME,
            Self::Dla4 => ComposedPrinciple::NAME,
            Self::Taylor => TAYLOR,
        }
    }

    /// The order of the solution at the ends of steps; `None` if it depends on the tolerance and on the model.
    pub const fn order(self) -> Option<usize> {
        match self {
            Self::Dop853 => Some(Dop853Scheme::ORDER),
            Self::Dopri5 => Some(DormandPrince5Scheme::ORDER),
            Self::Rk4 => Some(ClassicalRungeKutta::ORDER),
            Self::Gauss4 => Some(Gauss::<2>::ORDER),
            Self::Gauss6 => Some(Gauss::<3>::ORDER),
            Self::Dla2 => Some(MidpointPrinciple::ORDER),
            Self::Dla4 => Some(ComposedPrinciple::ORDER),
            Self::Taylor => None,
        }
    }

    /// The integrator with the least predicted work for this tolerance: [`Taylor`](Self::Taylor) or
    /// [`Dop853`](Self::Dop853). `work` is that of the model in the form of the run
    /// ([`AnyModel::work`](crate::AnyModel::work)). The prediction counts operations ([`taylor_to_dop853`]), so that the
    /// choice is the same on all machines, and for all states and parameters of a model. [`Dopri5`](Self::Dopri5) may be faster at large errors.
    ///
    /// # Errors
    /// [`ToleranceError`] for a tolerance out of range.
    pub fn automatic(tol: f64, work: Option<Work>) -> Result<Self, ToleranceError> {
        let tolerance = Tolerance::new(tol)?;
        let ratio = work.map(|work| taylor_to_dop853(tolerance, work));
        Ok(match ratio.is_some_and(|ratio| ratio < 1.0) {
            true => Self::Taylor,
            false => Self::Dop853,
        })
    }

    /// True if it controls its step size by the tolerance.
    pub const fn is_adaptive(self) -> bool {
        matches!(self, Self::Dop853 | Self::Dopri5 | Self::Taylor)
    }
}

/// Form of the equations, which determines the components of the state of a run.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Form {
    /// Positions and the quasi-velocities that the constraints leave free: (q, u) on D.
    Reduced,
    /// Positions and momenta, which need not satisfy the constraints: (q, p) on T*Q.
    Global,
}

impl Form {
    /// Both forms.
    pub const fn every() -> &'static [Self] {
        &[Self::Reduced, Self::Global]
    }

    /// The name on the command line and in files.
    pub const fn name(self) -> &'static str {
        match self {
            Self::Reduced => "reduced",
            Self::Global => "global",
        }
    }
}
