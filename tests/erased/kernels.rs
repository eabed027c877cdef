//! Compares every emitted kernel, called by a pointer, with the kernel loaded from the text, at random points and over
//! every kind of number. Values have the same bits, where all NaN count as equal, and the same guards fail.

use std::fmt::Debug;

use dalembert::Fault;
use dalembert::erased::Form;
use dalembert::kernels::{At, Kernel};
use dalembert::numbers::{Bent, ComplexInterval, Interval, LENGTH, Numbers, Rated, TaylorModel};
use dalembert::variations::Dual;
use dalembert_codegen::spec::{Declaration, STEPS};
use dalembert_codegen::tables::FormOf;
use dalembert_codegen::{compile_modes, compile_spec, read};
use dalembert_erased::{Compiled, compared};
use dalembert_tests::sampling::Random;
use wide::f64x8;

/// Number of points at which each kernel over doubles is evaluated.
const POINTS: usize = 1000;

/// Number of points for other kinds of numbers.
const POINTS_OVER: usize = 20;

/// Numbers in each argument, enough for every model.
const ROOM: usize = 64;

/// A compiled form, and the same form loaded from its text.
#[derive(Clone, Copy)]
struct Pair<'f> {
    emitted: &'f Form,
    loaded: &'f Form,
}

impl Pair<'_> {
    /// The global forms of a pair of forms that are not global. `None` where the declaration does not ask for it.
    fn global(self) -> Option<Self> {
        let emitted = self.emitted.global()?;
        let loaded = self.loaded.global().expect("every form is loaded");
        for (global, form) in [(emitted, self.emitted), (loaded, self.loaded)] {
            assert!(!core::ptr::eq(global, form), "a form of its own");
        }
        Some(Self { emitted, loaded })
    }
}

/// A kind of number over which kernels are compared.
trait Drawn: Numbers {
    /// A random number with a value of order 1 and random further components.
    fn draw(random: &mut Random) -> Self;
}

impl Drawn for f64 {
    fn draw(random: &mut Random) -> Self {
        random.within(-1.5, 1.5)
    }
}

impl Drawn for f64x8 {
    fn draw(random: &mut Random) -> Self {
        Self::new(core::array::from_fn(|_| f64::draw(random)))
    }
}

impl Drawn for Dual {
    fn draw(random: &mut Random) -> Self {
        Self::new(
            f64::draw(random),
            core::array::from_fn(|_| f64::draw(random)),
        )
    }
}

fn short(random: &mut Random) -> Interval {
    let start = f64::draw(random);
    Interval::between(start, start + random.within(0.0, 1e-2))
}

impl Drawn for Rated {
    fn draw(random: &mut Random) -> Self {
        let (value, rate) = (short(random), short(random));
        Self { value, rate }
    }
}

impl Drawn for Bent {
    fn draw(random: &mut Random) -> Self {
        Self::line(short(random), f64::draw(random))
    }
}

impl Drawn for ComplexInterval {
    fn draw(random: &mut Random) -> Self {
        Self::varying(short(random), f64::draw(random).abs())
    }
}

impl Drawn for TaylorModel {
    fn draw(random: &mut Random) -> Self {
        let powers = [1.0, 0.1, 1e-2, 1e-3].map(|size| size * f64::draw(random));
        Self::exact(powers)
    }
}

/// Arguments of kernels.
struct Point<L> {
    parameters: Vec<L>,
    t: L,
    first: Vec<L>,
    second: Vec<L>,
}

impl<L: Drawn> Point<L> {
    /// A point with parameters near their declared values, or near 1 if they have none.
    fn draw(random: &mut Random, form: &Form) -> Self {
        let mut declared = vec![1.0; form.tables.dimensions.parameters];
        (form.defaults)(&mut declared);
        let parameters = declared.into_iter().map(|value| {
            let value = if value.is_nan() { 1.0 } else { value };
            L::of(value * random.within(0.9, 1.1))
        });
        let parameters = parameters.collect();
        let t = L::of(random.within(0.0, 2.0));
        let [first, second] = [(); 2].map(|()| (0..ROOM).map(|_| L::draw(random)).collect());
        Self {
            parameters,
            t,
            first,
            second,
        }
    }

