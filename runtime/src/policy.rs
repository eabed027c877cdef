//! What impacts do where a law alone does not tell how to go on. The default is to stop, with the outcome that says why.

/// The policies of a run.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Default)]
pub struct Policies {
    /// On a surface that the motion presses into.
    pub rest: Rest,
    /// After a law that leaves the state approaching.
    pub penetration: Penetration,
    /// At several surfaces at one time.
    pub corner: Corner,
    /// At a transition that the motion can go on from in more than one way.
    pub split: Split,
}

/// What to do at a transition that the motion can go on from in more than one way: refracted into the other mode, or
/// reflected.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Default)]
pub enum Split {
    /// Go on with the first of the decisive points: the refracted one.
    #[default]
    First,
    /// End with [`Outcome::Ambiguous`](crate::Outcome::Ambiguous).
    Stop,
}

/// What to do where the state rests on a surface and the motion presses it in: after impacts that accumulate, after a
/// plastic impact, or at the start.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Default)]
pub enum Rest {
    /// End with [`Outcome::Contact`](crate::Outcome::Contact), or with [`Outcome::Zeno`](crate::Outcome::Zeno) where impacts
    /// accumulate.
    #[default]
    Stop,
    /// Go on along the surface without friction, `h = 0`, until its force would have to pull.
    Contact,
}

/// What to do after a law that leaves the state approaching.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Default)]
pub enum Penetration {
    /// End with [`Outcome::StillPenetrating`](crate::Outcome::StillPenetrating).
    #[default]
    Stop,
    /// Repeat the law for ever: its limit takes the whole gap rate, as `impact_plastic` does.
    Repeat,
}

/// What to do where several surfaces are hit at one time, and the order in which they are matters.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Default)]
pub enum Corner {
    /// End with [`Outcome::Ambiguous`](crate::Outcome::Ambiguous).
    #[default]
    Stop,
    /// Of the surfaces approached at one time, first the surface declared first.
    Ascending,
    /// Of the surfaces approached at one time, first the surface declared last.
    Descending,
}
