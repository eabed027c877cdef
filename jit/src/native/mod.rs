//! Machine code of functions and of power series over doubles.
//!
//! ```text
//! Code   --function--> Straight --registers--> Allocated --assembly--> executable memory
//! Series --series----> (the same for the code before the loop and in it, with the sums of layout)
//! ```
//!
//! The assembly depends on the processor: `x64.rs` is for x86-64 with AVX, `aarch64.rs` for aarch64. It defines the
//! length of a vector and the calling convention. `helpers.rs` has the functions that machine code calls. Memory is
//! first written, then made executable, never both at once. It is freed with the last function.
//!
//! The compiler cannot check two things in this file and `helpers.rs`: pointers to functions that the assembly wrote,
//! and their calls with pointers to slices. The lengths of these slices are compared with the extents that the code
//! reads and writes. The code of a function reads and writes at constant distances from the pointers. The code of a
//! series goes over rows up to the given order; there is room for all of them. Both call only functions of
//! `helpers.rs`.
//!
//! The code performs the operations of the interpreter of `machine.rs` in the same order, with no other contractions,
//! so results are equal to the bit. If a guard fails, the interpreter evaluates the function again and reports which.
#![allow(unsafe_code)]

#[cfg(test)]
mod agreement;
#[cfg_attr(target_arch = "x86_64", path = "x64.rs")]
#[cfg_attr(target_arch = "aarch64", path = "aarch64.rs")]
mod assembly;
mod function;
mod helpers;
mod layout;
#[cfg(test)]
mod random;
mod registers;
mod series;
mod straight;

use std::cell::RefCell;
use std::sync::Arc;

use dalembert::Fault;
use dalembert::erased::Expanded;
use dalembert::kernels::At;
use dalembert::numbers::LENGTH;

use dynasmrt::ExecutableBuffer;

use crate::machine::{Code, Instruction, Place};
use crate::series::{First, Series};
use assembly::{Assembly, convention};
use layout::Layout;
use series::Expansion;

/// True if products and sums are rounded once, like `math::mul_add` with the same features. On aarch64 they are rounded
/// twice.
const IS_FUSED: bool = cfg!(all(target_feature = "fma", not(feature = "strict")));

/// A function of parameters, time, first and second argument, values. It returns 0 if every guard holds.
type Entry = convention!(unsafe fn(*const f64, f64, *const f64, *const f64, *mut f64) -> i32);

/// A function as machine code.
#[derive(Debug)]
pub(crate) struct Native {
    entry: Entry,
    code: Arc<Code>,
    extent: Extent,
    /// Keeps the memory of the code alive.
    _memory: Arc<ExecutableBuffer>,
}

/// Count of the numbers that a function reads from the beginning of each argument.
#[derive(Debug, Clone, Copy, Default)]
struct Extent {
    parameters: usize,
    first: usize,
    second: usize,
}

impl Native {
    /// Writes the values of the outputs.
    ///
    /// # Errors
    /// The fault of the first guard that does not hold.
    ///
    /// # Panics
    /// If a slice is shorter than its extent.
    pub(crate) fn run(&self, at: At<'_, f64>, values: &mut [f64]) -> Result<(), Fault> {
        match self.holds(at, values) {
            true => Ok(()),
            false => self.code.run(at, values),
        }
    }

    /// Writes the values if every guard holds. False if one fails.
    fn holds(&self, at: At<'_, f64>, values: &mut [f64]) -> bool {
        let has_room = at.parameters.len() >= self.extent.parameters
            && at.first.len() >= self.extent.first
            && at.second.len() >= self.extent.second
            && values.len() >= self.code.outputs.len();
        assert!(has_room, "a kernel was given too few numbers");
        // SAFETY: the code reads the first `extent` numbers of each argument, and writes as many values as there are
        // outputs. All of them exist. `self` keeps the memory of the code alive.
        let status = unsafe {
            (self.entry)(
                at.parameters.as_ptr(),
                at.t,
                at.first.as_ptr(),
                at.second.as_ptr(),
                values.as_mut_ptr(),
            )
        };
        status == 0
    }
}

impl Extent {
    fn of(code: &Code) -> Self {
        let mut extent = Self::default();
        for (instruction, _) in &code.instructions {
            if let Instruction::Input(place) = instruction {
                let (most, index) = match *place {
                    Place::Time | Place::Velocity(_) => continue,
                    Place::Parameter(k) => (&mut extent.parameters, k),
                    Place::First(i) => (&mut extent.first, i),
                    Place::Second(i) => (&mut extent.second, i),
                };
                *most = (*most).max(index + 1);
            }
        }
        match &code.velocity {
            Some((velocity, _)) => extent.most(Self::of(velocity)),
            None => extent,
        }
    }

