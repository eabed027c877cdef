//! Several proofs that are needed together.

use super::finding::{Certificate, Verdict};

/// The proofs so far, and the first reason for which one is missing.
pub(super) struct Together {
    pub all: Certificate,
    open: Option<String>,
}

impl Together {
    /// A proof, to which others are added.
    pub fn of(all: Certificate) -> Self {
        Self { all, open: None }
    }

    /// Adds a verdict. Returns it if it is a refutation.
    pub fn add(&mut self, verdict: Verdict) -> Option<Verdict> {
        match verdict {
            Verdict::Proved(part) => self.all.rest_on(&part),
            Verdict::Undecided(reason) => {
                self.open.get_or_insert(reason);
            }
            refuted @ Verdict::Refuted(_) => return Some(refuted),
        }
        None
    }

    /// The common proof, or the first reason for which a proof is missing.
    pub fn verdict(self) -> Verdict {
        match self.open {
            Some(reason) => Verdict::Undecided(reason),
            None => Verdict::Proved(self.all),
        }
    }
}
