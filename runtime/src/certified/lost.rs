//! Ends of certified motion: the time up to which it is certified, and the reason.

use core::fmt;

/// The end of certified motion.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Lost {
    /// The time up to which the motion is certified.
    pub t: f64,
    /// The condition that could not be proved.
    pub reason: Reason,
}

/// A condition that could not be proved for all motions of a box.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
#[non_exhaustive]
pub enum Reason {
    /// No box was found that contains the motion even for the shortest step: the motion may end, or its rate may not
    /// exist.
    NoTube,
    /// The system has no kernels over intervals: its form was compiled without them.
    NotDerived,
    /// The box has no finite bounds any more.
    NotFinite,
    /// The surface may be met at gap rate 0, more than once, or by only some of the motions.
    MayGraze {
        /// The surface.
        surface: usize,
    },
    /// Two surfaces may be met at one time, or in either order.
    MayMeetTogether {
        /// The surface that is met.
        surface: usize,
        /// The other one.
        other: usize,
    },
    /// The conditions of a surface are not certain where its gap may be 0.
    UnsureCondition {
        /// The surface.
        surface: usize,
    },
    /// The motion may be behind a surface that counts, or on it and approaching.
    MayBeBehind {
        /// The surface.
        surface: usize,
    },
    /// The gap does not certainly rise after the impact: the motion may stay on the surface, or still approach it after
    /// the law.
    MayStay {
        /// The surface.
        surface: usize,
    },
    /// The law of the surface is not available over intervals, is not the same for all motions, or has no finite
    /// result.
    UnsureLaw {
        /// The surface.
        surface: usize,
    },
    /// The law of the surface is `stop`, and the motion may end there.
    Stops {
        /// The surface.
        surface: usize,
    },
    /// The reset leads off the constraints.
    OffConstraint {
        /// The surface.
        surface: usize,
    },
    /// Thousands of steps led over a millionth of the time: before an essential singularity they shrink so fast that the
    /// motion never reaches it.
    NoHeadway,
    /// The box has states of several modes.
    SeveralModes,
    /// The requested end of the run may lie before an impact or after it.
    EndsAtImpact {
        /// The surface.
        surface: usize,
    },
}

impl fmt::Display for Lost {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        let Self { t, reason } = self;
        write!(
            f,
            "the motion is certified up to t = {t} and no further: {reason}"
        )
    }
}

impl fmt::Display for Reason {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        match *self {
            Self::NoTube => write!(f, "no box contains the motion over the shortest step"),
            Self::NoHeadway => write!(f, "steps have become so short that they make no headway"),
            Self::NotDerived => write!(f, "the system has no kernels over intervals"),
            Self::SeveralModes => write!(f, "the box has states of several modes"),
            Self::NotFinite => write!(f, "the box became infinite"),
            Self::MayGraze { surface } => write!(f, "the motion may graze surface {surface}"),
            Self::MayMeetTogether { surface, other } => {
                write!(
                    f,
                    "the motion may hit surfaces {surface} and {other} at one time"
                )
            }
            Self::UnsureCondition { surface } => {
                write!(f, "the conditions of surface {surface} are not decided")
            }
            Self::MayBeBehind { surface } => {
                write!(f, "the motion may be behind surface {surface}")
            }
            Self::MayStay { surface } => {
                write!(f, "the motion may stay on surface {surface}")
            }
            Self::UnsureLaw { surface } => write!(
                f,
                "the law of surface {surface} may not give one finite state"
            ),
            Self::Stops { surface } => write!(f, "the motion may end at surface {surface}"),
            Self::OffConstraint { surface } => {
                write!(
                    f,
                    "the reset of surface {surface} leads off the constraints"
                )
            }
            Self::EndsAtImpact { surface } => write!(
                f,
                "the end time may lie before or after the impact on surface {surface}"
            ),
        }
    }
}

impl core::error::Error for Lost {}