    fn most(self, other: Self) -> Self {
        Self {
            parameters: self.parameters.max(other.parameters),
            first: self.first.max(other.first),
            second: self.second.max(other.second),
        }
    }
}

/// A function of parameters, values at order 0, unit of time, order, coefficients from order 1 on, and room for kept
/// coefficients.
type Advance = convention!(unsafe fn(*const f64, *const f64, f64, i64, *mut f64, *mut f64));

/// A power series as machine code.
#[derive(Debug)]
pub(crate) struct NativeSeries {
    begin: Native,
    advance: Advance,
    parameters: usize,
    known: usize,
    components: usize,
    gaps: usize,
    room: usize,
}

thread_local! {
    /// Room for the coefficients of an expansion.
    static ROOM: RefCell<Vec<f64>> = const { RefCell::new(Vec::new()) };
}

impl NativeSeries {
    /// Same as [`Series::begin`].
    ///
    /// # Errors
    /// The fault of the first guard that does not hold.
    pub(crate) fn begin(
        &self,
        parameters: &[f64],
        t: f64,
        state: &[f64],
        firsts: &mut [f64],
    ) -> Result<(), Fault> {
        let at = At {
            parameters,
            t,
            first: state,
            second: &[],
        };
        self.begin.run(at, firsts)
    }

    /// Same as [`Series::advance`].
    ///
    /// # Panics
    /// If a slice is shorter than its extent.
    pub(crate) fn advance(
        &self,
        [parameters, state, firsts]: [&[f64]; 3],
        (unit, order): (f64, usize),
        take: Expanded<'_, f64>,
    ) {
        let order = order.min(LENGTH - 1);
        let has_all = parameters.len() >= self.parameters && firsts.len() >= self.known;
        assert!(has_all, "a series was given too few numbers");
        take(
            0,
            state,
            &firsts[self.components..self.components + self.gaps],
        );
        if order == 0 {
            return;
        }
        ROOM.with_borrow_mut(|room| {
            let width = self.components + self.gaps;
            // NOTE: the code also writes the order after the last.
            let length = (LENGTH + 1) * width;
            room.resize(length + self.room, 0.0);
            let (coefficients, kept) = room.split_at_mut(length);
            // SAFETY: the code reads the first `parameters` and `known` numbers, writes coefficients in rows from order
            // 1 to `order + 1`, and accesses rows of the room up to `order`, out of `LENGTH`. `begin` keeps its memory
            // alive.
            unsafe {
                (self.advance)(
                    parameters.as_ptr(),
                    firsts.as_ptr(),
                    unit,
                    order as i64,
                    coefficients[width..].as_mut_ptr(),
                    kept.as_mut_ptr(),
                );
            }
            for (k, row) in coefficients
                .chunks(width)
                .enumerate()
                .take(order + 1)
                .skip(1)
            {
                let (coefficients, gaps) = row.split_at(self.components);
                take(k, coefficients, gaps);
            }
        });
    }
}

/// Machine code of a form.
pub(crate) struct Compiled {
    /// Code of its functions, in their order.
    pub functions: Vec<Native>,
    /// Code of its series.
    pub series: NativeSeries,
}

/// Machine code of functions and of a series; `None` on a processor without machine code.
pub(crate) fn compile(codes: &[Arc<Code>], series: &Series) -> Option<Compiled> {
    let mut assembly = Assembly::new()?;
    let mut functions = Vec::new();
    for code in codes.iter().chain([&series.begin]) {
        let allocated = registers::allocate(&function::straight(code));
        functions.push((Arc::clone(code), assembly.function(&allocated)));
    }
    let layout = Layout::of(series);
    let advance = assembly.series(&Expansion::of(series, &layout));
    let memory = Arc::new(assembly.finish()?);
    let functions = functions.into_iter().map(|(code, entry)| Native {
        // SAFETY: a function with this signature was written there.
        entry: unsafe { core::mem::transmute::<*const u8, Entry>(memory.ptr(entry)) },
        extent: Extent::of(&code),
        code,
        _memory: Arc::clone(&memory),
    });
    let mut functions: Vec<Native> = functions.collect();
    let begin = functions.pop()?;
    Some(Compiled {
        functions,
        series: NativeSeries {
            begin,
            // SAFETY: a function with this signature was written there.
            advance: unsafe { core::mem::transmute::<*const u8, Advance>(memory.ptr(advance)) },
            parameters: parameters(series),
            known: series.known(),
            components: series.components,
            gaps: series.outputs.len() - series.components,
            room: layout.room,
        },
    })
}

/// Number of parameters that a series reads.
fn parameters(series: &Series) -> usize {
    let read = series.firsts.iter().map(|first| match first {
        First::Parameter(k) => k + 1,
        _ => 0,
    });
    read.max().unwrap_or(0)
}
