//! Emitted code, the same code behind pointers, and code loaded from a text satisfy one contract. Tables, kernels and
//! whole runs are the same to the bit.

mod courses;
mod kernels;

use dalembert::erased::{Bounded, Erased, Form};
use dalembert::{Instance, System};
use dalembert_erased::{Compiled, compared};

fn assert_same_tables(emitted: &Form, loaded: &Form) {
    let name = emitted.documentation.description.name;
    assert_eq!(emitted.tables, loaded.tables, "{name}");
    assert_eq!(emitted.documentation, loaded.documentation, "{name}");
    assert_eq!((emitted.work)(), (loaded.work)(), "{name}");
    // NOTE: `firsts` is not compared, since emitted and loaded series begin with different numbers.
    let lengths = |form: &Form| {
        let numbers = [form.series_gaps, form.room];
        (form.capacity(), numbers, form.forms.len())
    };
    assert_eq!(lengths(emitted), lengths(loaded), "{name}");
    for (emitted, loaded) in emitted.forms.iter().zip(loaded.forms.iter()) {
        assert_same_tables(emitted, loaded);
    }
}

#[test]
fn tables_are_the_loaded_ones() {
    for compiled in compared() {
        for (index, (_, emitted)) in compiled.emitted.iter().enumerate() {
            assert_same_tables(emitted, compiled.loaded(index));
        }
    }
}

#[test]
fn a_form_needs_room_for_its_vectors() {
    let is_chain = |compiled: &&Compiled| compiled.description.name == "chain4";
    let chain = compared().iter().find(is_chain);
    let (_, form) = chain.expect("a model").emitted[0];
    assert_eq!(form.capacity(), Some(8));
    let refused = Erased::<4>::of(form).unwrap_err();
    assert_eq!(
        refused.to_string(),
        "8 components of a state, and there is room for 4"
    );
    let chain = Erased::<16>::of(form).expect("room");
    assert_eq!(chain.description().name, "chain4");
    let zeros: Bounded<f64, 16> = chain.zero_vector();
    assert_eq!(zeros.as_ref(), [0.0; 4]);
}

#[cfg(feature = "every_model")]
#[test]
fn every_shipped_model_is_compared() {
    let compared: Vec<&str> = compared().iter().map(|it| it.description.name).collect();
    for (name, _) in dalembert_command::TEXTS {
        assert!(compared.contains(name), "{name}");
    }
}
