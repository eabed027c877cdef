//! The curve of a picture: points along a run, closer together where the curve bends, with both sides of every impact.

use dalembert_driver::{Piece, Point};

use super::quantity::Quantity;

/// Intervals into which every step is first divided.
const INTERVALS: usize = 12;

/// Largest number of halvings of an interval.
const DEPTH: u32 = 8;

/// Number of points beyond which only every second of the steps that are left is shown.
const MANY: usize = 200_000;

/// Length of a line that is too short to be seen, relative to the extent of the curve.
const SHORT: f64 = 1.0 / 1024.0;

/// Cosine of the largest angle between lines of the same direction.
const ALIGNED: f64 = 0.98;

/// An interval is halved while the distance of its midpoint from its chord exceeds this fraction of the curve's extent.
const FLATNESS: f64 = 3e-4;

/// Components of the points of a curve.
#[derive(Debug, Clone, PartialEq, Eq)]
pub enum Source {
    /// The point in the plane of the declared view.
    View,
    /// All coordinates, then all outputs.
    Coordinates,
    /// Quantities: the abscissa, then the ordinates.
    Quantities(Vec<Quantity>),
}

impl Source {
    /// The components at a state. `start` is the energy at the start of the run.
    pub(super) fn values(&self, t: f64, point: &Point, start: f64) -> Vec<f64> {
        match self {
            Self::View => point.view.map_or_else(Vec::new, |view| view.to_vec()),
            Self::Coordinates => point.q.iter().chain(&point.outputs).copied().collect(),
            Self::Quantities(quantities) => quantities
                .iter()
                .map(|quantity| quantity.value(t, point, start))
                .collect(),
        }
    }

    /// True if states inside a step add to the curve. They do not for energies alone: inside a step, energies only show
    /// errors of the dense output.
    fn looks_inside(&self) -> bool {
        match self {
            Self::View | Self::Coordinates => true,
            Self::Quantities(quantities) => quantities
                .iter()
                .any(|quantity| *quantity != Quantity::Time && quantity.is_smooth()),
        }
    }

    /// True if more points make the curve of this component smoother.
    fn is_smooth(&self, index: usize) -> bool {
        match self {
            Self::View | Self::Coordinates => true,
            Self::Quantities(quantities) => quantities[index].is_smooth(),
        }
    }
}

/// True if two lines have about the same direction.
fn is_aligned(a: [f64; 2], b: [f64; 2]) -> bool {
    let product = a[0] * b[0] + a[1] * b[1];
    product > ALIGNED * a[0].hypot(a[1]) * b[0].hypot(b[1])
}

/// A curve under construction.
#[derive(Debug)]
pub struct Trace {
    source: Source,
    /// The energy at the start; `None` before the first point.
    start: Option<f64>,
    points: Vec<Mark>,
    /// Least and greatest value so far, per component.
    extent: Vec<[f64; 2]>,
    /// Number of steps so far.
    steps: u64,
    /// One step out of this many is shown, with all its points.
    stride: u64,
}

/// A point of the curve.
#[derive(Debug, Clone)]
pub struct Mark {
    /// Its time.
    pub t: f64,
    /// The values of the components at that time.
    pub values: Vec<f64>,
    /// True for either side of an impact, for an event of a contact and for an end of the run.
    pub corner: bool,
    /// Number of the step that it ends or belongs to, counted from 1.
    pub(super) step: u64,
}

impl Mark {
    /// True if an impact or a transition changes the values from this point to the next.
    pub(super) fn jumps_to(&self, next: &Self) -> bool {
        let mut values = self.values.iter().zip(&next.values);
        let is_same = |(a, b): (&f64, &f64)| a == b || (a.is_nan() && b.is_nan());
        self.corner && next.corner && self.t == next.t && !values.all(is_same)
    }

    /// True if no step between this point and the next one was left out.
    fn leads_to(&self, next: &Self) -> bool {
        next.step <= self.step + 1
    }
}

impl Trace {
    /// An empty curve.
    pub fn of(source: Source) -> Self {
        Self {
            source,
            start: None,
            points: Vec::new(),
            extent: Vec::new(),
            steps: 0,
            stride: 1,
        }
    }

    /// The components of its points.
    pub fn source(&self) -> &Source {
        &self.source
    }

    /// The points in order of time. Each has a finite value; values that a point lacks are NaN, such as those of
    /// coordinates that belong to other modes.
    pub fn points(&self) -> &[Mark] {
        &self.points
    }

