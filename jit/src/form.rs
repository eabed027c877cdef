//! Forms: tables, and closures over the executors of programs. A form owns all of them.

use std::any::Any;
use std::collections::BTreeMap;
use std::sync::Arc;

use dalembert::Fault;
use dalembert::erased::{Defaults, Form, Global, Held, Kinds, SeriesTable, Shared};
use dalembert::jet::Work;
use dalembert::kernels::{At, KernelTable, OfSurface, Plain};
use dalembert::numbers::{
    Bent, ComplexInterval, Everywhere, Interval, Numbers, Rated, TaylorModel,
};
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
pub(crate) fn of_model(compiled: &codegen::Compiled, scenes: &[Scene]) -> Arc<Form> {
    let may_be_narrow = compiled.programs.main.can_be_narrow;
    forms(&FormOf::all(compiled, scenes), may_be_narrow).remove(0)
}

/// The forms of a model, a scene or a mode. The first is the form in which the model runs. A different global form
/// follows it, to which the first refers.
fn forms(known: &[FormOf<'_>], may_be_narrow: bool) -> Vec<Arc<Form>> {
    let (first, others) = known.split_first().expect("a model has a form");
    let others: Vec<Arc<Form>> = others
        .iter()
        .map(|known| form(known, may_be_narrow, Global::Itself))
        .collect();
    let global = match others.first() {
        Some(global) => Global::Another(Arc::clone(global).into()),
        None => Global::Itself,
    };
    let first = form(first, may_be_narrow, global);
    core::iter::once(first).chain(others).collect()
}

/// The form of a model with modes.
pub(crate) fn of_modes(compiled: &CompiledModes) -> Arc<Form> {
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
    let of_modes: Vec<Vec<Arc<Form>>> = whole
        .forms
        .iter()
        .map(|known| forms(known, tables.can_be_narrow))
        .collect();
    let gaps = whole.series_gaps();
    let rests = of_modes.iter().map(|forms| {
        let form = &forms[0];
        form.firsts - form.tables.dimensions.state - form.series_gaps
    });
    let firsts = tables.dimensions.state + gaps + rests.max().unwrap_or(0);
    let forms: Vec<Shared<Form>> = of_modes.into_iter().flatten().map(Shared::from).collect();
    Arc::new(Form {
        tables: Held::Owned(Box::new(tables)),
        documentation: Held::Owned(Box::new(whole.documentation())),
        kernels: KernelTable::found(|_| None, |_| None),
        kernels_over: Kinds::default(),
        series: SeriesTable::NONE,
        series_over: Kinds::default(),
        work: work(whole.work()),
        series_gaps: gaps,
        firsts,
        defaults: defaults(whole.model()),
        global: Global::Itself,
        forms: forms.into_boxed_slice().into(),
        room: whole.room(),
    })
}

/// A form. It has rates over intervals if `may_be_narrow`. A form with variations has all kernels for certified motion.
fn form(known: &FormOf<'_>, may_be_narrow: bool, global: Global) -> Arc<Form> {
    let series = Arc::new(Series::of(
        &known.program.jet,
        (known.dimension(), known.state_dimension()),
    ));
    let functions = Functions::of(known);
    let mut compiled = functions.compiled(&series);
    let tables = known.tables();
    let has_surfaces = !tables.surfaces.is_empty();
    let (varies, can_lose_rank) = (tables.varies, tables.can_lose_rank);
    Arc::new(Form {
        tables: Held::Owned(Box::new(tables)),
        documentation: Held::Owned(Box::new(known.documentation())),
        kernels: match &mut compiled {
            Some(compiled) => functions.native(compiled),
            None => functions.table(),
        },
        kernels_over: [
            (has_surfaces || can_lose_rank).then(|| any(functions.table::<TaylorModel>())),
            has_surfaces.then(|| any(functions.table::<Bent>())),
            has_surfaces.then(|| any(functions.table::<ComplexInterval>())),
            (may_be_narrow || varies).then(|| any(functions.table::<Rated>())),
            varies.then(|| any(functions.table::<Dual>())),
            varies.then(|| any(functions.table::<Interval>())),
            may_be_narrow.then(|| any(functions.table::<Everywhere>())),
        ],
        series: match compiled {
            Some(compiled) => native_series(compiled.series),
            None => series_table(&series),
        },
        series_over: [
            varies.then(|| any(series_table::<Dual>(&series))),
            Some(any(series_table::<f64x8>(&series))),
            varies.then(|| any(series_table::<Interval>(&series))),
            varies.then(|| any(series_table::<Rated>(&series))),
            None,
            None,
            None,
        ],
        work: work(Some(known.work())),
        series_gaps: known.series_gaps(),
        firsts: series.known(),
        defaults: defaults(known.model),
        global,
        forms: Held::Static(&[]),
        room: known.room(),
    })
}

fn any<T: Any + Send + Sync>(table: T) -> Held<dyn Any + Send + Sync> {
    Held::Owned(Box::new(table))
}

fn work(work: Option<Work>) -> Held<dyn Fn() -> Option<Work> + Send + Sync> {
    Held::Owned(Box::new(move || work))
}

/// Writes the default of each parameter, or NaN if it has none.
fn defaults(model: &Model) -> Held<Defaults> {
    let parameters = model.parameters.iter();
    let defaults: Vec<f64> = parameters
        .map(|parameter| default_value(model, parameter).unwrap_or(f64::NAN))
        .collect();
    Held::Owned(Box::new(move |values| values.copy_from_slice(&defaults)))
}

fn series_table<L: Numbers>(series: &Arc<Series>) -> SeriesTable<L> {
    let [begin, advance] = [series, series].map(Arc::clone);
    SeriesTable {
        begin: Held::Owned(Box::new(move |parameters, t, state, firsts| {
            begin.begin(parameters, t, state, firsts)
        })),
        advance: Held::Owned(Box::new(move |places, to, take| {
            advance.advance(places, to, take);
        })),
    }
}

fn native_series(series: NativeSeries) -> SeriesTable<f64> {
    let series = Arc::new(series);
    let begin = Arc::clone(&series);
    SeriesTable {
        begin: Held::Owned(Box::new(move |parameters, t, state, firsts| {
            begin.begin(parameters, t, state, firsts)
        })),
        advance: Held::Owned(Box::new(move |places, to, take| {
            series.advance(places, to, take);
        })),
    }
}

/// The functions of a form, by kernel.
#[derive(Debug)]
pub(crate) struct Functions(pub(crate) BTreeMap<Kernel, Arc<Code>>);

impl Functions {
    pub(crate) fn of(known: &FormOf<'_>) -> Self {
        let mut functions = BTreeMap::new();
        let mut velocity = None;
        for (kernel, function) in known.kernels() {
            let code = Code::of_kernel(function, kernel, known.dimension(), velocity.as_ref());
            let code = Arc::new(code);
            // NOTE: the kernel of the velocities comes first.
            velocity.get_or_insert_with(|| Arc::clone(&code));
            functions.insert(kernel, code);
        }
        Self(functions)
    }

    pub(crate) fn compiled(&self, series: &Series) -> Option<Compiled> {
        let codes: Vec<Arc<Code>> = self.0.values().map(Arc::clone).collect();
        native::compile(&codes, series)
    }

    /// The kernels over doubles, as machine code.
    fn native(&self, compiled: &mut Compiled) -> KernelTable<f64> {
        let functions = core::mem::take(&mut compiled.functions).into_iter();
        let functions: BTreeMap<Kernel, Arc<Native>> = self
            .0
            .keys()
            .copied()
            .zip(functions.map(Arc::new))
            .collect();
        KernelTable::found(
            |kernel| {
                let native = Arc::clone(functions.get(&kernel)?);
                let run = move |at: At<'_, f64>, values: &mut [f64]| native.run(at, values);
                Some(Held::Owned(Box::new(run)))
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

    fn plain<L: Numbers>(&self, kernel: Kernel) -> Option<Held<Plain<L>>> {
        let code = Arc::clone(self.0.get(&kernel)?);
        let run = move |at: At<'_, L>, values: &mut [L]| code.run(at, values);
        Some(Held::Owned(Box::new(run)))
    }

    fn of_surface<L: Numbers>(&self, of: fn(usize) -> Kernel) -> Option<Held<OfSurface<L>>> {
        by_surface(&self.0, of, |code: &Code, at, values| code.run(at, values))
    }
}

/// The functions of one kind for all surfaces, combined into one.
fn by_surface<L: Numbers, C: Send + Sync + 'static>(
    functions: &BTreeMap<Kernel, Arc<C>>,
    of: fn(usize) -> Kernel,
    run: impl Fn(&C, At<'_, L>, &mut [L]) -> Result<(), Fault> + Send + Sync + 'static,
) -> Option<Held<OfSurface<L>>> {
    let surfaces = 0..SURFACES;
    let last = surfaces
        .rev()
        .find(|surface| functions.contains_key(&of(*surface)))?;
    let functions: Vec<Option<Arc<C>>> = (0..=last)
        .map(|surface| functions.get(&of(surface)).map(Arc::clone))
        .collect();
    let of_surfaces =
        move |surface: usize, at: At<'_, L>, values: &mut [L]| match functions.get(surface) {
            Some(Some(function)) => run(function, at, values),
            _ => Err(Fault::NotDerived),
        };
    Some(Held::Owned(Box::new(of_surfaces)))
}
