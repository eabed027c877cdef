//! Sums over the rows of a map.

use super::orbits::Orbits;
use super::request::{Colours, Request};
use dalembert_driver::ensemble::row::{Columns, Field, Row};
use dalembert_driver::ensemble::runner::{PANICKED, REFUSED};

/// Sums over cells.
pub struct Sums {
    places: Places,
    /// Number of cells.
    pub cells: u64,
    /// The classes in the order of their first cells, with their numbers of cells.
    pub classes: Vec<(String, u64)>,
    /// The orbits.
    pub orbits: Orbits,
    /// Number of returns.
    pub returns: u64,
    /// Number of cells whose start was refused or whose run panicked.
    pub refused: u64,
    /// The reason for the first of them.
    pub reason: Option<String>,
    /// The data of the picture, if one is drawn.
    pub drawn: Option<Cells>,
}

/// The data of the picture for each cell, in the order of the cells.
#[derive(Debug, Clone, Default)]
pub struct Cells {
    /// The index of the class of each cell.
    pub classes: Vec<usize>,
    /// The number that the colour of each cell shows; empty if colours show classes.
    pub numbers: Vec<f64>,
    /// For each contour, the values of its expression at the starts of the cells.
    pub contours: Vec<Vec<f64>>,
    /// The point of each cell on the axes of `--axes`; empty without that flag.
    pub places: Vec<[f64; 2]>,
}

/// Indices of columns in a row.
struct Places {
    class: usize,
    outcome: usize,
    returns: usize,
    period: usize,
    orbit: usize,
    end: std::ops::Range<usize>,
    number: Option<usize>,
    contours: std::ops::Range<usize>,
    plane: Option<[usize; 2]>,
    reason: usize,
}

impl Places {
    fn of(columns: &Columns, request: &Request) -> Self {
        let place = |name: &str| columns.position(name).unwrap_or(usize::MAX);
        let (t, reason) = (place("t"), place("reason"));
        Self {
            class: place("class"),
            outcome: place("outcome"),
            returns: place("returns"),
            period: place("period"),
            orbit: place("orbit"),
            end: t + 1..t + 1 + request.components.names.len(),
            number: match request.colours {
                Colours::End => None,
                Colours::Returns => Some(place("returns")),
                Colours::Exponent => Some(place("exponent")),
                Colours::Value(_) => Some(place("value")),
            },
            contours: reason - request.contours.len()..reason,
            plane: (request.plane.as_ref()).map(|names| [place(&names[0]), place(&names[1])]),
            reason,
        }
    }
}

/// A field as a number.
fn number(field: Option<&Field>) -> f64 {
    match field {
        Some(Field::Number(value)) => *value,
        Some(Field::Integer(value)) => *value as f64,
        _ => f64::NAN,
    }
}

fn count(field: Option<&Field>) -> u64 {
    match field {
        Some(Field::Integer(value)) => *value,
        _ => 0,
    }
}

fn text(field: Option<&Field>) -> &str {
    match field {
        Some(Field::Text(text)) => text,
        _ => "",
    }
}

impl Sums {
    /// Sums over no rows.
    pub fn new(columns: &Columns, request: &Request, is_drawn: bool) -> Self {
        Self {
            places: Places::of(columns, request),
            cells: 0,
            classes: Vec::new(),
            orbits: Orbits::default(),
            returns: 0,
            refused: 0,
            reason: None,
            drawn: is_drawn.then(|| Cells {
                contours: vec![Vec::new(); request.contours.len()],
                ..Cells::default()
            }),
        }
    }

    /// Adds a row.
    pub fn add(&mut self, row: &Row) {
        let places = &self.places;
        self.cells += 1;
        self.returns += count(row.get(places.returns));
        let outcome = text(row.get(places.outcome));
        if outcome == REFUSED || outcome == PANICKED {
            self.refused += 1;
            let reason = || text(row.get(places.reason)).to_owned();
            self.reason.get_or_insert_with(reason);
        }
        let end: Vec<f64> = places
            .end
            .clone()
            .map(|place| number(row.get(place)))
            .collect();
        let (orbit, period) = (count(row.get(places.orbit)), count(row.get(places.period)));
        self.orbits.count(orbit, period, &end);
        let class = text(row.get(places.class));
        let index = self.classes.iter().position(|(name, _)| name == class);
        let index = index.unwrap_or_else(|| {
            self.classes.push((class.to_owned(), 0));
            self.classes.len() - 1
        });
        self.classes[index].1 += 1;
        if let Some(drawn) = &mut self.drawn {
            drawn.classes.push(index);
            if let Some(place) = places.number {
                drawn.numbers.push(number(row.get(place)));
            }
            if let Some(plane) = places.plane {
                drawn.places.push(plane.map(|place| number(row.get(place))));
            }
            for (line, place) in drawn.contours.iter_mut().zip(places.contours.clone()) {
                line.push(number(row.get(place)));
            }
        }
    }

    /// The indices of the classes: orbits by number, then periods by length, then the other classes from most to fewest
    /// cells.
    pub fn sorted_classes(&self) -> Vec<usize> {
        let rank = |index: &usize| {
            let (name, cells) = &self.classes[*index];
            let numbered = |word: &str| -> Option<u64> {
                let rest = name.strip_prefix(word)?;
                rest.split(' ').next()?.parse().ok()
            };
            match (numbered("orbit "), numbered("period ")) {
                (Some(orbit), _) => (0, orbit),
                (_, Some(period)) => (1, period),
                _ => (2, u64::MAX - cells),
            }
        };
        let mut sorted: Vec<usize> = (0..self.classes.len()).collect();
        sorted.sort_by_key(rank);
        sorted
    }
}
