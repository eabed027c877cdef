//! Sign changes of a function of time, by Chebyshev series on cells.
//!
//! On a cell the function is sampled at the extrema of a Chebyshev polynomial. A cell is decided if the series or its
//! derivative has no zero there. Any other cell is halved.

/// The degree of the series.
const DEGREE: usize = 8;

/// Samples of a cell.
const NODES: usize = DEGREE + 1;

/// Number of halvings of a step beyond which the signs at the ends of a cell decide.
const DEEPEST: u32 = 40;
/// Number of cells of a step beyond which the signs at the ends of a cell decide.
const CELLS: u32 = 400;

/// Fraction of the largest value so far below which a value counts as 0, because a state on a surface has rounding
/// errors.
const NOISE: f64 = 1e-13;

/// A sign change.
#[derive(Debug, Clone, Copy, PartialEq)]
pub(crate) struct Zero {
    pub t: f64,
    pub rising: bool,
}

/// The sign of a function along a run.
#[derive(Debug, Default)]
pub(crate) struct Sign {
    /// The last sign that was not 0.
    last: f64,
    /// The largest value so far.
    scale: f64,
}

/// Judgement on a cell.
enum Judgement {
    /// There is at most one sign change, and the values at the ends show it.
    Decided,
    Open,
}

impl Sign {
    /// Forgets the sign, because the motion jumps.
    pub(crate) fn jump(&mut self) {
        self.last = 0.0;
    }

    /// The sign changes in a step from `span[0]` to `span[1]`, in order.
    ///
    /// # Errors
    /// The error of the function.
    pub(crate) fn follow<E>(
        &mut self,
        span: [f64; 2],
        function: &mut dyn FnMut(f64) -> Result<f64, E>,
    ) -> Result<Vec<Zero>, E> {
        let mut zeros = Vec::new();
        let mut open = vec![(span, 0)];
        let mut cells = 0;
        while let Some(([a, b], depth)) = open.pop() {
            let mut values = [0.0; NODES];
            for (node, value) in values.iter_mut().enumerate() {
                *value = function(time([a, b], node))?;
                self.scale = self.scale.max(value.abs());
            }
            cells += 1;
            let middle = 0.5 * (a + b);
            let can_halve = depth < DEEPEST && cells < CELLS && a < middle && middle < b;
            if matches!(judge(&values), Judgement::Open) && can_halve {
                open.push(([middle, b], depth + 1));
                open.push(([a, middle], depth + 1));
                continue;
            }
            zeros.extend(self.pass([a, b], [values[DEGREE], values[0]], function)?);
        }
        Ok(zeros)
    }

    /// The sign of a value; 0 if the value may be rounding.
    fn of(&self, value: f64) -> f64 {
        match value.abs() > NOISE * self.scale {
            true => value.signum(),
            false => 0.0,
        }
    }

    /// Passes a cell with at most one sign change.
    fn pass<E>(
        &mut self,
        [a, b]: [f64; 2],
        ends: [f64; 2],
        function: &mut dyn FnMut(f64) -> Result<f64, E>,
    ) -> Result<Option<Zero>, E> {
        if self.last == 0.0 {
            self.last = self.of(ends[0]);
        }
        let (before, after) = (self.last, self.of(ends[1]));
        if after == 0.0 {
            return Ok(None);
        }
        self.last = after;
        if before == 0.0 || before == after {
            return Ok(None);
        }
        // The sign may have changed at the border itself.
        let t = match ends[0] * ends[1] < 0.0 {
            true => locate([a, b], ends, function)?,
            false => a,
        };
        let rising = after > 0.0;
        Ok(Some(Zero { t, rising }))
    }
}

/// The time of a node; the first is the end of the cell, the last its start.
fn time([a, b]: [f64; 2], node: usize) -> f64 {
    match node {
        0 => b,
        DEGREE => a,
        _ => {
            let x = (node as f64 * core::f64::consts::PI / DEGREE as f64).cos();
            0.5 * (a + b) + 0.5 * (b - a) * x
        }
    }
}

/// Decides whether the ends of a cell show its sign changes.
fn judge(values: &[f64; NODES]) -> Judgement {
    if values.iter().all(|value| !value.is_finite()) {
        return Judgement::Decided;
    }
    let series = series(values);
    let largest = values
        .iter()
        .fold(0.0_f64, |most, value| most.max(value.abs()));
    let error = 2.0 * (series[DEGREE - 1].abs() + series[DEGREE].abs()) + 1e-14 * largest;
    let slope = derivative(&series);
    // The derivative of a term of degree n is at most n^2 times as large.
    let steepness = (DEGREE * DEGREE) as f64;
    match stays_away(&series, error) || stays_away(&slope, steepness * error) {
        true => Judgement::Decided,
        false => Judgement::Open,
    }
}

/// True if a series with this error has no zero in its cell.
fn stays_away(series: &[f64; NODES], error: f64) -> bool {
    let rest: f64 = series[1..].iter().map(|term| term.abs()).sum();
    series[0].abs() > rest + error
}

/// The Chebyshev series through the values at the nodes.
fn series(values: &[f64; NODES]) -> [f64; NODES] {
    let half = |index: usize| {
        if index == 0 || index == DEGREE {
            0.5
        } else {
            1.0
        }
    };
    core::array::from_fn(|k| {
        let terms = values.iter().enumerate().map(|(j, value)| {
            let angle = (j * k) as f64 * core::f64::consts::PI / DEGREE as f64;
            half(j) * value * angle.cos()
        });
        half(k) * terms.sum::<f64>() * 2.0 / DEGREE as f64
    })
}

/// The series of the derivative.
fn derivative(series: &[f64; NODES]) -> [f64; NODES] {
    let mut slope = [0.0; NODES];
    for k in (1..NODES).rev() {
        let above = if k + 1 < NODES { slope[k + 1] } else { 0.0 };
        slope[k - 1] = above + 2.0 * k as f64 * series[k];
    }
    slope[0] *= 0.5;
    slope
}

/// The zero between two times at which the function has different signs: false position, with bisection every third
/// step.
fn locate<E>(
    [mut a, mut b]: [f64; 2],
    [mut low, mut high]: [f64; 2],
    function: &mut dyn FnMut(f64) -> Result<f64, E>,
) -> Result<f64, E> {
    for round in 0..200 {
        let middle = 0.5 * (a + b);
        if !(a < middle && middle < b) {
            break;
        }
        let chord = a - low * (b - a) / (high - low);
        let inside = a < chord && chord < b && round % 3 != 2;
        let t = if inside { chord } else { middle };
        let value = function(t)?;
        if value == 0.0 {
            return Ok(t);
        }
        match value * high > 0.0 {
            true => (b, high) = (t, value),
            false => (a, low) = (t, value),
        }
    }
    Ok(if low.abs() < high.abs() { a } else { b })
}
