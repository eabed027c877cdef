//! Detection of returns that repeat, and the orbits of all cells.

use super::request::Components;

/// Factor between the tolerance for returns of different cells to one orbit and the tolerance for returns of one run.
/// It is large because a run approaches its orbit slowly if a multiplier is near 1.
const APART: f64 = 1000.0;

/// Largest number of orbits that are distinguished.
const MOST: usize = 1000;

/// A return to the surface.
#[derive(Debug, Clone)]
pub struct Return {
    /// The state after it.
    pub state: Vec<f64>,
    /// The time since the previous return; NaN for the first.
    pub duration: f64,
}

/// The points of the orbit that the last returns repeat, the last return first; empty if they do not repeat. A period
/// is found if the returns contain it twice. Durations are compared too, because equal states do not suffice if the
/// motion depends on time.
pub fn cycle(recent: &[Return], longest: usize, components: &Components) -> Vec<Vec<f64>> {
    let last = |back: usize| &recent[recent.len() - 1 - back];
    let are_same = |one: &Return, other: &Return| {
        components.are_same(&one.state, &other.state, 1.0)
            && !components.differ(one.duration, other.duration)
    };
    let repeats = |period: usize| {
        2 * period <= recent.len()
            && (0..period).all(|back| are_same(last(back), last(back + period)))
    };
    match (1..=longest).find(|&period| repeats(period)) {
        Some(period) => (0..period).map(|back| last(back).state.clone()).collect(),
        None => Vec::new(),
    }
}

/// An orbit to which cells converge.
#[derive(Debug, Clone, PartialEq)]
pub struct Orbit {
    /// Number of returns after which it closes.
    pub period: u64,
    /// The last return of the first cell that converges to it.
    pub point: Vec<f64>,
    /// Number of cells that converge to it.
    pub cells: u64,
}

/// The orbits of all cells, in the order of their first cells.
#[derive(Debug, Clone, Default)]
pub struct Orbits(Vec<Orbit>);

impl Orbits {
    /// The orbits.
    pub fn all(&self) -> &[Orbit] {
        &self.0
    }

    /// The number, counted from 1, of the orbit with these points. A new orbit gets the next number, or 0 if there are
    /// too many orbits.
    pub fn number(&self, cycle: &[Vec<f64>], components: &Components) -> u64 {
        let is_same = |orbit: &Orbit| {
            orbit.period == cycle.len() as u64
                && cycle
                    .iter()
                    .any(|point| components.are_same(point, &orbit.point, APART))
        };
        match self.0.iter().position(is_same) {
            Some(index) => index as u64 + 1,
            None if self.0.len() < MOST => self.0.len() as u64 + 1,
            None => 0,
        }
    }

    /// Counts a cell that converges to the orbit of this number, and adds the orbit if it is new. The number 0 is
    /// ignored.
    pub fn count(&mut self, number: u64, period: u64, point: &[f64]) {
        let Some(index) = number.checked_sub(1) else {
            return;
        };
        if index as usize == self.0.len() {
            self.0.push(Orbit {
                period,
                point: point.to_vec(),
                cells: 0,
            });
        }
        if let Some(orbit) = self.0.get_mut(index as usize) {
            orbit.cells += 1;
        }
    }
}
