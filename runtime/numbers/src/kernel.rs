//! Names, arguments and values of the functions that the generator derives from a model, shared by generator and
//! runtime.

/// A function of a model in one form of its equations. Its arguments are the time, two lists of numbers
/// ([`Kernel::first`], [`Kernel::second`]) and the parameters. It writes its values as one list of numbers.
///
/// `n` is the number of coordinates, `m` that of constraints, `k` that of momenta or quasi-velocities in a state.
#[derive(Debug, Clone, Copy, PartialEq, Eq, PartialOrd, Ord, Hash)]
pub enum Kernel {
    /// The rate of the state.
    Rate,
    /// The unit of each component of the state.
    Scale,
    /// The velocities: n.
    Velocity,
    /// The momenta of a state that does not hold them: n.
    Momentum,
    /// The momenta or quasi-velocities for given velocities: k.
    Motion,
    /// The momenta or quasi-velocities of the allowed velocities nearest to given ones in the metric: k.
    Nearest,
    /// The quasi-velocities of the allowed momenta nearest to given ones: k.
    NearestMomenta,
    /// Kinetic and potential energy.
    Energy,
    /// `dL/dq + F`: n.
    Force,
    /// The multipliers: m.
    Multipliers,
    /// The residuals of the constraints, then the sums of the absolute values of their terms: 2 m.
    Residuals,
    /// The constraint forms row by row, then their affine parts: m n + m. Forms of nonlinear constraints depend on the
    /// velocities.
    Forms,
    /// The momenta after a step, projected onto the constraints: k.
    Restore,
    /// The values of integrable constraints.
    Levels,
    /// The sums of the absolute values of the terms of the levels; 0 for levels that are not declared to be 0.
    LevelScales,
    /// The change of positions that removes an excess of levels: n.
    LevelCorrection,
    /// The force of the constraints for multipliers: n.
    ReactionForce,
    /// The allowed velocities for momenta, then the multipliers that correct them: n + m.
    ConstrainedVelocity,
    /// All gaps.
    Gaps,
    /// The gap of one surface.
    Gap(usize),
    /// The rates of all gaps.
    GapRates,
    /// The second rates of all gaps, for given rates of the motion.
    GapAccelerations,
    /// The changes of the rates of all gaps by an impulse.
    GapResponses,
    /// The margins of the conditions of a surface: its own, then those of others that it depends on.
    Conditions(usize),
    /// The coefficient of the law of a surface.
    Coefficient(usize),
    /// The impulse by the law of a surface: size, share, direction.
    Blow(usize),
    /// The quantities of an impact on a surface: gap rate, constrained rate, rate of the surface, constrained and free
    /// compliance, direction.
    Contact(usize),
    /// The positions and velocities after the reset of a surface: 2 n.
    Reset(usize),
    /// The positions and velocities in the mode that a surface leads to.
    Entry(usize),
    /// The impulse after which the instantaneous constraints of a surface hold: k.
    Focus(usize),
    /// The correction of the rates of the motion that keeps the instantaneous constraints of a surface: k.
    Trace(usize),
    /// The divergence of the motion.
    Divergence,
    /// The density form: n.
    DensityForm,
    /// The logarithm of an invariant density, without the part given as an integral.
    LogDensity,
    /// The logarithm of the density of the invariant volume, without the part given as an integral.
    LogVolume,
    /// The gradient of the part of these logarithms that is given as an integral: n.
    DensityGradient,
    /// The powers that change the energy, one per cause.
    Powers,
    /// The declared outputs.
    Outputs,
    /// The point of the view.
    ViewPath,
    /// The function whose sign defines the region of the view.
    ViewRegion,
    /// The declared initial positions, then velocities: 2 n.
    Initial,
    /// The declared final time.
    Until,
    /// All geometric quantities derived at a state.
    Geometry,
}

/// Arrangement of the numbers of a quantity.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Shape {
    /// One number.
    Scalar,
    /// A list of this many numbers.
    Vector(usize),
    /// A matrix with these numbers of rows and columns, row by row.
    Matrix(usize, usize),
}

impl Shape {
    /// Number of entries.
    pub const fn count(self) -> usize {
        match self {
            Self::Scalar => 1,
            Self::Vector(count) => count,
            Self::Matrix(rows, columns) => rows * columns,
        }
    }
}

/// Content of the first list of numbers that a kernel reads.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum First {
    /// Nothing.
    Nothing,
    /// Positions; a state begins with them.
    Positions,
    /// A state.
    State,
}

/// Content of the second list of numbers that a kernel reads.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Second {
    /// Nothing.
    Nothing,
    /// Velocities.
    Velocities,
    /// Momenta.
    Momenta,
    /// Changes, or rates, of momenta or quasi-velocities.
    Motion,
    /// An excess of levels.
    Excess,
    /// Multipliers.
    Multipliers,
}

impl Kernel {
    /// Content of its first list of numbers.
    pub const fn first(self) -> First {
        match self {
            Self::Scale
            | Self::Motion
            | Self::Nearest
            | Self::NearestMomenta
            | Self::Force
            | Self::Residuals
            | Self::Forms
            | Self::Levels
            | Self::LevelScales
            | Self::LevelCorrection
            | Self::ReactionForce
            | Self::ConstrainedVelocity
            | Self::Gaps
            | Self::Gap(_)
            | Self::DensityForm
            | Self::LogDensity
            | Self::LogVolume
            | Self::DensityGradient
            | Self::ViewRegion => First::Positions,
            Self::Coefficient(_) | Self::Initial | Self::Until => First::Nothing,
            _ => First::State,
        }
    }

    /// Content of its second list of numbers.
    pub const fn second(self) -> Second {
        match self {
            Self::Motion | Self::Nearest | Self::Force | Self::Residuals | Self::Forms => {
                Second::Velocities
            }
            Self::NearestMomenta | Self::ConstrainedVelocity => Second::Momenta,
            Self::GapAccelerations | Self::GapResponses | Self::Trace(_) => Second::Motion,
            Self::LevelCorrection => Second::Excess,
            Self::ReactionForce => Second::Multipliers,
            _ => Second::Nothing,
        }
    }
}
