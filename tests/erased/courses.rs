//! Whole runs of the compared models and their scenes by every integrator. The functions of a model are emitted and
//! called by pointers, loaded from its text, or, for a model or two, inlined. Counters, impacts, contacts and final states
//! are the same to the bit.

use std::sync::{Arc, OnceLock};

use dalembert::describe::Description;
use dalembert::{Policies, erased};
use dalembert_driver::{
    AnyModel, Code, Contact, Ending, Form, Impact, Integrator, OffConstraint, Origin, Piece, Rates,
    Settings, Watch, of_form, of_type,
};

use dalembert_erased::{Compiled, compared};
use dalembert_tests::sampling::Random;

/// Longest time of a run.
const UNTIL: f64 = 2.0;

/// Tolerance of all integrators. At a smaller one, integrators of low order with a fixed step need too many steps.
const TOLERANCE: f64 = 1e-7;

/// Records the events as text, since NaN does not equal itself.
#[derive(Default)]
struct Log(Vec<String>);

impl Watch for Log {
    // The counters of the run include the steps.
    fn step(&mut self, _piece: &dyn Piece) {}

    fn impact(&mut self, impact: Impact) {
        self.0.push(format!("{impact:?}"));
    }

    fn contact(&mut self, contact: Contact) {
        self.0.push(format!("{contact:?}"));
    }
}

/// The declared start of a model; for a model without a start, a state inside its chart.
fn origin(model: &dyn AnyModel) -> Origin {
    let start = model.initial();
    let declared = model
        .complete_position(&start.q, &start.placed)
        .and_then(|q| Ok((model.complete_velocity(&q, &start.qdot, &start.named)?, q)));
    match declared {
        Ok((qdot, q)) if q.iter().chain(&qdot).all(|value| value.is_finite()) => Origin {
            q,
            rates: Rates::Velocities(qdot),
            policy: OffConstraint::Error,
        },
        _ => {
            let mut random = Random::new(7);
            let mut values = |low| start.q.iter().map(|_| random.within(low, 1.0)).collect();
            Origin {
                q: values(0.1),
                rates: Rates::Velocities(values(-1.0)),
                policy: OffConstraint::Project,
            }
        }
    }
}

/// Events of the run of a model from its start, and its end as text.
fn course(model: &dyn AnyModel, form: Form, integrator: Integrator) -> (Vec<String>, String) {
    let origin = origin(model);
    let is_long = model.description().coordinates.len() > 6;
    let longest = if is_long { 0.1 * UNTIL } else { UNTIL };
    let settings = Settings {
        form,
        integrator,
        tol: TOLERANCE,
        step: None,
        max_step: None,
        steps: None,
        until: model
            .initial()
            .until
            .map_or(longest, |until| until.min(longest)),
        impacts: None,
        laws: Vec::new(),
        policies: Policies::default(),
        projection: None,
    };
    let mut log = Log::default();
    let ended = model.simulate(&origin, &settings, &mut log);
    let ended = ended.map(
        |Ending {
             outcome,
             t,
             last,
             counters,
             ..
         }| (outcome, t, last, counters),
    );
    (log.0, format!("{ended:?}"))
}

/// Compares the runs of two models by every integrator.
fn compare(expected: &dyn AnyModel, found: &dyn AnyModel, form: Form, what: &str) {
    for &integrator in Integrator::every() {
        let [expected, found] = [expected, found].map(|model| course(model, form, integrator));
        assert_eq!(expected.1, found.1, "{what}, {}", integrator.name());
        assert_eq!(expected.0, found.0, "{what}, {}", integrator.name());
    }
}

fn compare_loaded(compiled: &Compiled) {
    for (index, &(scene, emitted)) in compiled.emitted.iter().enumerate() {
        let emitted = of_form(emitted.into(), Code::Pointers).expect("room");
        let loaded =
            of_form(Arc::clone(compiled.loaded(index)).into(), Code::Loaded).expect("room");
        let Description { name, modes, .. } = emitted.description();
        compare(
            &*emitted,
            &*loaded,
            Form::Reduced,
            &format!("{name} {scene}"),
        );
        let has_global = compiled.emitted[index].1.global().is_some();
        if modes.is_empty() && index == 0 && has_global {
            compare(
                &*emitted,
                &*loaded,
                Form::Global,
                &format!("{name}, global"),
            );
        }
    }
}

#[test]
fn a_loaded_model_runs_as_the_compiled_one() {
    compared().iter().for_each(compare_loaded);
}

#[test]
fn a_model_behind_pointers_runs_as_its_own_type() {
    macro_rules! compare_inlined {
        ($($model:ty),*) => {$({
            let whole = OnceLock::<Arc<erased::Form>>::new();
            let whole = Arc::new(whole);
            let given = Arc::clone(&whole);
            let inlined = of_type::<$model>(Arc::new(move || Some(given.get()?.clone().into())));
            let name = inlined.description().name;
            let mut models = compared().iter();
            let compiled = models.find(|compiled| compiled.description.name == name);
            let compiled = compiled.expect("a model");
            let loaded = Arc::clone(compiled.loaded(0));
            assert!(whole.set(Arc::clone(&loaded)).is_ok());
            let loaded = of_form(loaded.into(), Code::Loaded).expect("room");
            compare(&*inlined, &*loaded, Form::Global, name);
            let (_, form) = compiled.emitted[0];
            let erased = of_form(form.into(), Code::Pointers).expect("room");
            compare(&*inlined, &*erased, Form::Reduced, name);
        })*};
    }
    compare_inlined!(dalembert_models::RollingDisk);
    // Each costs ten seconds of compilation.
    #[cfg(feature = "every_model")]
    compare_inlined!(dalembert_models::RimlessWheelFive);
}
