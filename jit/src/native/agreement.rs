//! Machine code of eight shipped models agrees bit for bit with the interpreters of `machine.rs` and `series.rs`.

use dalembert::kernels::At;
use dalembert::numbers::LENGTH;
use dalembert_codegen::spec::{Declaration, STEPS};
use dalembert_codegen::tables::{FormOf, default_value};
use dalembert_codegen::{self as codegen};

use super::random::{Random, bits};
use super::{Native, NativeSeries};
use crate::form::Functions;
use crate::series::Series;
use crate::source::{self, Refused};

/// Number of random states at which each function is evaluated.
const ROUNDS: usize = 20;

/// Length of argument vectors, large enough for every model.
const ROOM: usize = 256;

macro_rules! models {
    ($($name:ident)*) => {
        $(
            #[test]
            fn $name() {
                compare_text(include_str!(concat!("../../../models/src/", stringify!($name), ".dal")));
            }
        )*
    };
}

models! {
    bouncing_ball
    chain16
    chaplygin_sleigh
    double_pendulum
    rolling_disk
    spring_mass_walker
    tent_map
    two_wheels_rod
}

/// A field whose series has features that no shipped model has: time, polynomials of time as factors, an absolute value
/// together with gaps.
#[test]
fn driven() {
    compare_text(
        "Driven {
            coordinates { x; y; z; }
            parameters { k > 0 = 2; }
            field {
                dot(x) = k*y*(1 + t^3);
                dot(y) = abs(z)*sin(x) - (t^2 - t)*x*y;
                dot(z) = t - z*cos(y);
            }
            impacts { floor: x + t^2*z >= 0 => reset { x = 1; }; }
        }",
    );
}

fn compare_text(text: &str) {
    let models = source::models(&mut Refused::new("", text)).expect("a text");
    for tokens in models {
        match codegen::read(tokens).expect("a declaration") {
            Declaration::Model(spec) => {
                let compiled = codegen::compile_spec(&spec, STEPS).expect("a model");
                let scenes = &compiled.model.scenes;
                for compiled in core::iter::once(&compiled).chain(&compiled.scenes) {
                    FormOf::all(compiled, scenes).iter().for_each(compare);
                }
            }
            Declaration::Modes(modes) => {
                let compiled = codegen::compile_modes(&modes).expect("a model with modes");
                let scenes = &compiled.graph.modes[0].model.scenes;
                for mode in &compiled.modes {
                    FormOf::all(mode, scenes).iter().for_each(compare);
                }
            }
        }
    }
}

/// Arguments of a function.
struct Point {
    parameters: Vec<f64>,
    t: f64,
    first: Vec<f64>,
    second: Vec<f64>,
}

impl Point {
    /// A random point near the declared parameters.
    fn draw(random: &mut Random, known: &FormOf<'_>) -> Self {
        let parameters = known.model.parameters.iter();
        Self {
            parameters: parameters
                .map(|parameter| {
                    let declared = default_value(known.model, parameter).unwrap_or(1.0);
                    declared * random.between(0.9, 1.1)
                })
                .collect(),
            t: random.between(0.0, 2.0),
            first: (0..ROOM).map(|_| random.between(-1.0, 1.0)).collect(),
            second: (0..ROOM).map(|_| random.between(-1.0, 1.0)).collect(),
        }
    }

    fn at(&self) -> At<'_, f64> {
        At {
            parameters: &self.parameters,
            t: self.t,
            first: &self.first,
            second: &self.second,
        }
    }
}

fn compare(known: &FormOf<'_>) {
    let dimensions = (known.dimension(), known.state_dimension());
    let series = Series::of(&known.program.jet, dimensions);
    let functions = Functions::of(known);
    let compiled = functions.compiled(&series);
    let compiled = compiled.expect("machine code for this processor");
    let mut random = Random(3);
    let points: [Point; ROUNDS] = core::array::from_fn(|_| Point::draw(&mut random, known));
    for (kernel, native) in functions.0.keys().zip(&compiled.functions) {
        let held = points.iter().filter(|point| compare_at(native, point));
        assert!(held.count() > 0, "{kernel:?}");
    }
    for point in &points {
        compare_series(&series, &compiled.series, point);
    }
}

/// Compares a function at a point. Returns true if its guards hold there.
fn compare_at(native: &Native, point: &Point) -> bool {
    let [mut expected, mut found] = [(); 2].map(|()| vec![0.0; native.code.outputs.len()]);
    let holds = native.code.run(point.at(), &mut expected).is_ok();
    assert_eq!(native.holds(point.at(), &mut found), holds);
    if holds {
        assert_eq!(bits(&expected), bits(&found), "{:?}", native.code);
    }
    holds
}

fn compare_series(series: &Series, native: &NativeSeries, point: &Point) {
    if !compare_at(&native.begin, point) {
        return;
    }
    let state = &point.first[..series.components];
    let mut firsts = vec![0.0; series.known()];
    series
        .begin(&point.parameters, point.t, state, &mut firsts)
        .expect("guards that hold");
    let places = [point.parameters.as_slice(), state, &firsts];
    for order in (0..=20).chain([LENGTH - 1]) {
        let (mut expected, mut found) = (Vec::new(), Vec::new());
        series.advance(places, (0.3, order), &mut |k, coefficients, gaps| {
            expected.push((k, bits(coefficients), bits(gaps)));
        });
        native.advance(places, (0.3, order), &mut |k, coefficients, gaps| {
            found.push((k, bits(coefficients), bits(gaps)));
        });
        assert_eq!(expected, found, "order {order}");
    }
}
