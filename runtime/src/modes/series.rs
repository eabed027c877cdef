//! Power series of a model with modes, from those of its modes.
//!
//! Motions in neighbouring lanes may be in different modes. Each mode that occurs expands the lanes in it. The other
//! lanes repeat the numbers of one of these lanes, and their results are discarded.

use crate::error::Fault;
use crate::jet::LENGTH;
use crate::kernels::Mode;
use crate::numbers::{Numbers, Row};

/// Lengths of the rows of a model with modes.
#[derive(Debug, Clone, Copy)]
pub struct Lengths {
    /// Number of components of a state, including the number of the mode.
    pub state: usize,
    /// Number of gaps, or 0 if they have no series.
    pub gaps: usize,
}

/// A requested expansion of a model with modes.
#[derive(Debug, Clone, Copy)]
pub struct Expansion<'a, L> {
    /// Lengths of rows.
    pub lengths: Lengths,
    /// The parameters.
    pub parameters: &'a [L],
    /// The unit of time.
    pub unit: L,
    /// The highest order.
    pub order: usize,
    /// Quantities at order 0: rates, gaps, then the other values of the mode.
    pub firsts: &'a [L],
}

/// The lanes that are in a mode.
#[derive(Clone, Copy)]
struct Lanes {
    mode: usize,
    /// The first of these lanes.
    first: usize,
    /// True if all lanes are in the mode.
    all: bool,
}

impl Lanes {
    /// The lanes in the mode; `None` if there are none. `number` holds the number of the mode of each lane.
    #[inline(always)]
    fn of<L: Numbers>(mode: usize, number: &L) -> Option<Self> {
        let first = (0..L::LANES).find(|&lane| is_in(mode, number, lane))?;
        let all = (0..L::LANES).all(|lane| is_in(mode, number, lane));
        Some(Self { mode, first, all })
    }

    /// The numbers of the lanes in the mode. The other lanes repeat the first of them.
    #[inline(always)]
    fn picked<L: Numbers>(&self, value: L, number: &L) -> L {
        match self.all {
            true => value,
            false => L::gathered(|lane| match is_in(self.mode, number, lane) {
                true => value.lane(lane),
                false => value.lane(self.first),
            }),
        }
    }

    /// `new` in the lanes of the mode, `old` in the others.
    #[inline(always)]
    fn merged<L: Numbers>(&self, old: L, new: L, number: &L) -> L {
        match self.all {
            true => new,
            false => L::gathered(|lane| match is_in(self.mode, number, lane) {
                true => new.lane(lane),
                false => old.lane(lane),
            }),
        }
    }
}

/// True if a lane is in a mode; `number` holds the numbers of the modes.
#[inline(always)]
fn is_in<L: Numbers>(mode: usize, number: &L, lane: usize) -> bool {
    // NOTE: the conversion to an integer saturates.
    (number.lane(lane) + 0.5) as usize == mode
}

/// Calls [`TaylorField::begin`](crate::TaylorField::begin) for the lanes in this mode. `expand` computes the quantities
/// at order 0 of the mode's series. Their number is `known`.
///
/// # Errors
/// The [`Fault`] of the mode.
#[inline(always)]
pub(crate) fn begin<L: Numbers, P: Row<L>, R: Row<L>, F: Row<L>>(
    ((number, mode), known): ((usize, &Mode), usize),
    lengths: Lengths,
    (parameters, t, state): (&[L], L, &[L]),
    firsts: &mut [L],
    expand: impl FnOnce(&P, L, &R, &mut F) -> Result<(), Fault>,
) -> Result<(), Fault> {
    let modes = state[lengths.state - 1];
    let Some(lanes) = Lanes::of(number, &modes) else {
        return Ok(());
    };
    let dimensions = &mode.tables.dimensions;
    let parameters: P = row(parameters, &lanes, &modes);
    let state: R = row(&state[..dimensions.state], &lanes, &modes);
    let mut own_firsts = F::zeros(known);
    expand(
        &parameters,
        lanes.picked(t, &modes),
        &state,
        &mut own_firsts,
    )
    .map_err(|fault| fault.of_mode(mode))?;
    let (rates, rest) = own_firsts.as_slice()[..known].split_at(dimensions.state);
    let (gaps, rest) = rest.split_at(own_gaps(mode, lengths));
    let mut put = |place: usize, value: L| {
        firsts[place] = lanes.merged(firsts[place], value, &modes);
    };
    for (place, rate) in rates.iter().enumerate() {
        put(place, *rate);
    }
    for place in rates.len()..lengths.state {
        put(place, L::ZERO);
    }
    for gap in 0..lengths.gaps {
        put(lengths.state + gap, L::of(1.0));
    }
    for (gap, &place) in gaps.iter().zip(&mode.surfaces) {
        put(lengths.state + place, *gap);
    }
    for (place, value) in rest.iter().enumerate() {
        put(lengths.state + lengths.gaps + place, *value);
    }
    Ok(())
}

