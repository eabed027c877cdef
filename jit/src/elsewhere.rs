//! Substitute for `native` on processors without machine code. The interpreters of `machine.rs` and `series.rs` run
//! everything.

use core::convert::Infallible;
use std::sync::Arc;

use dalembert::Fault;
use dalembert::erased::Expanded;
use dalembert::kernels::At;

use crate::machine::Code;
use crate::series::Series;

/// A function as machine code. There is no value of this type.
#[derive(Debug)]
pub(crate) struct Native(Infallible);

impl Native {
    pub(crate) fn run(&self, _: At<'_, f64>, _: &mut [f64]) -> Result<(), Fault> {
        match self.0 {}
    }
}

/// A power series as machine code. There is no value of this type.
#[derive(Debug)]
pub(crate) struct NativeSeries(Infallible);

impl NativeSeries {
    pub(crate) fn begin(&self, _: &[f64], _: f64, _: &[f64], _: &mut [f64]) -> Result<(), Fault> {
        match self.0 {}
    }

    pub(crate) fn advance(&self, _: [&[f64]; 3], _: (f64, usize), _: Expanded<'_, f64>) {
        match self.0 {}
    }
}

/// Machine code of a form.
pub(crate) struct Compiled {
    pub functions: Vec<Native>,
    pub series: NativeSeries,
}

pub(crate) fn compile(_: &[Arc<Code>], _: &Series) -> Option<Compiled> {
    None
}
