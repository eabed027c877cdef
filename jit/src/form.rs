//! Forms: tables, and closures over the executors of programs.
// NOTE: forms made here live as long as the program: a system borrows its form for ever.

use std::any::Any;
use std::collections::BTreeMap;

use dalembert::Fault;
use dalembert::erased::{Expanded, Form, Kinds, SeriesTable};
use dalembert::kernels::{At, KernelTable, OfSurface, Plain};
use dalembert::numbers::{Bent, Interval, Numbers, Rated, TaylorModel};
use dalembert::variations::Dual;
use dalembert_codegen::model::{Model, Scene};
use dalembert_codegen::spec::SURFACES;
use dalembert_codegen::tables::{FormOf, Whole, default_value};
use dalembert_codegen::{self as codegen, CompiledModes};
use dalembert_numbers::Kernel;
use wide::f64x8;

use crate::machine::Code;
use crate::native::{self, Compiled, Native, NativeSeries};
use crate::series::Series;

/// The form of a model, or of a scene.
pub(crate) fn of_model(compiled: &codegen::Compiled, scenes: &[Scene]) -> &'static Form {
    let may_be_narrow = compiled.programs.main.can_be_narrow;
    forms(&FormOf::all(compiled, scenes), may_be_narrow)[0]
}

/// The forms of a model, a scene or a mode: its own, which refers to the global one, then the global one where the two differ.
fn forms(known: &[FormOf<'_>], may_be_narrow: bool) -> Vec<&'static Form> {
    let (first, others) = known.split_first().expect("a model has a form");
    let others: Vec<&'static Form> = others
        .iter()
        .map(|known| form(known, may_be_narrow, None))
        .collect();
    let first = form(first, may_be_narrow, others.first().copied());
    core::iter::once(first).chain(others).collect()
}

/// The form of a model with modes.
pub(crate) fn of_modes(compiled: &CompiledModes) -> &'static Form {
    let scenes = &compiled.graph.modes[0].model.scenes;
    let whole = Whole {
        graph: &compiled.graph,
        forms: compiled
            .modes
            .iter()
            .map(|mode| FormOf::all(mode, scenes))
            .collect(),
    };
    let tables = whole.tables();
    let of_modes: Vec<Vec<&'static Form>> = whole
        .forms
        .iter()
        .map(|known| forms(known, tables.can_be_narrow))
        .collect();
    let gaps = whole.series_gaps();
    let rests = of_modes.iter().map(|forms| {
        let form = forms[0];
        form.firsts - form.tables.dimensions.state - form.series_gaps
    });
    let work = whole.work();
    let defaults = defaults(whole.model());
    leak(Form {
        tables,
        documentation: whole.documentation(),
        kernels: KernelTable::found(|_| None, |_| None),
        kernels_over: Kinds::default(),
        series: SeriesTable::NONE,
        series_over: Kinds::default(),
        work: leak(move || work),
        series_gaps: gaps,
        firsts: tables.dimensions.state + gaps + rests.max().unwrap_or(0),
        defaults: leak(move |values: &mut [f64]| values.copy_from_slice(&defaults)),
        global: &|| None,
        forms: Vec::leak(of_modes.concat()),
        room: whole.room(),
    })
}

/// A form, with rates over intervals if they `may_be_narrow`. A form that can be varied has all that certified motion needs.
fn form(known: &FormOf<'_>, may_be_narrow: bool, global: Option<&'static Form>) -> &'static Form {
    let series: &'static Series = leak(Series::of(
        &known.program.jet,
        (known.dimension(), known.state_dimension()),
    ));
    let functions = Functions::of(known);
    let mut compiled = functions.compiled(series);
    let tables = known.tables();
    let has_surfaces = !tables.surfaces.is_empty();
    let work = Some(known.work());
    let defaults = defaults(known.model);
    leak(Form {
        tables,
        documentation: known.documentation(),
        kernels: match &mut compiled {
            Some(compiled) => functions.native(compiled),
            None => functions.table(),
        },
        kernels_over: [
            (has_surfaces || tables.can_lose_rank).then(|| any(functions.table::<TaylorModel>())),
            has_surfaces.then(|| any(functions.table::<Bent>())),
            (may_be_narrow || tables.varies).then(|| any(functions.table::<Rated>())),
            tables.varies.then(|| any(functions.table::<Dual>())),
            tables.varies.then(|| any(functions.table::<Interval>())),
        ],
        series: match compiled {
            Some(compiled) => native_series(leak(compiled.series)),
            None => series_table(series),
        },
        series_over: [
            tables.varies.then(|| any(series_table::<Dual>(series))),
            Some(any(series_table::<f64x8>(series))),
            tables.varies.then(|| any(series_table::<Interval>(series))),
            tables.varies.then(|| any(series_table::<Rated>(series))),
            None,
        ],
        work: leak(move || work),
        series_gaps: known.series_gaps(),
        firsts: series.known(),
        defaults: leak(move |values: &mut [f64]| values.copy_from_slice(&defaults)),
        global: leak(move || global),
        forms: &[],
        room: known.room(),
    })
}