/// Number of gaps of a mode that have series.
fn own_gaps(mode: &Mode, lengths: Lengths) -> usize {
    match lengths.gaps {
        0 => 0,
        _ => mode.surfaces.len(),
    }
}

/// Calls [`TaylorField::advance`](crate::TaylorField::advance) for the lanes in this mode. `expand` writes the series.
#[inline(always)]
pub(crate) fn advance<
    L: Numbers,
    P: Row<L>,
    F: Row<L>,
    R: Row<L>,
    G: Row<L>,
    OwnR: Row<L>,
    OwnG: Row<L>,
>(
    ((number, mode), known): ((usize, &Mode), usize),
    Expansion {
        lengths,
        parameters,
        unit,
        order,
        firsts,
    }: Expansion<'_, L>,
    (coefficients, gaps): (&mut [R; LENGTH], &mut [G; LENGTH]),
    expand: impl FnOnce(&P, L, &F, &mut [OwnR; LENGTH], &mut [OwnG; LENGTH]),
) {
    let modes = coefficients[0].as_slice()[lengths.state - 1];
    let Some(lanes) = Lanes::of(number, &modes) else {
        return;
    };
    let parameters: P = row(parameters, &lanes, &modes);
    let (d, g) = (mode.tables.dimensions.state, own_gaps(mode, lengths));
    let mut own_firsts = F::zeros(known);
    for (place, value) in own_firsts.as_mut_slice()[..known].iter_mut().enumerate() {
        let from = match place {
            place if place < d => place,
            place if place < d + g => lengths.state + mode.surfaces[place - d],
            place => lengths.state + lengths.gaps + place - d - g,
        };
        *value = lanes.picked(firsts[from], &modes);
    }
    let mut expanded = [OwnR::zeros(d); LENGTH];
    expanded[0] = row(&coefficients[0].as_slice()[..d], &lanes, &modes);
    let mut of_gaps = [OwnG::zeros(g); LENGTH];
    let unit = lanes.picked(unit, &modes);
    expand(&parameters, unit, &own_firsts, &mut expanded, &mut of_gaps);
    let last = order.min(LENGTH - 1);
    for (all, coefficient) in coefficients[1..=last].iter_mut().zip(&expanded[1..]) {
        for (place, value) in all.as_mut_slice().iter_mut().enumerate() {
            let new = coefficient
                .as_slice()
                .get(place)
                .copied()
                .unwrap_or(L::ZERO);
            *value = lanes.merged(*value, new, &modes);
        }
    }
    for (k, (all, gap)) in gaps[..=last].iter_mut().zip(&of_gaps).enumerate() {
        for value in all.as_mut_slice() {
            let constant = if k == 0 { L::of(1.0) } else { L::ZERO };
            *value = lanes.merged(*value, constant, &modes);
        }
        for (new, &place) in gap.as_slice()[..g].iter().zip(&mode.surfaces) {
            let value = &mut all.as_mut_slice()[place];
            *value = lanes.merged(*value, *new, &modes);
        }
    }
}

/// Copies values into a row of a mode. The lanes outside the mode repeat its first lane.
#[inline(always)]
fn row<L: Numbers, R: Row<L>>(values: &[L], lanes: &Lanes, modes: &L) -> R {
    let mut row = R::zeros(values.len());
    for (entry, value) in row.as_mut_slice().iter_mut().zip(values) {
        *entry = lanes.picked(*value, modes);
    }
    row
}
