//! Sums over all members.

use std::collections::BTreeMap;

use super::row::{Columns, Field, Row};

/// Maximum number of listed members that did not reach their end.
const TOLD: usize = 5;

/// A member that did not reach its end.
#[derive(Debug, Clone, PartialEq)]
pub struct Strayed {
    /// The member.
    pub member: u64,
    /// Its outcome.
    pub outcome: String,
    /// The details of the outcome.
    pub reason: String,
}

/// Sums over members.
#[derive(Debug, Clone)]
pub struct Tally {
    places: Places,
    /// Number of members.
    pub members: u64,
    /// Number of members by outcome.
    pub outcomes: BTreeMap<String, u64>,
    /// Number of impacts on each surface.
    pub impacts: Vec<u64>,
    /// The largest absolute change of the energy.
    pub energy_change: f64,
    /// The largest change of the energy, relative to its value at the start.
    pub relative_change: f64,
    /// Number of members that did not reach their end.
    pub strayed: u64,
    /// The first of these members.
    pub first_strayed: Vec<Strayed>,
}

/// Positions of values in a row.
#[derive(Debug, Clone)]
struct Places {
    outcome: Option<usize>,
    energy: Option<usize>,
    impacts: Vec<usize>,
    reason: Option<usize>,
}

impl Tally {
    /// An empty tally for rows with these columns.
    pub fn new(columns: &Columns) -> Self {
        let named = columns.iter().enumerate();
        let impacts = named.filter(|(_, (name, _))| name.starts_with("impacts."));
        let places = Places {
            outcome: columns.position("outcome"),
            energy: columns.position("energy"),
            impacts: impacts.map(|(index, _)| index).collect(),
            reason: columns.position("reason"),
        };
        Self {
            members: 0,
            outcomes: BTreeMap::new(),
            impacts: vec![0; places.impacts.len()],
            energy_change: 0.0,
            relative_change: 0.0,
            strayed: 0,
            first_strayed: Vec::new(),
            places,
        }
    }

    /// Adds a row. `reached` is true for outcomes that are the requested end.
    pub fn add(&mut self, row: &Row, reached: impl Fn(&str) -> bool) {
        let text = |place: Option<usize>| match place.and_then(|place| row.get(place)) {
            Some(Field::Text(text)) => text.as_ref(),
            _ => "",
        };
        let number = |place: usize| match row.get(place) {
            Some(Field::Number(value)) => *value,
            _ => f64::NAN,
        };
        self.members += 1;
        let outcome = text(self.places.outcome);
        match self.outcomes.get_mut(outcome) {
            Some(count) => *count += 1,
            None => {
                self.outcomes.insert(outcome.to_owned(), 1);
            }
        }
        for (sum, &place) in self.impacts.iter_mut().zip(&self.places.impacts) {
            if let Some(Field::Integer(count)) = row.get(place) {
                *sum += count;
            }
        }
        if let Some(place) = self.places.energy {
            let (energy, change) = (number(place), number(place + 1));
            // The maximum ignores NaN.
            self.energy_change = self.energy_change.max(change.abs());
            let relative = (change / (energy - change)).abs();
            if relative.is_finite() {
                self.relative_change = self.relative_change.max(relative);
            }
        }
        if !reached(outcome) {
            self.strayed += 1;
            if self.first_strayed.len() < TOLD
                && let Some(&Field::Integer(member)) = row.first()
            {
                self.first_strayed.push(Strayed {
                    member,
                    outcome: outcome.to_owned(),
                    reason: text(self.places.reason).to_owned(),
                });
            }
        }
    }
}