    fn at(&self) -> At<'_, L> {
        At {
            parameters: &self.parameters,
            t: self.t,
            first: &self.first,
            second: &self.second,
        }
    }
}

/// Numbers of compared results: those with values, and those whose guard does not hold.
#[derive(Debug, Default)]
struct Count {
    values: usize,
    guarded: usize,
}

/// Compares a kernel over one kind of number at points. Returns true if the form has the kernel.
fn compare_kernel<L: Drawn>(
    pair: Pair,
    (kernel, length): (Kernel, usize),
    points: &[Point<L>],
    count: &mut Count,
) -> bool {
    let tables = [pair.emitted, pair.loaded].map(Form::kernels::<L>);
    let [Some(emitted), Some(loaded)] = tables else {
        assert!(tables[0].is_none(), "{kernel:?} is not loaded");
        return false;
    };
    for point in points {
        let [mut expected, mut found] = [(); 2].map(|()| vec![L::ZERO; length]);
        let holds = emitted.run(kernel, point.at(), &mut expected);
        if holds == Err(Fault::NotDerived) {
            return false;
        }
        assert_eq!(
            loaded.run(kernel, point.at(), &mut found),
            holds,
            "{kernel:?}"
        );
        match holds {
            Ok(()) => assert_same(kernel, &expected, &found),
            Err(_) => count.guarded += 1,
        }
        count.values += usize::from(holds.is_ok());
    }
    true
}

fn assert_same<L: Numbers + Debug>(what: impl Debug, expected: &[L], found: &[L]) {
    // NOTE: as text, NaN equals itself, and -0 differs from 0.
    let [expected, found] = [expected, found].map(|numbers| format!("{numbers:?}"));
    assert_eq!(expected, found, "{what:?}");
}

/// Compares the power series over one kind of number at points. Returns the number of compared series.
fn compare_series<L: Drawn>(pair: Pair, points: &[Point<L>]) -> usize {
    let series = [pair.emitted, pair.loaded].map(Form::series::<L>);
    let [Some(emitted), Some(loaded)] = series else {
        assert!(series[0].is_none(), "a series is not loaded");
        return 0;
    };
    let mut compared = 0;
    for point in points {
        let state = &point.first[..pair.emitted.tables.dimensions.state];
        let begin = |form: &Form, begin: &dyn Fn(&mut [L]) -> Result<(), Fault>| {
            let mut firsts = vec![L::ZERO; form.firsts];
            begin(&mut firsts).map(|()| firsts)
        };
        let of_emitted = begin(pair.emitted, &|firsts| {
            (emitted.begin)(&point.parameters, point.t, state, firsts)
        });
        let of_loaded = begin(pair.loaded, &|firsts| {
            (loaded.begin)(&point.parameters, point.t, state, firsts)
        });
        assert_eq!(of_emitted.is_ok(), of_loaded.is_ok());
        let (Ok(of_emitted), Ok(of_loaded)) = (of_emitted, of_loaded) else {
            continue;
        };
        for order in [0, 1, 2, 7, 20, LENGTH - 1] {
            let to = (L::of(0.3), order);
            let (mut expected, mut found) = (Vec::new(), Vec::new());
            (emitted.advance)(
                [&point.parameters, state, &of_emitted],
                to,
                &mut |_, a, b| {
                    expected.extend(a.iter().chain(b).copied());
                },
            );
            (loaded.advance)(
                [&point.parameters, state, &of_loaded],
                to,
                &mut |_, a, b| {
                    found.extend(a.iter().chain(b).copied());
                },
            );
            assert_same(("order", order), &expected, &found);
            compared += 1;
        }
    }
    compared
}

