//! [`Variational`] for every declared model whose runs can be differentiated.

use super::impacting::{counts, counts_throughout, no_impulse};
use super::part::has_modes;
use super::passage::Quadratic;
use super::{At, Declared, Form, HasVariations, Kernels, Part};
use super::{Passage, Transition};
use crate::contract::{TaylorField, Variational};
use crate::error::Fault;
use crate::law::Law;
use crate::numbers::{Interval, Numbers, Row};

/// Parameters and a time.
type Arguments<'a, L> = (&'a [L], L);

/// A state in one kind of number.
type RowOf<S, L> = <S as TaylorField>::Row<L>;

/// The kernels of a part over any kind of number.
impl<S: Declared> Part<'_, S> {
    fn write_over<L: Numbers>(
        &self,
        kernel: impl Fn(&S::Kernels, At<'_, L>, &mut [L]) -> Result<(), Fault>,
        (parameters, t): Arguments<'_, L>,
        [first, second]: [&[L]; 2],
        values: &mut [L],
    ) -> Result<(), Fault> {
        let at = At {
            parameters,
            t,
            first,
            second,
        };
        kernel(&self.kernels, at, values).map_err(|fault| self.fault(fault))
    }

    /// A row of `length` numbers that begins with the `count` values of a kernel.
    fn row<L: Numbers, R: Row<L>>(
        &self,
        (kernel, [length, count]): (
            impl Fn(&S::Kernels, At<'_, L>, &mut [L]) -> Result<(), Fault>,
            [usize; 2],
        ),
        arguments: Arguments<'_, L>,
        places: [&[L]; 2],
    ) -> Result<R, Fault> {
        let mut values = R::zeros(length);
        let entries = &mut values.as_mut_slice()[..count];
        self.write_over(kernel, arguments, places, entries)?;
        Ok(values)
    }

    /// One value of a kernel per coordinate of the part.
    fn row_of_coordinates<L: Numbers>(
        &self,
        kernel: impl Fn(&S::Kernels, At<'_, L>, &mut [L]) -> Result<(), Fault>,
        arguments: Arguments<'_, L>,
        places: [&[L]; 2],
    ) -> Result<S::Positions<L>, Fault> {
        let counts = [self.system_dimensions().coordinates, self.lengths()[0]];
        self.row((kernel, counts), arguments, places)
    }

    /// A state of the part: the positions, then the momenta or quasi-velocities that a kernel gives for positions and
    /// velocities.
    fn row_by<L: Numbers, R: Row<L>>(
        &self,
        kernel: impl Fn(&S::Kernels, At<'_, L>, &mut [L]) -> Result<(), Fault>,
        arguments: Arguments<'_, L>,
        [q, qdot]: [&[L]; 2],
    ) -> Result<R, Fault> {
        let [n, k] = self.lengths();
        let mut state = R::zeros(self.system_dimensions().state);
        let (positions, motion) = state.as_mut_slice().split_at_mut(n);
        positions.copy_from_slice(&q[..n]);
        if self.tables.form != Form::FirstOrder {
            self.write_over(kernel, arguments, [q, qdot], &mut motion[..k])?;
        }
        self.sign(state.as_mut_slice());
        Ok(state)
    }

    /// Implementation of [`System::state_nearest`](crate::System::state_nearest) over any kind of number.
    fn nearest<L: Numbers, R: Row<L>>(
        &self,
        arguments: Arguments<'_, L>,
        places: [&[L]; 2],
    ) -> Result<R, Fault> {
        let is_free = self.tables.form == Form::Global && self.tables.dimensions.constraints == 0;
        match is_free {
            true => self.row_by(S::Kernels::motion, arguments, places),
            false => self.row_by(S::Kernels::nearest, arguments, places),
        }
    }

    /// The state after adding the values of a kernel to its momenta or quasi-velocities; `None` if the part does not
    /// have the kernel.
    fn added<L: Numbers, R: Row<L>>(
        &self,
        kernel: impl Fn(&S::Kernels, At<'_, L>, &mut [L]) -> Result<(), Fault>,
        arguments: Arguments<'_, L>,
        places: [&[L]; 2],
        to: &R,
    ) -> Result<Option<R>, Fault> {
        let [n, k] = self.lengths();
        let found: Result<S::Room<L>, Fault> = self.row((kernel, [k; 2]), arguments, places);
        let found = match found {
            Err(Fault::NotDerived) => return Ok(None),
            found => found?,
        };
        let mut sum = *to;
        let motion = sum.as_mut_slice()[n..n + k].iter_mut();
        for (entry, added) in motion.zip(found.as_slice()) {
            *entry = *entry + *added;
        }
        Ok(Some(sum))
    }

    /// The numbers of a contact at a surface of the part, followed by the direction.
    fn collision<L: Numbers, R: Row<L>>(
        &self,
        local: usize,
        arguments: Arguments<'_, L>,
        state: &[L],
    ) -> Result<R, Fault> {
        let kernel = |kernels: &S::Kernels, at: At<'_, L>, values: &mut [L]| {
            kernels.contact(local, at, values)
        };
        let counts = [self.system_dimensions().motion, self.lengths()[1]];
        let counts = counts.map(|motion| 5 + motion);
        let found = self.row((kernel, counts), arguments, [state, &[]]);
        found.map_err(|fault| self.fault(no_impulse(self.tables, fault, local)))
    }

    /// Positions and velocities after the reset of a surface of the part; `None` if its law is not a reset.
    fn landed<L: Numbers>(
        &self,
        local: usize,
        arguments: Arguments<'_, L>,
        state: &[L],
    ) -> Result<Option<[S::Positions<L>; 2]>, Fault> {
        if !matches!(self.tables.surfaces.get(local), Some(declared) if declared.law == Law::Reset)
        {
            return Ok(None);
        }
        let kernel = |kernels: &S::Kernels, at: At<'_, L>, values: &mut [L]| {
            kernels.reset(local, at, values)
        };
        self.both_rows(kernel, arguments, [state, &[]]).map(Some)
    }

    /// Positions and velocities of the part that a kernel gives.
    fn both_rows<L: Numbers>(
        &self,
        kernel: impl Fn(&S::Kernels, At<'_, L>, &mut [L]) -> Result<(), Fault>,
        arguments: Arguments<'_, L>,
        places: [&[L]; 2],
    ) -> Result<[S::Positions<L>; 2], Fault> {
        let n = self.lengths()[0];
        let both: S::Room<L> = self.row((kernel, [2 * n; 2]), arguments, places)?;
        let (q, qdot) = both.as_slice()[..2 * n].split_at(n);
        let length = self.system_dimensions().coordinates;
        Ok([q, qdot].map(|values| {
            let mut row = S::Positions::<L>::zeros(length);
            row.as_mut_slice()[..n].copy_from_slice(values);
            row
        }))
    }

    /// The state after the transition through a surface of the part. `None` if refraction is not available
    /// ([`Self::refracted`]).
    fn passed_into<L: Numbers, R: Row<L>>(
        &self,
        (local, transition): (usize, Transition),
        arguments: Arguments<'_, L>,
        state: &R,
    ) -> Result<Option<R>, Fault> {
        let right = self.other(transition.enters);
        let places = [state.as_slice(), &[][..]];
        let entered = match transition.passage {
            Passage::Declared => {
                let kernel = |kernels: &S::Kernels, at: At<'_, L>, values: &mut [L]| {
                    kernels.entry(local, at, values)
                };
                let n = right.lengths()[0];
                let count = match right.tables.form {
                    Form::FirstOrder => n,
                    _ => 2 * n,
                };
                let both: S::Room<L> = self.row((kernel, [count; 2]), arguments, places)?;
                let (q, qdot) = both.as_slice()[..count].split_at(n);
                right.row_by(S::Kernels::motion, arguments, [q, qdot])?
            }
            Passage::Kept => right.row_by(S::Kernels::motion, arguments, places)?,
            Passage::Focused => {
                let qdot = self.row_of_coordinates(S::Kernels::velocity, arguments, places)?;
                right.nearest(arguments, [places[0], qdot.as_slice()])?
            }
            Passage::Refracted => return self.refracted(&right, local, arguments, state),
        };
        Ok(Some(entered))
    }

    /// Refraction of momenta, or reflection where no refraction exists, by the formulas of `passage.rs`. `None` if the
    /// decision between them is uncertain, or if the state of either mode does not contain momenta.
    fn refracted<L: Numbers, R: Row<L>>(
        &self,
        right: &Part<'_, S>,
        local: usize,
        arguments: Arguments<'_, L>,
        state: &R,
    ) -> Result<Option<R>, Fault> {
        if [self.tables.form, right.tables.form] != [Form::Global; 2] {
            return Ok(None);
        }
        let n = self.lengths()[0];
        let collision: S::Room<L> = self.collision(local, arguments, state.as_slice())?;
        // NOTE: the third number of a contact is the rate of the surface itself; the direction follows the fifth.
        let (surface_rate, direction) = (collision.as_slice()[2], &collision.as_slice()[5..5 + n]);
        let with_momenta = |momenta: &dyn Fn(usize) -> L| {
            let mut row = *state;
            for (i, p) in row.as_mut_slice()[n..2 * n].iter_mut().enumerate() {
                *p = momenta(i);
            }
            right.sign(row.as_mut_slice());
            row
        };
        let through = |momenta: &dyn Fn(usize) -> L| -> Result<L, Fault> {
            let row = with_momenta(momenta);
            let places = [row.as_slice(), &[][..]];
            let velocities = right.row_of_coordinates(S::Kernels::velocity, arguments, places)?;
            let pairs = direction.iter().zip(velocities.as_slice());
            Ok(pairs.fold(L::ZERO, |sum, (d, v)| d.mul_add(*v, sum)))
        };
        let energy = |part: &Part<'_, S>, state: &[L]| -> Result<L, Fault> {
            let mut energy = [L::ZERO];
            part.write_over(S::Kernels::energy, arguments, [state, &[]], &mut energy)?;
            Ok(energy[0])
        };
        let p = |i: usize| state.as_slice()[n + i];
        let kept = with_momenta(&p);
        let quadratic = Quadratic {
            rate: through(&p)? + surface_rate,
            compliance: through(&|i| direction[i])? - through(&|_| L::ZERO)?,
            excess: energy(right, kept.as_slice())? - energy(self, state.as_slice())?,
        };
        let size = match quadratic.root() {
            None => return Ok(None),
            Some(Some(size)) => size,
            Some(None) => {
                let mut reflected = *state;
                let momenta = &mut reflected.as_mut_slice()[n..2 * n];
                Law::Elastic.strike(L::ZERO, collision.as_slice(), momenta);
                return Ok(Some(reflected));
            }
        };
        let beyond = with_momenta(&|i| size.mul_add(direction[i], p(i)));
        if right.tables.dimensions.constraints == 0 {
            return Ok(Some(beyond));
        }
        let places = [beyond.as_slice(), &[][..]];
        let qdot = right.row_of_coordinates(S::Kernels::velocity, arguments, places)?;
        let entered = right.nearest(arguments, [places[0], qdot.as_slice()])?;
        Ok(Some(entered))
    }
}

impl<S: HasVariations> Variational for S {
    type Configuration<L: Numbers> = S::Positions<L>;
    type Clearances<L: Numbers> = <S as HasVariations>::Clearances<L>;
    type Collision<L: Numbers> = <S as HasVariations>::Collision<L>;
    type Deviations<L: Numbers> = <S as HasVariations>::Deviations<L>;
    type Columns = <S as HasVariations>::Columns;
    type Tangents = <S as HasVariations>::Tangents;

    fn columns() -> Self::Columns {
        <S as HasVariations>::columns()
    }

    fn tangents() -> Self::Tangents {
        <S as HasVariations>::tangents()
    }

    #[inline]
    fn counts(&self, surface: usize, t: f64, state: &<S as Declared>::State) -> bool {
        counts(self, surface, t, state)
    }

    fn counts_throughout(
        &self,
        parameters: &<S as TaylorField>::Parameters<Interval>,
        surface: usize,
        t: Interval,
        state: &<S as TaylorField>::Row<Interval>,
    ) -> Option<bool> {
        counts_throughout(self, parameters.as_slice(), surface, t, state.as_slice())
    }

    fn velocities<L: Numbers>(
        &self,
        parameters: &<S as TaylorField>::Parameters<L>,
        t: L,
        state: &RowOf<S, L>,
    ) -> Result<S::Positions<L>, Fault> {
        let part = Part::of(self, state.as_slice());
        let places = [state.as_slice(), &[][..]];
        let arguments = (parameters.as_slice(), t);
        let velocities = part.row_of_coordinates(S::Kernels::velocity, arguments, places)?;
        Ok(part.spread_row(velocities))
    }

    fn composed<L: Numbers>(
        &self,
        parameters: &<S as TaylorField>::Parameters<L>,
        t: L,
        q: &S::Positions<L>,
        qdot: &S::Positions<L>,
    ) -> Result<RowOf<S, L>, Fault> {
        let part = Part::start(self);
        let [q, qdot] = [part.gathered_row(q), part.gathered_row(qdot)];
        let arguments = (parameters.as_slice(), t);
        part.row_by(
            S::Kernels::motion,
            arguments,
            [q.as_slice(), qdot.as_slice()],
        )
    }

    fn relocated<L: Numbers>(
        &self,
        parameters: &<S as TaylorField>::Parameters<L>,
        t: L,
        state: &RowOf<S, L>,
        change: impl FnOnce(&mut [L], &mut [L]),
    ) -> Result<RowOf<S, L>, Fault> {
        let part = Part::of(self, state.as_slice());
        let length = part.system_dimensions().coordinates;
        let (mut q, n) = (S::Positions::<L>::zeros(length), part.lengths()[0]);
        q.as_mut_slice()[..n].copy_from_slice(&state.as_slice()[..n]);
        let mut q = part.spread_row(q);
        let mut qdot = self.velocities(parameters, t, state)?;
        change(q.as_mut_slice(), qdot.as_mut_slice());
        let [q, qdot] = [part.gathered_row(&q), part.gathered_row(&qdot)];
        let places = [q.as_slice(), qdot.as_slice()];
        part.row_by(S::Kernels::motion, (parameters.as_slice(), t), places)
    }

    fn declared_start<L: Numbers>(
        &self,
        parameters: &<S as TaylorField>::Parameters<L>,
    ) -> Result<[S::Positions<L>; 2], Fault> {
        let part = Part::start(self);
        let arguments = (parameters.as_slice(), L::ZERO);
        let both = part.both_rows(S::Kernels::initial, arguments, [&[], &[]])?;
        Ok(both.map(|row| part.spread_row(row)))
    }

    fn residuals_at<L: Numbers>(
        &self,
        parameters: &<S as TaylorField>::Parameters<L>,
        t: L,
        q: &S::Positions<L>,
        qdot: &S::Positions<L>,
    ) -> Result<S::Positions<L>, Fault> {
        let part = Part::start(self);
        let m = part.tables.dimensions.constraints;
        let [q, qdot] = [part.gathered_row(q), part.gathered_row(qdot)];
        let arguments = (parameters.as_slice(), t);
        let kernel = (S::Kernels::residuals, [2 * m; 2]);
        let both: S::Room<L> = part.row(kernel, arguments, [q.as_slice(), qdot.as_slice()])?;
        let mut residuals = q.zeroed();
        residuals.as_mut_slice()[..m].copy_from_slice(&both.as_slice()[..m]);
        Ok(residuals)
    }

    fn deviations<L: Numbers>(
        &self,
        parameters: &<S as TaylorField>::Parameters<L>,
        t: L,
        state: &RowOf<S, L>,
    ) -> Result<<S as HasVariations>::Deviations<L>, Fault> {
        let part = Part::of(self, state.as_slice());
        let arguments = (parameters.as_slice(), t);
        let state = state.as_slice();
        let dimensions = &part.tables.dimensions;
        let off = match part.tables.form {
            Form::Global => dimensions.constraints,
            _ => 0,
        };
        let count = off + dimensions.levels;
        let length = match has_modes(self) {
            true => self.tables().dimensions.state - 1,
            false => count,
        };
        let mut values = <S as HasVariations>::Deviations::<L>::zeros(length);
        if off > 0 {
            let qdot = part.row_of_coordinates(S::Kernels::velocity, arguments, [state, &[]])?;
            let kernel = (S::Kernels::residuals, [2 * off; 2]);
            let both: S::Room<L> = part.row(kernel, arguments, [state, qdot.as_slice()])?;
            values.as_mut_slice()[..off].copy_from_slice(&both.as_slice()[..off]);
        }
        if dimensions.levels > 0 {
            let levels = &mut values.as_mut_slice()[off..count];
            part.write_over(S::Kernels::levels, arguments, [state, &[]], levels)?;
        }
        if has_modes(self) {
            // The components that the mode does not use, and the number of the mode.
            let unused = &state[dimensions.state..];
            let places = values.as_mut_slice()[count..].iter_mut();
            places
                .zip(unused)
                .for_each(|(place, value)| *place = *value);
        }
        Ok(values)
    }

    fn clearances<L: Numbers>(
        &self,
        parameters: &<S as TaylorField>::Parameters<L>,
        t: L,
        state: &RowOf<S, L>,
    ) -> Result<<S as HasVariations>::Clearances<L>, Fault> {
        let part = Part::of(self, state.as_slice());
        let counts = [self.tables(), part.tables].map(|tables| tables.dimensions.surfaces);
        let gaps = match counts[1] {
            0 => <S as HasVariations>::Clearances::<L>::zeros(counts[0]),
            _ => {
                let arguments = (parameters.as_slice(), t);
                let places = [state.as_slice(), &[][..]];
                part.row((S::Kernels::gaps, counts), arguments, places)?
            }
        };
        Ok(part.row_of_surfaces(gaps, L::of(1.0)))
    }

    fn collision<L: Numbers>(
        &self,
        parameters: &<S as TaylorField>::Parameters<L>,
        surface: usize,
        t: L,
        state: &RowOf<S, L>,
    ) -> Result<<S as HasVariations>::Collision<L>, Fault> {
        let part = Part::of(self, state.as_slice());
        let local = part.known(surface)?;
        part.collision(local, (parameters.as_slice(), t), state.as_slice())
    }

    fn focus<L: Numbers>(
        &self,
        parameters: &<S as TaylorField>::Parameters<L>,
        surface: usize,
        t: L,
        state: &RowOf<S, L>,
    ) -> Result<Option<RowOf<S, L>>, Fault> {
        let part = Part::of(self, state.as_slice());
        let local = part.known(surface)?;
        let kernel = |kernels: &S::Kernels, at: At<'_, L>, values: &mut [L]| {
            kernels.focus(local, at, values)
        };
        let places = [state.as_slice(), &[][..]];
        part.added(kernel, (parameters.as_slice(), t), places, state)
    }

    fn trace<L: Numbers>(
        &self,
        parameters: &<S as TaylorField>::Parameters<L>,
        surface: usize,
        t: L,
        state: &RowOf<S, L>,
        rate: &RowOf<S, L>,
    ) -> Result<Option<RowOf<S, L>>, Fault> {
        let part = Part::of(self, state.as_slice());
        let local = part.known(surface)?;
        let kernel = |kernels: &S::Kernels, at: At<'_, L>, values: &mut [L]| {
            kernels.trace(local, at, values)
        };
        let motion = &rate.as_slice()[part.lengths()[0]..];
        let places = [state.as_slice(), motion];
        part.added(kernel, (parameters.as_slice(), t), places, rate)
    }

    fn landing<L: Numbers>(
        &self,
        parameters: &<S as TaylorField>::Parameters<L>,
        surface: usize,
        t: L,
        state: &RowOf<S, L>,
    ) -> Result<Option<[S::Positions<L>; 2]>, Fault> {
        if has_modes(self) {
            return Ok(None);
        }
        let arguments = (parameters.as_slice(), t);
        Part::start(self).landed(surface, arguments, state.as_slice())
    }

    fn passed<L: Numbers>(
        &self,
        parameters: &<S as TaylorField>::Parameters<L>,
        surface: usize,
        t: L,
        state: &RowOf<S, L>,
    ) -> Result<Option<RowOf<S, L>>, Fault> {
        let part = Part::of(self, state.as_slice());
        let arguments = (parameters.as_slice(), t);
        if let Some(transition) = part.transition(surface) {
            return part.passed_into(transition, arguments, state);
        }
        let local = part.known(surface)?;
        let Some([q, qdot]) = part.landed(local, arguments, state.as_slice())? else {
            return Ok(None);
        };
        let places = [q.as_slice(), qdot.as_slice()];
        part.row_by(S::Kernels::motion, arguments, places).map(Some)
    }

    fn declared_outputs<L: Numbers>(
        &self,
        parameters: &<S as TaylorField>::Parameters<L>,
        t: L,
        state: &RowOf<S, L>,
        values: &mut [L],
    ) -> Result<(), Fault> {
        let part = Part::of(self, state.as_slice());
        let arguments = (parameters.as_slice(), t);
        let places = [state.as_slice(), &[][..]];
        let Some(mode) = part.mode() else {
            return part.write_over(S::Kernels::outputs, arguments, places, values);
        };
        let counts = [mode.outputs.len(); 2];
        let computed: S::Room<L> = part.row((S::Kernels::outputs, counts), arguments, places)?;
        for (&place, output) in mode.outputs.iter().zip(computed.as_slice()) {
            if let Some(value) = values.get_mut(place) {
                *value = *output;
            }
        }
        Ok(())
    }

    fn declared_law<L: Numbers>(
        &self,
        parameters: &<S as TaylorField>::Parameters<L>,
        surface: usize,
    ) -> (Law, L) {
        let (Some(declared), Some((part, local))) = (
            self.tables().surfaces.get(surface),
            Part::of_surface(self, surface),
        ) else {
            return (Law::Elastic, L::ZERO);
        };
        let kernel = |kernels: &S::Kernels, at: At<'_, L>, values: &mut [L]| {
            kernels.coefficient(local, at, values)
        };
        let mut coefficient = [L::ZERO];
        let arguments = (parameters.as_slice(), L::ZERO);
        // The kernel of a coefficient has no guards, so it does not fail.
        let _ = part.write_over(kernel, arguments, [&[], &[]], &mut coefficient);
        let value = coefficient[0].lane(0);
        let law = match declared.law {
            Law::Restitution(_) => Law::Restitution(value),
            Law::Newton(_) => Law::Newton(value),
            law => law,
        };
        (law, coefficient[0])
    }
}
