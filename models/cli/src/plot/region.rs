//! The declared region behind a path: the boundary of the region, and the part of the plane that a picture shows.

use dalembert_driver::{AnyModel, Point};

use super::contour::{Contour, Window, contours};

/// Grid squares per side for the picture.
pub const FINE: usize = 240;

/// Grid squares per side in the search for the extent of the region.
pub const COARSE: usize = 48;

/// Margin around the visible objects, as a fraction of their size.
const ROOM: f64 = 0.06;

/// Number of times that the window grows, by half of its size on each side, before a region counts as unbounded.
const GROWTHS: usize = 5;

/// The function of a region in the plane of two coordinates; it is positive where motion is allowed.
pub struct Region<'a> {
    model: &'a dyn AnyModel,
    /// The position that gives the values of the other coordinates.
    q: &'a [f64],
    plane: [usize; 2],
}

impl<'a> Region<'a> {
    /// The declared region in its plane of two coordinates, with the other coordinates of `q`; `None` if none is
    /// declared in such a plane.
    pub fn about(model: &'a dyn AnyModel, q: &'a [f64]) -> Option<Self> {
        let view = model.description().view.as_ref()?;
        let plane = view.plane.filter(|_| view.region)?;
        Some(Self { model, q, plane })
    }

    /// The region of a run from its first to its last state; `None` unless it is declared in a plane of two coordinates
    /// and constant during the run.
    pub fn of(
        model: &'a dyn AnyModel,
        first: &'a Point,
        last: (f64, &Point),
        path: Window,
    ) -> Option<Self> {
        let region = Self::about(model, &first.q)?;
        region.stands_still(last, path).then_some(region)
    }

    /// The position in the plane.
    pub fn position(&self) -> [f64; 2] {
        self.plane.map(|coordinate| self.q[coordinate])
    }

    /// The boundary of the region inside a window, on a grid of `cells` squares per side.
    pub fn contours(&self, window: Window, cells: usize) -> Vec<Contour> {
        contours(window, cells, |point| self.value(point))
    }

    /// Like [`Self::contours`], at a time.
    pub fn contours_at(&self, t: f64, window: Window, cells: usize) -> Vec<Contour> {
        contours(window, cells, |point| self.value_at(t, self.q, point))
    }

    /// True if the region depends on time and the coordinates of the plane only. The test compares the values with the
    /// other coordinates of the first and of the last state, at four points and three times.
    pub fn depends_on_time_only(&self, (end, last): (f64, &Point), path: Window) -> bool {
        let times = [0.37 * end, 0.61 * end, end];
        probes(path).into_iter().all(|point| {
            let same = |t: f64| {
                let values = [self.q, &last.q].map(|q| self.value_at(t, q, point));
                values[0] == values[1] || values.iter().all(|value| value.is_nan())
            };
            times.into_iter().all(same)
        })
    }

    /// The visible part of the plane: the path, and the whole region if it is bounded.
    pub fn window(&self, path: Window) -> Window {
        let with_path = |region: Window| {
            let corners = [region, path].map(|window| [window.at(0.0, 0.0), window.at(1.0, 1.0)]);
            Window::around(corners.into_iter().flatten()).unwrap_or(path)
        };
        let mut window = path.grown(0.5);
        for _ in 0..GROWTHS {
            if let Some(rough) = self.extent(window, COARSE) {
                // A finer grid near the region refines its extent.
                let near = with_path(rough).grown(ROOM);
                return with_path(self.extent(near, COARSE).unwrap_or(rough)).grown(ROOM);
            }
            window = window.grown(0.5);
        }
        path.grown(ROOM)
    }

    /// The bounding rectangle of the region, to the resolution of a grid in a window; `None` if the region reaches the
    /// edge of the window or lies outside.
    pub fn extent(&self, window: Window, cells: usize) -> Option<Window> {
        let contours = self.contours(window, cells);
        let inside = contours
            .iter()
            .all(|contour| contour.on_frame.iter().all(|on_frame| !on_frame));
        let points = contours.into_iter().flat_map(|contour| contour.points);
        Window::around(points).filter(|_| inside)
    }

    fn value(&self, point: [f64; 2]) -> f64 {
        self.value_at(0.0, self.q, point)
    }

    fn value_at(&self, t: f64, q: &[f64], point: [f64; 2]) -> f64 {
        let mut q = q.to_vec();
        for (&coordinate, value) in self.plane.iter().zip(point) {
            q[coordinate] = value;
        }
        self.model.region(t, &q).unwrap_or(f64::NAN)
    }

    /// True if the region depends on the coordinates of the plane only. At each of four points, the test compares the
    /// value at the first state with three others: at the end with the last state, at an intermediate time with the
    /// first state, and at another with the last state.
    fn stands_still(&self, (end, last): (f64, &Point), path: Window) -> bool {
        let same = |t: f64, q: &[f64], point: [f64; 2]| {
            let (now, then) = (self.value(point), self.value_at(t, q, point));
            now == then || (now.is_nan() && then.is_nan())
        };
        let first = self.q;
        probes(path).into_iter().all(|point| {
            same(end, &last.q, point)
                && same(0.37 * end, first, point)
                && same(0.61 * end, &last.q, point)
        })
    }
}

/// Points near a path at which values of a region are compared.
fn probes(path: Window) -> [[f64; 2]; 4] {
    [(0.1, 0.3), (0.5, 0.5), (0.8, 0.6), (0.3, 0.9)].map(|(x, y)| path.grown(0.2).at(x, y))
}