    /// The curve with the points `at`, in stretches between jumps, steps that are left out, and points at which a component is
    /// NaN. The curve goes on over steps that are left out where a line over them has its direction, or is too short to be seen.
    pub fn stretches(&self, at: impl Fn(&Mark) -> [f64; 2]) -> Vec<Vec<[f64; 2]>> {
        let points: Vec<[f64; 2]> = self.points.iter().map(at).collect();
        let sizes = [0, 1].map(|axis| {
            let values = points.iter().map(|point| point[axis]);
            let finite = values.filter(|value| value.is_finite());
            let ends = [f64::INFINITY, f64::NEG_INFINITY];
            let [least, most] = finite.fold(ends, |[a, b], value| [a.min(value), b.max(value)]);
            f64::max(most - least, f64::MIN_POSITIVE)
        });
        let line = |from: usize| -> Option<[f64; 2]> {
            let (left, right) = (points.get(from)?, points.get(from + 1)?);
            Some([0, 1].map(|axis| (right[axis] - left[axis]) / sizes[axis]))
        };
        let goes_on = |index: usize| {
            let over = line(index).unwrap_or_default();
            let is_along = |from: Option<usize>| {
                let beside = from.and_then(line);
                beside.is_none_or(|beside| is_aligned(over, beside))
            };
            let is_short = over.iter().all(|length| length.abs() <= SHORT);
            is_short || (is_along(index.checked_sub(1)) && is_along(Some(index + 1)))
        };
        let mut stretches = vec![Vec::new()];
        for (index, point) in points.iter().enumerate() {
            let is_whole = point.iter().all(|value| value.is_finite());
            let goes_on = index.checked_sub(1).is_none_or(|before| {
                let (left, right) = (&self.points[before], &self.points[index]);
                !left.jumps_to(right) && (left.leads_to(right) || goes_on(before))
            });
            if !goes_on || !is_whole {
                stretches.push(Vec::new());
            }
            if let (true, Some(stretch)) = (is_whole, stretches.last_mut()) {
                stretch.push(*point);
            }
        }
        stretches.retain(|stretch| !stretch.is_empty());
        stretches
    }

    /// Both sides of every jump.
    pub fn jumps(&self) -> impl Iterator<Item = [&Mark; 2]> {
        let pairs = self.points.windows(2);
        pairs
            .filter(|pair| pair[0].jumps_to(&pair[1]))
            .map(|pair| [&pair[0], &pair[1]])
    }

    /// Adds a step without impacts inside.
    pub fn follow(&mut self, piece: &dyn Piece) {
        self.steps += 1;
        if !self.is_shown(self.steps) {
            return;
        }
        let (start, end) = piece.span();
        let (intervals, depth) = match self.source.looks_inside() {
            true => (INTERVALS, DEPTH),
            false => (1, 0),
        };
        let time = |index: usize| start + (end - start) * (index as f64 / intervals as f64);
        let marks: Vec<Mark> = (0..=intervals)
            .map(|index| self.mark(time(index), &piece.at(time(index))))
            .collect();
        // The extent is updated for the whole step first, so that flatness is not judged against a small first
        // interval.
        marks.iter().for_each(|mark| self.widen(mark));
        for pair in marks.windows(2) {
            self.push(pair[0].clone());
            self.refine(piece, &pair[0], &pair[1], depth);
        }
        if let Some(last) = marks.into_iter().next_back() {
            self.push(last);
        }
        self.thin();
    }

    /// Adds one side of an impact, or an event of a contact.
    pub fn corner(&mut self, t: f64, point: &Point) {
        if self.is_shown(self.steps) {
            self.end(t, point);
        }
    }

    /// Adds an end of the run.
    pub fn end(&mut self, t: f64, point: &Point) {
        let mark = Mark {
            corner: true,
            ..self.mark(t, point)
        };
        self.widen(&mark);
        self.push(mark);
    }

    fn mark(&mut self, t: f64, point: &Point) -> Mark {
        let start = *self.start.get_or_insert(point.energy);
        Mark {
            t,
            values: self.source.values(t, point, start),
            corner: false,
            step: self.steps,
        }
    }

    /// Adds points between two points until the curve between neighbours is flat.
    fn refine(&mut self, piece: &dyn Piece, left: &Mark, right: &Mark, depth: u32) {
        let t = 0.5 * (left.t + right.t);
        if depth == 0 || t <= left.t || t >= right.t {
            return;
        }
        let middle = self.mark(t, &piece.at(t));
        if self.is_flat(left, &middle, right) {
            return;
        }
        self.refine(piece, left, &middle, depth - 1);
        self.widen(&middle);
        self.push(middle.clone());
        self.refine(piece, &middle, right, depth - 1);
    }

    fn is_flat(&self, left: &Mark, middle: &Mark, right: &Mark) -> bool {
        let ends = left.values.iter().zip(&right.values);
        ends.zip(&middle.values)
            .zip(&self.extent)
            .enumerate()
            .filter(|(index, _)| self.source.is_smooth(*index))
            .all(|(_, (((left, right), middle), [low, high]))| {
                // A comparison with NaN is false, so an undefined value counts as flat. Subdivision would not define
                // it.
                let deviation = (middle - 0.5 * (left + right)).abs();
                let bent = deviation > FLATNESS * (high - low);
                !bent
            })
    }