/// Compares all kernels and the series over a kind of number. Adds the number of those that exist to `given`.
fn compare_over<L: Drawn>(pair: Pair, known: &FormOf<'_>, points: usize, given: &mut usize) {
    let mut random = Random::new(3);
    let points: Vec<Point<L>> = (0..points)
        .map(|_| Point::draw(&mut random, pair.emitted))
        .collect();
    let mut count = Count::default();
    for (kernel, function) in known.kernels() {
        let kernel = (kernel, function.outputs.len());
        *given += usize::from(compare_kernel(pair, kernel, &points, &mut count));
    }
    *given += usize::from(compare_series(pair, &points[..points.len().min(POINTS_OVER)]) > 0);
    assert!(count.guarded <= count.values, "{count:?}");
}

fn compare(pair: Pair, known: &FormOf<'_>) {
    let mut given = [0; 7];
    compare_over::<f64>(pair, known, POINTS, &mut given[0]);
    compare_over::<f64x8>(pair, known, POINTS_OVER, &mut given[1]);
    compare_over::<Dual>(pair, known, POINTS_OVER, &mut given[2]);
    compare_over::<TaylorModel>(pair, known, POINTS_OVER, &mut given[3]);
    compare_over::<Bent>(pair, known, POINTS_OVER, &mut given[4]);
    compare_over::<Rated>(pair, known, POINTS_OVER, &mut given[5]);
    compare_over::<ComplexInterval>(pair, known, POINTS_OVER, &mut given[6]);
    let name = pair.emitted.documentation.description.name;
    assert_eq!(given[0], known.kernels().len() + 1, "{name}");
    let has_surfaces = !pair.emitted.tables.surfaces.is_empty();
    let is_enclosed = has_surfaces || pair.emitted.tables.can_lose_rank;
    assert_eq!(given[3] > 0, is_enclosed, "{name}");
    assert_eq!(given[4] > 0, has_surfaces, "{name}");
    assert_eq!(given[6] > 0, has_surfaces, "{name}");
    assert_eq!(given[2] > 0, pair.emitted.tables.varies, "{name}");
}

/// Compares a form and its global form. True if the latter is emitted.
fn compare_forms(pair: Pair, known: &[FormOf<'_>]) -> bool {
    compare(pair, &known[0]);
    let Some(known) = known.get(1) else {
        return false;
    };
    let global = pair.global();
    global.map(|global| compare(global, known)).is_some()
}

/// Compares all forms of a model. Returns the number of separate global forms of the model and its scenes.
fn compare_model(compiled: &Compiled) -> usize {
    let declaration = read(compiled.description.source.parse().expect("tokens"));
    let pair = |scene: usize| Pair {
        emitted: compiled.emitted[scene].1,
        loaded: compiled.loaded(scene),
    };
    match declaration.expect("a declaration") {
        Declaration::Model(spec) => {
            let model = compile_spec(&spec, STEPS).expect("a model");
            let scenes = &model.model.scenes;
            let all = core::iter::once(&model).chain(&model.scenes).enumerate();
            all.filter(|(index, known)| compare_forms(pair(*index), &FormOf::all(known, scenes)))
                .count()
        }
        Declaration::Modes(modes) => {
            let model = compile_modes(&modes).expect("a model with modes");
            let scenes = &model.graph.modes[0].model.scenes;
            let known: Vec<FormOf<'_>> = model
                .modes
                .iter()
                .flat_map(|mode| FormOf::all(mode, scenes))
                .collect();
            let whole = pair(0);
            let forms: [&[_]; 2] = [&whole.emitted.forms, &whole.loaded.forms];
            assert_eq!(forms.map(<[_]>::len), [known.len(); 2]);
            for ((emitted, loaded), known) in forms[0].iter().zip(forms[1]).zip(&known) {
                compare(Pair { emitted, loaded }, known);
            }
            0
        }
    }
}

#[test]
fn emitted_kernels_are_the_loaded_ones() {
    let mut globals = 0;
    for compiled in compared() {
        println!("{}", compiled.description.name);
        globals += compare_model(compiled);
    }
    assert!(globals >= 3, "{globals} global forms");
}
