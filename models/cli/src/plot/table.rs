//! The region of a model's view as a background for other objects than the path of a run.

use dalembert_driver::AnyModel;

use super::contour::{Contour, Window};
use super::plane::Plane;
use super::region::{COARSE, FINE, Region};
use crate::symbols;

/// Half the side of the first square in which the boundary of the region is searched for, and number of squares that
/// are tried. Each has twice the side of the one before.
const LEAST: f64 = 1e-6;
const DOUBLINGS: i32 = 60;

/// Margin around the region, as a fraction of its size.
const ROOM: f64 = 0.06;

/// The region of a view, as a background.
pub struct Table<'a> {
    /// The model of the view.
    pub model: &'a dyn AnyModel,
    /// A position inside the region.
    pub q: &'a [f64],
}

impl Table<'_> {
    /// The names of the view's axes.
    pub fn labels(&self) -> [String; 2] {
        let view = &self.model.description().view;
        view.as_ref().map_or_else(Default::default, |view| {
            view.labels.each_ref().map(|label| symbols::text(label))
        })
    }

    /// The bounding rectangle of the region.
    ///
    /// # Errors
    /// A model without a bounded region.
    pub fn extent(&self) -> Result<Window, String> {
        let region = self.region()?;
        let [x, y] = region.position();
        let square = |half: f64| Window {
            x: [x - half, x + half],
            y: [y - half, y + half],
        };
        (0..DOUBLINGS)
            .find_map(|power| region.extent(square(LEAST * 2f64.powi(power)), COARSE))
            .and_then(|near| region.extent(near.grown(ROOM), FINE))
            .ok_or_else(|| "the region of the view is not bounded".to_owned())
    }

    /// The plane of the region, in a picture of this width, and the region's boundary.
    ///
    /// # Errors
    /// A model without a bounded region.
    pub fn plane(&self, width: f64) -> Result<(Plane, Vec<Contour>), String> {
        let plane = Plane::equal_scales(self.extent()?.grown(ROOM), width);
        let rim = self.region()?.contours(plane.window, FINE);
        Ok((plane, rim))
    }

    fn region(&self) -> Result<Region<'_>, String> {
        Region::about(self.model, self.q).ok_or_else(|| {
            "the model's view has no region in a plane of two coordinates".to_owned()
        })
    }
}
