//! `Instance` for every declared model.

use super::part::has_modes;
use super::system::log_density;
use super::{Declared, Documentation, Form, Kernels, Part, Quantity, Shape};
use crate::contract::System;
use crate::describe::{Description, Initial, Instance, Report, VariationalVisitor};
use crate::effects::Scene;
use crate::error::Fault;
use crate::generated::inspect_globally;
use crate::numbers::Row;
use crate::state::StateVector;

/// A declared form with its documentation. [`Instance`] is implemented for every such form.
pub trait Documented: Declared {
    /// Storage for all quantities of the geometry.
    type Geometry: Row<f64>;

    /// See [`Instance::Global`].
    type Global: Instance<Vector = Self::Vector, Global = Self::Global> + Scene;

    /// The documentation of the form.
    fn documentation(&self) -> &Documentation;

    /// True if the system has its global form.
    const HAS_GLOBAL: bool = true;

    /// Implementation of [`Instance::global`].
    fn globally(&self) -> Option<Self::Global>;

    /// Implementation of [`Instance::set_parameter`].
    fn set_argument(&mut self, index: usize, value: f64);

    /// Implementation of [`Instance::set_mode`].
    fn set_start(&mut self, mode: usize) {
        let _ = mode;
    }

    /// Implementation of [`Instance::inspect`] for a model with modes: the report of a mode by itself.
    fn inspect_mode(
        &self,
        mode: usize,
        t: f64,
        state: &[f64],
        report: &mut dyn Report,
    ) -> Result<(), Fault> {
        let _ = (mode, t, state, report);
        Ok(())
    }

    /// Implementation of [`Instance::visit_variational`].
    fn show_variational<Visitor: VariationalVisitor>(
        &self,
        visitor: Visitor,
    ) -> Option<Visitor::Output> {
        let _ = visitor;
        None
    }
}

impl<S: Documented> Instance for S {
    type Global = S::Global;

    fn description(&self) -> &Description {
        &self.documentation().description
    }

    fn inputs(&self) -> &[&'static str] {
        &self.documentation().inputs
    }

    fn visit_variational<Visitor: VariationalVisitor>(
        &self,
        visitor: Visitor,
    ) -> Option<Visitor::Output> {
        self.show_variational(visitor)
    }

    #[inline]
    fn global(&self) -> Option<S::Global> {
        self.globally()
    }

    fn parameter(&self, index: usize) -> f64 {
        let values = self.arguments();
        values.as_ref().get(index).copied().unwrap_or(f64::NAN)
    }

    fn set_parameter(&mut self, index: usize, value: f64) {
        self.set_argument(index, value);
    }

    fn set_mode(&mut self, mode: usize) {
        self.set_start(mode);
    }

    fn initial(&self) -> Initial<S::Vector> {
        let part = Part::start(self);
        let declared = part.pair(S::Kernels::initial, 0.0, [&[], &[]]);
        let [q, qdot] = declared.unwrap_or([self.zero_vector(); 2]);
        let documentation = part
            .mode()
            .map_or(self.documentation(), |mode| &mode.documentation);
        let [placed, named] = [&documentation.placed, &documentation.named].map(|declared| {
            let mut marks = self.zero_vector();
            for (mark, &is_declared) in marks.as_mut_slice().iter_mut().zip(declared) {
                *mark = f64::from(u8::from(is_declared));
            }
            part.spread(marks)
        });
        Initial {
            q,
            qdot,
            placed,
            named,
            until: part.number_by(S::Kernels::until, 0.0, [&[], &[]]).ok(),
        }
    }

    fn outputs(&self, t: f64, state: &S::State, values: &mut [f64]) -> Result<(), Fault> {
        if values.is_empty() {
            return Ok(());
        }
        let part = Part::of(self, state.as_slice());
        let places = [state.as_slice(), &[]];
        let Some(mode) = part.mode() else {
            return part.write(S::Kernels::outputs, t, places, values);
        };
        values.fill(f64::NAN);
        let count = mode.outputs.len();
        if count == 0 {
            return Ok(());
        }
        let computed = part.several((S::Kernels::outputs, count), t, places)?;
        for (&place, output) in mode.outputs.iter().zip(computed.as_slice()) {
            if let Some(value) = values.get_mut(place) {
                *value = *output;
            }
        }
        Ok(())
    }

    fn view_path(&self, t: f64, state: &S::State) -> Option<[f64; 2]> {
        let mut point = [0.0; 2];
        let part = Part::of(self, state.as_slice());
        let places = [state.as_slice(), &[]];
        part.write(S::Kernels::view_path, t, places, &mut point)
            .ok()?;
        Some(point)
    }

    fn view_region(&self, t: f64, q: &S::Vector) -> Option<f64> {
        let part = Part::start(self);
        let q = part.gathered(q);
        part.number_by(S::Kernels::view_region, t, [q.as_slice(), &[]])
            .ok()
    }

    fn inspect(&self, t: f64, state: &S::State, report: &mut dyn Report) -> Result<(), Fault> {
        if has_modes(self) {
            return self.inspect_mode(self.mode(state), t, state.as_slice(), report);
        }
        if self.tables().form == Form::Reduced {
            inspect_globally(self, t, state, report)?;
            return self.inspect_frame(t, state, report);
        }
        let (q, p) = state.as_slice().split_at(self.coordinate_count());
        report.vector("q", q);
        if self.tables().form == Form::Global {
            report.vector("p", p);
        }
        report_geometry(self, t, state, report)?;
        if self.tables().density_reference.is_some() {
            let density = log_density(self, t, &self.position(state))?;
            report.scalar("log_density", density);
        }
        Ok(())
    }

    fn inspect_frame(
        &self,
        t: f64,
        state: &S::State,
        report: &mut dyn Report,
    ) -> Result<(), Fault> {
        match self.tables().form {
            Form::Reduced if !has_modes(self) => report_geometry(self, t, state, report),
            _ => Ok(()),
        }
    }
}

/// Reports every quantity of [`Kernel::Geometry`](super::Kernel::Geometry).
fn report_geometry<S: Documented>(
    system: &S,
    t: f64,
    state: &S::State,
    report: &mut dyn Report,
) -> Result<(), Fault> {
    let geometry = &system.documentation().geometry;
    let mut values =
        S::Geometry::zeros(geometry.iter().map(|quantity| quantity.shape.count()).sum());
    let places = [state.as_slice(), &[]];
    Part::start(system).write(S::Kernels::geometry, t, places, values.as_mut_slice())?;
    let mut rest = values.as_slice();
    for Quantity { name, shape } in geometry {
        let (entries, others) = rest.split_at(shape.count());
        rest = others;
        match *shape {
            Shape::Scalar => report.scalar(name, entries[0]),
            Shape::Vector(_) => report.vector(name, entries),
            Shape::Matrix(rows, columns) => report.matrix(name, rows, columns, entries),
        }
    }
    Ok(())
}