fn leak<T>(value: T) -> &'static T {
    Box::leak(Box::new(value))
}

fn any<T: Any + Send + Sync>(table: T) -> &'static (dyn Any + Send + Sync) {
    leak(table)
}

/// Declared values of parameters; NaN for one without.
fn defaults(model: &Model) -> Vec<f64> {
    let parameters = model.parameters.iter();
    parameters
        .map(|parameter| default_value(model, parameter).unwrap_or(f64::NAN))
        .collect()
}

fn series_table<L: Numbers>(series: &'static Series) -> SeriesTable<L> {
    SeriesTable {
        begin: leak(
            move |parameters: &[L], t: L, state: &[L], firsts: &mut [L]| {
                series.begin(parameters, t, state, firsts)
            },
        ),
        advance: leak(
            move |places: [&[L]; 3], to: (L, usize), take: Expanded<'_, L>| {
                series.advance(places, to, take);
            },
        ),
    }
}

fn native_series(series: &'static NativeSeries) -> SeriesTable<f64> {
    SeriesTable {
        begin: leak(
            move |parameters: &[f64], t: f64, state: &[f64], firsts: &mut [f64]| {
                series.begin(parameters, t, state, firsts)
            },
        ),
        advance: leak(
            move |places: [&[f64]; 3], to: (f64, usize), take: Expanded<'_, f64>| {
                series.advance(places, to, take);
            },
        ),
    }
}

/// The functions of a form by name.
#[derive(Debug)]
pub(crate) struct Functions(pub(crate) BTreeMap<Kernel, &'static Code>);

impl Functions {
    pub(crate) fn of(known: &FormOf<'_>) -> Self {
        let mut functions = BTreeMap::new();
        let mut velocity = None;
        for (kernel, function) in known.kernels() {
            let code: &'static Code = leak(Code::of_kernel(
                function,
                kernel,
                known.dimension(),
                velocity,
            ));
            // NOTE: velocities come first.
            velocity.get_or_insert(code);
            functions.insert(kernel, code);
        }
        Self(functions)
    }

    pub(crate) fn compiled(&self, series: &'static Series) -> Option<Compiled> {
        let codes: Vec<&'static Code> = self.0.values().copied().collect();
        native::compile(&codes, series)
    }

    /// The kernels over doubles, as machine code.
    fn native(&self, compiled: &mut Compiled) -> KernelTable<f64> {
        let functions = core::mem::take(&mut compiled.functions).into_iter();
        let functions: BTreeMap<Kernel, &'static Native> =
            self.0.keys().copied().zip(functions.map(leak)).collect();
        KernelTable::found(
            |kernel| {
                let native: &'static Native = functions.get(&kernel).copied()?;
                Some(leak(move |at: At<'_, f64>, values: &mut [f64]| {
                    native.run(at, values)
                }))
            },
            |of| {
                by_surface(&functions, of, |native: &Native, at, values| {
                    native.run(at, values)
                })
            },
        )
    }

    fn table<L: Numbers>(&self) -> KernelTable<L> {
        KernelTable::found(|kernel| self.plain(kernel), |of| self.of_surface(of))
    }

    fn plain<L: Numbers>(&self, kernel: Kernel) -> Option<&'static Plain<L>> {
        let code = *self.0.get(&kernel)?;
        Some(leak(move |at: At<'_, L>, values: &mut [L]| {
            code.run(at, values)
        }))
    }

    fn of_surface<L: Numbers>(&self, of: fn(usize) -> Kernel) -> Option<&'static OfSurface<L>> {
        by_surface(&self.0, of, |code, at, values| code.run(at, values))
    }
}

/// The functions of one kind for all surfaces, as one.
fn by_surface<L: Numbers, C: Send + Sync>(
    functions: &BTreeMap<Kernel, &'static C>,
    of: fn(usize) -> Kernel,
    run: impl Fn(&C, At<'_, L>, &mut [L]) -> Result<(), Fault> + Send + Sync + 'static,
) -> Option<&'static OfSurface<L>> {
    let surfaces = 0..SURFACES;
    let last = surfaces
        .rev()
        .find(|surface| functions.contains_key(&of(*surface)))?;
    let functions: Vec<Option<&'static C>> = (0..=last)
        .map(|surface| functions.get(&of(surface)).copied())
        .collect();
    Some(leak(
        move |surface: usize, at: At<'_, L>, values: &mut [L]| match functions.get(surface) {
            Some(Some(function)) => run(function, at, values),
            _ => Err(Fault::NotDerived),
        },
    ))
}
