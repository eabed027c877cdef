//! Random choices.

use dalembert_stability::course::Random;

/// A source of random choices. The same seed gives the same choices.
#[derive(Debug, Clone)]
pub struct Draw(Random);

impl Draw {
    /// The source with this seed.
    pub fn new(seed: u64) -> Self {
        Self(Random::new(seed))
    }

    /// A number below `end`.
    pub fn below(&mut self, end: usize) -> usize {
        (self.0.bits() % end as u64) as usize
    }

    /// One of the choices.
    pub fn choice<T: Copy>(&mut self, choices: &[T]) -> T {
        choices[self.below(choices.len())]
    }

    /// True with probability `1/among`.
    pub fn one_in(&mut self, among: usize) -> bool {
        self.below(among) == 0
    }
}
