//! Policies for impacts that the law alone does not decide. By default the run stops there, with an outcome that names
//! the reason, except after a split ([`Split`]).

/// The policies of a run.
///
/// # Examples
///
/// ```
/// use dalembert::{Policies, Rest};
///
/// let policies = Policies { rest: Rest::Contact, ..Policies::default() };
/// assert_ne!(policies, Policies::default());
/// ```
#[derive(Debug, Clone, Copy, PartialEq, Eq, Default)]
pub struct Policies {
    /// Policy for a surface that the motion presses into.
    pub rest: Rest,
    /// Policy for a law after which the state still approaches the surface.
    pub penetration: Penetration,
    /// Policy for several surfaces hit at one time.
    pub corner: Corner,
    /// Policy for a transition after which the motion can go on in more than one way.
    pub split: Split,
}

/// Policy for a transition after which the motion can go on in more than one way: refracted into the other mode, or
/// reflected.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Default)]
pub enum Split {
    /// Go on with the refracted motion.
    #[default]
    First,
    /// End with [`Outcome::Ambiguous`](crate::Outcome::Ambiguous).
    Stop,
}

/// Policy for a state that rests on a surface while the motion presses into it: after impacts that accumulate, after
/// a plastic impact, or at the start.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Default)]
pub enum Rest {
    /// End with [`Outcome::Contact`](crate::Outcome::Contact), or with [`Outcome::Zeno`](crate::Outcome::Zeno) where
    /// impacts accumulate.
    #[default]
    Stop,
    /// Go on along the surface without friction, `h = 0`, until the contact force would have to pull.
    Contact,
}

/// Policy for a law after which the state still approaches the surface.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Default)]
pub enum Penetration {
    /// End with [`Outcome::StillPenetrating`](crate::Outcome::StillPenetrating).
    #[default]
    Stop,
    /// Repeat the law to its limit, which removes the whole gap rate like `impact_plastic`.
    Repeat,
}

/// Policy for several surfaces that are hit at one time, where the order of the impacts matters.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Default)]
pub enum Corner {
    /// End with [`Outcome::Ambiguous`](crate::Outcome::Ambiguous).
    #[default]
    Stop,
    /// The first declared of the surfaces approached at one time acts first.
    Ascending,
    /// The last declared of the surfaces approached at one time acts first.
    Descending,
}
