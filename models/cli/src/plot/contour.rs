//! Contours of a function on a rectangle by marching squares.
//!
//! The function is sampled on a grid and counts as negative outside it, so that the boundary of the region of positive
//! values consists of closed polygons. They are oriented with the positive side on the left (in axes with y upward): a
//! counterclockwise polygon has the region inside.

use std::collections::BTreeMap;

/// A rectangle.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Window {
    /// Least and greatest abscissa.
    pub x: [f64; 2],
    /// Least and greatest ordinate.
    pub y: [f64; 2],
}

impl Window {
    /// The point at these fractions of the width and the height.
    pub fn at(&self, x: f64, y: f64) -> [f64; 2] {
        [
            self.x[0] + x * (self.x[1] - self.x[0]),
            self.y[0] + y * (self.y[1] - self.y[0]),
        ]
    }

    /// The rectangle extended on each side by a fraction of its size.
    pub fn grown(&self, part: f64) -> Self {
        let [low, high] = [self.at(-part, -part), self.at(1.0 + part, 1.0 + part)];
        Self {
            x: [low[0], high[0]],
            y: [low[1], high[1]],
        }
    }

    /// The smallest rectangle that contains the points; `None` without points.
    pub fn around(points: impl Iterator<Item = [f64; 2]>) -> Option<Self> {
        points.fold(None, |window: Option<Self>, [x, y]| {
            let Self {
                x: [left, right],
                y: [bottom, top],
            } = window.unwrap_or(Self {
                x: [x, x],
                y: [y, y],
            });
            Some(Self {
                x: [left.min(x), right.max(x)],
                y: [bottom.min(y), top.max(y)],
            })
        })
    }
}

/// A closed polygon of the boundary.
#[derive(Debug, Clone)]
pub struct Contour {
    /// Its corners; the last is joined to the first.
    pub points: Vec<[f64; 2]>,
    /// For each corner, true if the side to the next corner runs along the edge of the rectangle.
    pub on_frame: Vec<bool>,
}

impl Contour {
    /// The area, positive if the region is inside.
    pub fn signed_area(&self) -> f64 {
        let next = self.points.iter().cycle().skip(1);
        0.5 * self
            .points
            .iter()
            .zip(next)
            .map(|(a, b)| a[0] * b[1] - a[1] * b[0])
            .sum::<f64>()
    }
}

/// A side of a grid square, given by its left or lower node.
#[derive(Debug, Clone, Copy, PartialEq, Eq, PartialOrd, Ord)]
enum Side {
    Horizontal(usize, usize),
    Vertical(usize, usize),
}

/// Values on the nodes of `cells + 2` by `cells + 2` squares; the outermost nodes are negative.
struct Grid {
    window: Window,
    cells: usize,
    values: Vec<f64>,
}

/// The boundary of the region of positive values of `function`, on a grid of `cells` by `cells` squares. Undefined
/// values count as negative.
pub fn contours(window: Window, cells: usize, function: impl Fn([f64; 2]) -> f64) -> Vec<Contour> {
    let grid = Grid::sample(window, cells, function);
    let mut following = BTreeMap::new();
    for row in 0..cells + 2 {
        for column in 0..cells + 2 {
            following.extend(grid.segments(column, row));
        }
    }
    let mut contours = Vec::new();
    while let Some((first, mut next)) = following.pop_first() {
        let mut sides = vec![first];
        while next != first {
            sides.push(next);
            // Each side on which the function changes sign starts one segment and ends one, so the chain closes.
            let Some(after) = following.remove(&next) else {
                break;
            };
            next = after;
        }
        contours.push(grid.contour(&sides));
    }
    contours
}

impl Grid {
    fn sample(window: Window, cells: usize, function: impl Fn([f64; 2]) -> f64) -> Self {
        let nodes = cells + 3;
        let mut values = vec![-1.0; nodes * nodes];
        for row in 1..=cells + 1 {
            for column in 1..=cells + 1 {
                let value = function(window.at(
                    (column - 1) as f64 / cells as f64,
                    (row - 1) as f64 / cells as f64,
                ));
                values[row * nodes + column] = if value.is_finite() { value } else { -1.0 };
            }
        }
        Self {
            window,
            cells,
            values,
        }
    }

    fn value(&self, column: usize, row: usize) -> f64 {
        self.values[row * (self.cells + 3) + column]
    }

