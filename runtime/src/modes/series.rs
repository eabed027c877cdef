//! Power series of a model with modes, by those of its modes.
//!
//! Motions that run side by side may be in different modes. Each mode that any of them is in expands the lanes that are in
//! it; the other lanes are given the numbers of one that is, and what comes of them is dropped.
//!
//! NOTE: no mode's series is inlined into those of the whole: with many modes one function would hold all of them, and compilers
//! take minutes over it.

use super::Mode;
use crate::error::Fault;
use crate::jet::{LENGTH, Work};
use crate::numbers::{Numbers, Row};

/// Lengths of the rows of a model with modes.
#[derive(Debug, Clone, Copy)]
pub struct Shape {
    /// Components of a state, the number of the mode among them.
    pub state: usize,
    /// Gaps, or 0 where they have no series.
    pub gaps: usize,
}

/// The lanes that are in a mode.
#[derive(Clone, Copy)]
struct Lanes {
    mode: usize,
    /// The first of them.
    first: usize,
    /// Whether all are.
    all: bool,
}

impl Lanes {
    /// `None` if no lane is in the mode.
    #[inline(always)]
    fn of<L: Numbers>(mode: usize, number: &L) -> Option<Self> {
        let first = (0..L::LANES).find(|&lane| is_in(mode, number, lane))?;
        let all = (0..L::LANES).all(|lane| is_in(mode, number, lane));
        Some(Self { mode, first, all })
    }

    /// The numbers of the lanes in the mode; in the others those of the first that is.
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

/// Whether a lane is in a mode; `number` holds the numbers of the modes.
#[inline(always)]
fn is_in<L: Numbers>(mode: usize, number: &L, lane: usize) -> bool {
    // NOTE: the conversion saturates.
    (number.lane(lane) + 0.5) as usize == mode
}

/// As [`TaylorField::begin`](crate::TaylorField::begin), for the lanes that are in this mode.
///
/// What is known comes in the order of the model: rates, then gaps, then whatever the mode takes of it.
///
/// # Errors
/// That of the mode.
#[inline(never)]
pub fn begin<M: Mode, L: Numbers>(
    mode: &M,
    shape: Shape,
    parameters: &[L],
    t: L,
    state: &[L],
    firsts: &mut [L],
) -> Result<(), Fault> {
    let number = state[shape.state - 1];
    let Some(lanes) = Lanes::of(M::INDEX, &number) else {
        return Ok(());
    };
    let parameters = row::<L, M::Parameters<L>>(parameters, &lanes, &number);
    let own = row::<L, M::Row<L>>(state, &lanes, &number);
    let mut known = M::Firsts::<L>::zeros(M::Firsts::<L>::CAPACITY);
    mode.begin(&parameters, lanes.picked(t, &number), &own, &mut known)?;
    let known = known.as_slice();
    let (rates, rest) = known.split_at(M::Row::<L>::CAPACITY);
    let (gaps, rest) = rest.split_at(M::Gaps::<L>::CAPACITY);
    let mut put = |place: usize, value: L| {
        firsts[place] = lanes.merged(firsts[place], value, &number);
    };
    for (place, rate) in rates.iter().enumerate() {
        put(place, *rate);
    }
    for place in rates.len()..shape.state {
        put(place, L::ZERO);
    }
    for gap in 0..shape.gaps {
        put(shape.state + gap, L::of(1.0));
    }
    if shape.gaps > 0 {
        for (gap, &place) in gaps.iter().zip(M::SURFACES) {
            put(shape.state + place, *gap);
        }
    }
    for (place, value) in rest.iter().enumerate() {
        put(shape.state + shape.gaps + place, *value);
    }
    Ok(())
}

/// As [`TaylorField::advance`](crate::TaylorField::advance), for the lanes that are in this mode.
#[inline(never)]
#[allow(
    clippy::too_many_arguments,
    reason = "those of `advance`, and the shape"
)]
pub fn advance<M: Mode, L: Numbers, const D: usize, const G: usize>(
    mode: &M,
    parameters: &[L],
    unit: L,
    order: usize,
    firsts: &[L],
    coefficients: &mut [[L; D]; LENGTH],
    gaps: &mut [[L; G]; LENGTH],
    jets: &mut M::Jets<L>,
) {
    let number = coefficients[0][D - 1];
    let Some(lanes) = Lanes::of(M::INDEX, &number) else {
        return;
    };
    let parameters = row::<L, M::Parameters<L>>(parameters, &lanes, &number);
    let (d, g) = (M::Row::<L>::CAPACITY, M::Gaps::<L>::CAPACITY);
    let mut known = M::Firsts::<L>::zeros(M::Firsts::<L>::CAPACITY);
    for (place, value) in known.as_mut_slice().iter_mut().enumerate() {
        let from = match place {
            place if place < d => place,
            place if place < d + g && G > 0 => D + M::SURFACES[place - d],
            place if place < d + g => continue,
            place => D + G + place - d - g,
        };
        *value = lanes.picked(firsts[from], &number);
    }
    let mut own = [M::Row::<L>::zeros(M::Row::<L>::CAPACITY); LENGTH];
    own[0] = row::<L, M::Row<L>>(&coefficients[0], &lanes, &number);
    let mut own_gaps = [M::Gaps::<L>::zeros(M::Gaps::<L>::CAPACITY); LENGTH];
    let unit = lanes.picked(unit, &number);
    mode.advance(
        &parameters,
        unit,
        order,
        &known,
        &mut own,
        &mut own_gaps,
        jets,
    );
    for k in 1..=order.min(LENGTH - 1) {
        for (place, value) in coefficients[k].iter_mut().enumerate() {
            let new = own[k].as_slice().get(place).copied().unwrap_or(L::ZERO);
            *value = lanes.merged(*value, new, &number);
        }
    }
    for k in 0..=order.min(LENGTH - 1) {
        for value in &mut gaps[k] {
            let constant = if k == 0 { L::of(1.0) } else { L::ZERO };
            *value = lanes.merged(*value, constant, &number);
        }
        if G > 0 {
            for (new, &place) in own_gaps[k].as_slice().iter().zip(M::SURFACES) {
                gaps[k][place] = lanes.merged(gaps[k][place], *new, &number);
            }
        }
    }
}

/// The first numbers of a row, in the lanes of a mode.
#[inline(always)]
fn row<L: Numbers, R: Row<L>>(values: &[L], lanes: &Lanes, number: &L) -> R {
    let mut row = R::zeros(R::CAPACITY);
    for (own, value) in row.as_mut_slice().iter_mut().zip(values) {
        *own = lanes.picked(*value, number);
    }
    row
}

/// What expansions take at most, in whatever mode.
pub const fn work(modes: &[Option<Work>]) -> Option<Work> {
    let mut most = Work {
        values: 0,
        sums: 0,
        degree: Some(0),
    };
    let mut k = 0;
    while k < modes.len() {
        let Some(own) = modes[k] else {
            return None;
        };
        if own.values > most.values {
            most.values = own.values;
        }
        if own.sums > most.sums {
            most.sums = own.sums;
        }
        most.degree = match (most.degree, own.degree) {
            (Some(a), Some(b)) => Some(if a > b { a } else { b }),
            _ => None,
        };
        k += 1;
    }
    Some(most)
}
