//! Long-run densities: counts of the positions of a run at equally spaced times in the boxes of a grid.
//!
//! For a set A in the plane of the declared view, `rho(A)` is the fraction of the times `k T` at which the position
//! lies in A (W. Clark and A. Bloch, equation (27)).

use dalembert_driver::{Contact, Impact, Piece, Watch};

use super::Density;
use crate::args::SimulateArgs;
use crate::command::simulate::{prepare, summary};
use crate::entry::Entry;
use crate::error::CliError;
use crate::plot::contour::Window;
use crate::plot::{self, Drawn, heat};
use crate::state_input::build_run;

/// Makes the run, counts its positions and draws their density.
///
/// # Errors
/// Invalid flags, a state that is refused, a model without a view of two coordinates with a region.
pub fn draw(
    models: &[Entry],
    args: &SimulateArgs,
    density: &Density,
    title: &str,
) -> Result<Drawn, CliError> {
    let model = build_run(models, &args.run)?;
    let prepared = prepare(model.as_ref(), args)?;
    let table = plot::Table {
        model: model.as_ref(),
        q: &prepared.origin.q,
    };
    let refuse = |reason| CliError::picture(&args.plot, reason);
    let mut census = Census::new(density, table.extent().map_err(refuse)?);
    let ending = model
        .simulate(&prepared.origin, &prepared.settings, &mut census)
        .map_err(|refusal| CliError::refused(model.as_ref(), &refusal))?;
    let subtitle = format!(
        "{} positions; total variation of the halves {:.3}",
        census.counted(),
        census.variation()
    );
    let svg = heat::draw(&heat::Map {
        table: &table,
        title,
        subtitle: &subtitle,
        window: census.window,
        boxes: census.boxes,
        densities: &census.densities(),
    });
    Ok(Drawn {
        svg: svg.map_err(refuse)?,
        outcome: summary::ended(model.description(), &ending),
    })
}

impl Density {
    /// A copy with a fiftieth of the positions.
    pub(super) fn quick(&self) -> Self {
        Self {
            positions: (self.positions / 50).max(1),
            discarded: self.discarded / 50,
            ..self.clone()
        }
    }

    /// The time of the last position.
    pub(super) fn until(&self) -> f64 {
        self.every * (self.discarded + self.positions) as f64
    }
}

/// Counts positions during a run.
struct Census {
    every: f64,
    /// The index of the next time.
    next: u64,
    discarded: u64,
    /// The last index of the first half.
    half: u64,
    window: Window,
    boxes: usize,
    /// Counts of the two halves of the times, row by row from the bottom.
    counts: [Vec<u32>; 2],
}

impl Census {
    fn new(density: &Density, window: Window) -> Self {
        let nothing = vec![0; density.boxes * density.boxes];
        Self {
            every: density.every,
            next: 1,
            discarded: density.discarded,
            half: density.discarded + density.positions / 2,
            window,
            boxes: density.boxes,
            counts: [nothing.clone(), nothing],
        }
    }

    fn count(&mut self, [x, y]: [f64; 2]) {
        if x.is_nan() || y.is_nan() {
            return;
        }
        let place = |value: f64, [low, high]: [f64; 2]| {
            let share = (value - low) / (high - low);
            // A point on the upper edge belongs to the last box; the cast of a negative number is 0.
            ((share * self.boxes as f64) as usize).min(self.boxes - 1)
        };
        let index = place(y, self.window.y) * self.boxes + place(x, self.window.x);
        let half = usize::from(self.next > self.half);
        self.counts[half][index] += 1;
    }

    fn counted(&self) -> u64 {
        let all = self.counts.iter().flatten();
        all.map(|&count| u64::from(count)).sum()
    }

    /// Half the sum of the absolute differences between the normalised counts of both halves: 0 if they agree, 1 if
    /// they have no box in common.
    fn variation(&self) -> f64 {
        let total = |counts: &[u32]| counts.iter().map(|&count| f64::from(count)).sum::<f64>();
        let [first, second] = &self.counts;
        let (whole, other) = (total(first).max(1.0), total(second).max(1.0));
        let pairs = first.iter().zip(second);
        0.5 * pairs
            .map(|(&a, &b)| (f64::from(a) / whole - f64::from(b) / other).abs())
            .sum::<f64>()
    }

    /// Positions per unit of area, relative to all counted positions.
    fn densities(&self) -> Vec<f64> {
        let Window { x, y } = self.window;
        let area = (x[1] - x[0]) * (y[1] - y[0]) / (self.boxes * self.boxes) as f64;
        let weight = 1.0 / (area * self.counted().max(1) as f64);
        let [first, second] = &self.counts;
        let pairs = first.iter().zip(second);
        pairs.map(|(a, b)| f64::from(a + b) * weight).collect()
    }
}

impl Watch for Census {
    fn step(&mut self, piece: &dyn Piece) {
        let (_, end) = piece.span();
        loop {
            let t = self.every * self.next as f64;
            if t > end {
                return;
            }
            if self.next > self.discarded
                && let Some(at) = piece.at(t).view
            {
                self.count(at);
            }
            self.next += 1;
        }
    }

    fn hears(&mut self, _impact: &Impact<()>) -> bool {
        false
    }

    fn impact(&mut self, _impact: Impact) {}

    fn contact(&mut self, _contact: Contact) {}
}

#[cfg(test)]
mod tests {
    use dalembert_driver::Point;

    use super::*;

    const UNIT: Window = Window {
        x: [0.0, 1.0],
        y: [0.0, 1.0],
    };

    fn census(positions: u64, discarded: u64) -> Census {
        let density = Density {
            flags: String::new(),
            every: 1.0 / 128.0,
            positions,
            discarded,
            boxes: 4,
        };
        Census::new(&density, UNIT)
    }

    /// Moves along the diagonal of the square of side 1 repeatedly, once per unit of time.
    struct Diagonal(f64, f64);

    impl Piece for Diagonal {
        fn span(&self) -> (f64, f64) {
            (self.0, self.1)
        }

        fn at(&self, t: f64) -> Point {
            Point {
                mode: None,
                q: vec![],
                qdot: vec![],
                p: vec![],
                energy: 0.0,
                outputs: vec![],
                view: Some([t.fract(); 2]),
            }
        }
    }

    #[test]
    fn a_steady_motion_is_as_often_in_every_box_it_crosses() {
        let mut census = census(2 * 128, 128);
        for step in 0..30 {
            let t = 0.1 * f64::from(step);
            census.step(&Diagonal(t, t + 0.1));
        }
        census.step(&Diagonal(3.0, 3.0));
        assert_eq!(census.counted(), 256);
        let densities = census.densities();
        for (index, density) in densities.iter().enumerate() {
            // Four boxes of area 1/16 hold a quarter of the positions each.
            let expected = if index % 5 == 0 { 4.0 } else { 0.0 };
            assert_eq!(*density, expected, "{index}");
        }
        assert_eq!(census.variation(), 0.0);
    }

    #[test]
    fn halves_that_have_nothing_in_common_differ_by_one() {
        let mut census = census(64, 0);
        for index in 1..=64 {
            census.next = index;
            census.count(if index <= 32 { [0.1, 0.1] } else { [1.0, 1.0] });
        }
        assert_eq!(census.variation(), 1.0);
        assert_eq!(census.densities()[15], 8.0);
    }
}