    /// The directed segments inside a square, each from a side to a side, the positive corners on its left.
    fn segments(&self, column: usize, row: usize) -> Vec<(Side, Side)> {
        let corners =
            [(0, 0), (1, 0), (1, 1), (0, 1)].map(|(i, j)| self.value(column + i, row + j));
        let positive = corners.map(|value| value > 0.0);
        let sides = [
            Side::Horizontal(column, row),
            Side::Vertical(column + 1, row),
            Side::Horizontal(column, row + 1),
            Side::Vertical(column, row),
        ];
        // Counterclockwise, side k leads from corner k to corner k + 1. A segment starts on a side on which the
        // function turns negative, and ends on a side on which it turns positive.
        let starts: Vec<usize> = (0..4)
            .filter(|&k| positive[k] && !positive[(k + 1) % 4])
            .collect();
        let ends: Vec<usize> = (0..4)
            .filter(|&k| !positive[k] && positive[(k + 1) % 4])
            .collect();
        let joined = corners.iter().sum::<f64>() > 0.0;
        let end_of = |start: usize| match ends.as_slice() {
            [end] => *end,
            // A saddle. If the mean of the corners is positive, the segment cuts off the negative corner after `start`,
            // otherwise the positive corner before it.
            _ if joined => (start + 1) % 4,
            _ => (start + 3) % 4,
        };
        starts
            .iter()
            .map(|&start| (sides[start], sides[end_of(start)]))
            .collect()
    }

    fn contour(&self, sides: &[Side]) -> Contour {
        let crossings: Vec<_> = sides.iter().map(|&side| self.crossing(side)).collect();
        let next = crossings.iter().cycle().skip(1);
        let on_frame = crossings
            .iter()
            .zip(next)
            .map(|((_, frame), (_, next))| *frame && *next)
            .collect();
        Contour {
            points: crossings.into_iter().map(|(point, _)| point).collect(),
            on_frame,
        }
    }

    /// The zero of the function on a side, by linear interpolation; true if one end of the side is an outermost node.
    fn crossing(&self, side: Side) -> ([f64; 2], bool) {
        let ((column, row), (i, j)) = match side {
            Side::Horizontal(column, row) => ((column, row), (1, 0)),
            Side::Vertical(column, row) => ((column, row), (0, 1)),
        };
        let outer = |column: usize, row: usize| {
            [column, row]
                .into_iter()
                .any(|index| index == 0 || index == self.cells + 2)
        };
        let (first, second) = (self.value(column, row), self.value(column + i, row + j));
        let fraction = match (outer(column, row), outer(column + i, row + j)) {
            (true, _) => 1.0,
            (_, true) => 0.0,
            _ => first / (first - second),
        };
        let coordinate = |index: usize, step: usize| {
            (index as f64 + step as f64 * fraction - 1.0) / self.cells as f64
        };
        let frame = outer(column, row) || outer(column + i, row + j);
        (
            self.window.at(coordinate(column, i), coordinate(row, j)),
            frame,
        )
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    const SQUARE: Window = Window {
        x: [-1.0, 1.0],
        y: [-1.0, 1.0],
    };

    #[test]
    fn a_disk_is_one_counterclockwise_contour() {
        let contours = contours(SQUARE, 64, |[x, y]| 0.5 - x * x - y * y);
        assert_eq!(contours.len(), 1);
        assert!((contours[0].signed_area() - 0.5 * std::f64::consts::PI).abs() < 3e-3);
        assert!(contours[0].on_frame.iter().all(|frame| !frame));
    }

    #[test]
    fn a_hole_is_clockwise() {
        let mut areas: Vec<f64> = contours(SQUARE, 64, |[x, y]| {
            (0.8 - x * x - y * y) * (x * x + y * y - 0.2)
        })
        .iter()
        .map(Contour::signed_area)
        .collect();
        areas.sort_by(f64::total_cmp);
        assert!(
            areas.len() == 2 && areas[0] < 0.0 && areas[1] > 0.0,
            "{areas:?}"
        );
    }

    #[test]
    fn a_half_plane_closes_along_the_frame() {
        let contours = contours(SQUARE, 8, |[_, y]| y);
        assert_eq!(contours.len(), 1);
        assert!((contours[0].signed_area() - 2.0).abs() < 1e-12);
        assert!(contours[0].on_frame.iter().any(|frame| *frame));
        assert!(contours[0].on_frame.iter().any(|frame| !*frame));
    }

    #[test]
    fn saddles_and_undefined_values_still_close() {
        for function in [
            |[x, y]: [f64; 2]| x * y,
            |[x, y]: [f64; 2]| (x * y).sqrt() - 0.1,
        ] {
            for contour in contours(SQUARE, 17, function) {
                assert!(contour.points.len() >= 3);
                assert_eq!(contour.points.len(), contour.on_frame.len());
            }
        }
    }
}