    fn widen(&mut self, mark: &Mark) {
        self.extent
            .resize(mark.values.len(), [f64::INFINITY, f64::NEG_INFINITY]);
        for (extent, &value) in self
            .extent
            .iter_mut()
            .zip(&mark.values)
            .filter(|(_, value)| value.is_finite())
        {
            *extent = [extent[0].min(value), extent[1].max(value)];
        }
    }

    fn push(&mut self, mut mark: Mark) {
        for value in mark.values.iter_mut().filter(|value| !value.is_finite()) {
            *value = f64::NAN;
        }
        if mark.values.iter().any(|value| value.is_finite()) {
            self.points.push(mark);
        }
    }

    /// True if a step is shown. The start of the run counts as step 0.
    fn is_shown(&self, step: u64) -> bool {
        step.saturating_sub(1).is_multiple_of(self.stride)
    }

    /// Leaves out every second step while there are too many points.
    fn thin(&mut self) {
        while self.points.len() > MANY && self.stride < self.steps {
            self.stride *= 2;
            let mut points = std::mem::take(&mut self.points);
            points.retain(|mark| self.is_shown(mark.step));
            self.points = points;
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    struct Circle;

    impl Piece for Circle {
        fn span(&self) -> (f64, f64) {
            (0.0, 30.0)
        }

        fn at(&self, t: f64) -> Point {
            Point {
                mode: None,
                q: vec![t],
                qdot: vec![1.0],
                p: vec![1.0],
                energy: 0.5 + 1e-14 * (1e6 * t).sin(),
                outputs: vec![],
                view: Some([t.cos(), t.sin()]),
            }
        }
    }

    #[test]
    fn a_curve_that_turns_many_times_in_one_step_is_smooth() {
        let mut trace = Trace::of(Source::View);
        trace.follow(&Circle);
        let turns = trace.points().windows(2).map(|pair| pair[1].t - pair[0].t);
        assert!(turns.fold(0.0, f64::max) < 0.1);
        assert!(trace.points().windows(2).all(|pair| pair[0].t < pair[1].t));
    }

    #[test]
    fn of_an_energy_only_the_ends_of_steps_are_shown() {
        let count = |quantities: &[Quantity]| {
            let mut trace = Trace::of(Source::Quantities(quantities.to_vec()));
            trace.follow(&Circle);
            trace.points().len()
        };
        assert_eq!(count(&[Quantity::Time, Quantity::EnergyError]), 2);
        // Rounding errors do not require more points than a straight curve alone.
        let beside = [Quantity::Time, Quantity::Position(0), Quantity::EnergyError];
        assert_eq!(count(&beside), INTERVALS + 1);
    }

    #[test]
    fn a_run_of_many_steps_shows_some_of_them_whole() {
        let mut trace = Trace::of(Source::View);
        let steps = 5000;
        for _ in 0..steps {
            trace.follow(&Circle);
        }
        assert!(trace.points().len() <= MANY);
        let stretches = trace.stretches(|mark| [mark.values[0], mark.values[1]]);
        assert!(
            stretches.len() as u64 >= steps / trace.stride,
            "{}",
            stretches.len()
        );
        for stretch in stretches {
            let apart = stretch
                .windows(2)
                .map(|pair| (pair[1][0] - pair[0][0]).hypot(pair[1][1] - pair[0][1]));
            assert!(apart.fold(0.0, f64::max) < 0.1);
        }
    }

    #[test]
    fn a_smooth_curve_of_many_steps_has_no_gaps() {
        struct Short(f64);

        impl Piece for Short {
            fn span(&self) -> (f64, f64) {
                (self.0, self.0 + 1e-3)
            }

            fn at(&self, t: f64) -> Point {
                Circle.at(t)
            }
        }

        let mut trace = Trace::of(Source::View);
        for step in 0..60_000_u32 {
            trace.follow(&Short(1e-3 * f64::from(step)));
        }
        assert!(trace.stride > 1);
        let stretches = trace.stretches(|mark| [mark.values[0], mark.values[1]]);
        assert_eq!(stretches.len(), 1);
    }

    #[test]
    fn a_straight_curve_needs_few_points() {
        let mut trace = Trace::of(Source::Coordinates);
        trace.follow(&Circle);
        assert_eq!(trace.points().len(), INTERVALS + 1);
    }

    #[test]
    fn a_value_that_a_mode_lacks_leaves_the_others_drawn() {
        struct Walk;
        impl Piece for Walk {
            fn span(&self) -> (f64, f64) {
                (0.0, 3.0)
            }

            fn at(&self, t: f64) -> Point {
                let foot = if (1.0..=2.0).contains(&t) {
                    f64::NAN
                } else {
                    t
                };
                Point {
                    q: vec![t, foot],
                    ..Circle.at(t)
                }
            }
        }
        let mut trace = Trace::of(Source::Coordinates);
        trace.follow(&Walk);
        let count = |index: usize| trace.stretches(|mark| [mark.t, mark.values[index]]).len();
        assert_eq!([count(0), count(1)], [1, 2]);
    }
}
