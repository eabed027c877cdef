//! Impact laws: the size of the impulse along `pi_D^* dh`, or the reset of the state.
//!
//! Every law but `reset`, `stop` and transitions is `p+ = p + eps pi_D^* dh` with some `eps`. Let `G` be the gap rate
//! `dh(qdot) + d_t h`, `P = g(qdot, .)` the kinetic momentum, and `rho = dh(pi_D grad h) / dh(grad h)`:
//!
//! | law | eps |
//! |---|---|
//! | elastic | `-2 (P(pi_D grad h) + d_t h) / dh(pi_D grad h)`, so that `H+ - H- = -eps d_t h` |
//! | restitution(e) | the same with `1 + e` in place of 2 |
//! | newton(e) | `-(1 + e) G / dh(pi_D grad h)`: `G` becomes `-e G` |
//! | nonholonomic plastic | `-2 rho G / dh(pi_D grad h)` |
//! | impact plastic | `-G / dh(pi_D grad h)` |
//! | totally plastic | `-rho G / dh(pi_D grad h)` |
//!
//! Sources: W. Clark, thesis, (VI.16), Definition VI.20, Table 6.1; Clark and Bloch, Remark 5.

use core::fmt;

use crate::numbers::Numbers;

/// An impact law of a surface.
#[derive(Debug, Clone, Copy, PartialEq)]
pub enum Law {
    /// Keeps the energy at walls at rest.
    Elastic,
    /// The elastic law with `1 + e` in place of 2; `e` in \[0, 1\].
    Restitution(f64),
    /// Multiplies the gap rate by `-e`; `e` in \[0, 1\].
    Newton(f64),
    /// Elastic constraint, plastic wall: the gap rate is multiplied by `1 - 2 rho`.
    NonholonomicPlastic,
    /// Orthogonal projection on D and the surface: the gap rate becomes 0.
    ImpactPlastic,
    /// The gap rate is multiplied by `1 - rho`.
    TotallyPlastic,
    /// The declared map of positions and velocities. No side of the surface is forbidden: the motion crosses the
    /// surface where the gap still decreases after the map.
    Reset,
    /// Ends the run when the motion reaches the surface.
    Stop,
    /// The surface leads to another mode: the state becomes a state of that mode. Users cannot select this law.
    Transition,
}

impl Law {
    /// True if it is a map of the state and not an impulse.
    pub const fn is_map(&self) -> bool {
        matches!(self, Self::Reset | Self::Transition)
    }

    /// True if it is an impulse: neither a map of the state nor the end of the run.
    pub const fn is_impulse(&self) -> bool {
        !self.is_map() && !matches!(self, Self::Stop)
    }

    /// The names of the laws in the language and on the command line, each with a flag: true for a law with a
    /// coefficient.
    pub const NAMES: [(&'static str, bool); 8] = [
        ("elastic", false),
        ("restitution", true),
        ("newton", true),
        ("nonholonomic_plastic", false),
        ("impact_plastic", false),
        ("totally_plastic", false),
        ("reset", false),
        ("stop", false),
    ];

    /// The law's name.
    pub const fn name(&self) -> &'static str {
        match self {
            Self::Elastic => "elastic",
            Self::Restitution(_) => "restitution",
            Self::Newton(_) => "newton",
            Self::NonholonomicPlastic => "nonholonomic_plastic",
            Self::ImpactPlastic => "impact_plastic",
            Self::TotallyPlastic => "totally_plastic",
            Self::Reset => "reset",
            Self::Stop => "stop",
            Self::Transition => "transition",
        }
    }

    /// Amount that the law subtracts from the gap rate; NaN for laws without an impulse. `e`: the coefficient of the
    /// law. `scalars`: the first five values of [`Kernel::Contact`](crate::Kernel::Contact), in order.
    #[inline(always)]
    pub fn taken<L: Numbers>(self, e: L, scalars: &[L; 5]) -> L {
        let [gap_rate, constrained_rate, surface_rate, constrained, free] = *scalars;
        let elastic = constrained_rate + surface_rate;
        let rho = || constrained / free;
        match self {
            Self::Elastic => L::of(2.0) * elastic,
            Self::Restitution(_) => (L::of(1.0) + e) * elastic,
            Self::Newton(_) => (L::of(1.0) + e) * gap_rate,
            Self::NonholonomicPlastic => L::of(2.0) * rho() * gap_rate,
            Self::ImpactPlastic => gap_rate,
            Self::TotallyPlastic => rho() * gap_rate,
            Self::Reset | Self::Stop | Self::Transition => L::of(f64::NAN),
        }
    }

    /// Adds the impulse of the law to `motion`, the momenta or quasi-velocities. `e`: the coefficient of the law.
    /// `collision`: the values of [`Kernel::Contact`](crate::Kernel::Contact), five numbers and the direction of the
    /// impulse.
    pub fn strike<L: Numbers>(self, e: L, collision: &[L], motion: &mut [L]) {
        let (scalars, direction) = collision.split_at(5);
        let scalars = core::array::from_fn(|i| scalars[i]);
        let taken = self.taken(e, &scalars);
        let [_, _, _, compliance, _] = scalars;
        let size = -taken / compliance;
        for (entry, direction) in motion.iter_mut().zip(direction) {
            *entry = size.mul_add(*direction, *entry);
        }
    }

    /// The coefficient of restitution, for the laws that have one.
    pub const fn coefficient(&self) -> Option<f64> {
        match *self {
            Self::Restitution(e) | Self::Newton(e) => Some(e),
            Self::Elastic
            | Self::NonholonomicPlastic
            | Self::ImpactPlastic
            | Self::TotallyPlastic
            | Self::Reset
            | Self::Stop
            | Self::Transition => None,
        }
    }

    /// The law with this name; `None` for an unknown name. `coefficient` is ignored by laws without one.
    pub fn from_name(name: &str, coefficient: f64) -> Option<Self> {
        Some(match name {
            "elastic" => Self::Elastic,
            "restitution" => Self::Restitution(coefficient),
            "newton" => Self::Newton(coefficient),
            "nonholonomic_plastic" => Self::NonholonomicPlastic,
            "impact_plastic" => Self::ImpactPlastic,
            "totally_plastic" => Self::TotallyPlastic,
            "reset" => Self::Reset,
            "stop" => Self::Stop,
            _ => return None,
        })
    }
}

impl fmt::Display for Law {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        match self.coefficient() {
            Some(e) => write!(f, "{}({e})", self.name()),
            None => f.write_str(self.name()),
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    /// The next law in order. The match is exhaustive, so a new law needs a place here.
    fn following(law: Law) -> Option<Law> {
        match law {
            Law::Elastic => Some(Law::Restitution(0.25)),
            Law::Restitution(_) => Some(Law::Newton(0.25)),
            Law::Newton(_) => Some(Law::NonholonomicPlastic),
            Law::NonholonomicPlastic => Some(Law::ImpactPlastic),
            Law::ImpactPlastic => Some(Law::TotallyPlastic),
            Law::TotallyPlastic => Some(Law::Reset),
            Law::Reset => Some(Law::Stop),
            Law::Stop | Law::Transition => None,
        }
    }

    #[test]
    fn every_law_is_had_by_its_name() {
        let mut names = Law::NAMES.into_iter();
        let mut next = Some(Law::Elastic);
        while let Some(law) = next {
            assert_eq!(
                names.next(),
                Some((law.name(), law.coefficient().is_some()))
            );
            assert_eq!(Law::from_name(law.name(), 0.25), Some(law));
            next = following(law);
        }
        assert_eq!(names.next(), None);
    }
}
