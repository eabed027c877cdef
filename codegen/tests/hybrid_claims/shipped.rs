//! Claims of the shipped models.

use dalembert_codegen::claims::{Finding, Verdict};
use dalembert_codegen::model::{self, Law, Model, Surface};
use dalembert_codegen::read;
use dalembert_codegen::spec::Declaration;
use dalembert_texts::TEXTS;

use crate::findings;

/// A declaration without its claims.
fn unclaimed(text: &str) -> String {
    let mut kept = String::new();
    let mut rest = text;
    while let Some(start) = rest.find("claims ") {
        let (before, from) = rest.split_at(start);
        kept += before;
        let end = from.find('}').expect("the end of the claims");
        rest = &from[end + 1..];
    }
    kept + rest
}

/// A declaration with these claims in place of its own.
pub(super) fn claiming(text: &str, claims: &str) -> String {
    let text = unclaimed(text);
    let end = text.rfind('}').expect("a declaration");
    format!("{} claims {{ {claims} }} }}", &text[..end])
}

/// Relation of a declaration to the symplectic form.
#[derive(Debug, PartialEq, Eq)]
enum Kind {
    /// A first-order system, which has no symplectic form.
    FirstOrder,
    /// Without constraints and forces. All impacts are elastic, and all transitions are refractions.
    Elastic,
    /// With forces, or with maps that are not elastic.
    Changed,
    /// With constraints in some mode.
    Constrained,
}

/// The models of all modes of a declaration; one model if there are no modes.
fn modes(text: &str) -> Vec<Model> {
    match read(unclaimed(text).parse().expect("tokens")).expect("syntax") {
        Declaration::Model(spec) => vec![model::check(&spec).expect("a model")],
        Declaration::Modes(modes) => {
            let graph = model::check_modes(&modes).expect("modes");
            graph.modes.into_iter().map(|mode| mode.model).collect()
        }
    }
}

fn kind(modes: &[Model]) -> Kind {
    let is_elastic = |surface: &Surface| match surface.law {
        Law::Elastic => true,
        Law::Transition => surface
            .transition
            .as_ref()
            .is_some_and(|transition| transition.map.is_none()),
        _ => false,
    };
    let is_changed =
        |mode: &Model| !mode.forces.is_empty() || !mode.surfaces.iter().all(is_elastic);
    if modes.iter().any(Model::is_first_order) {
        Kind::FirstOrder
    } else if modes.iter().any(|mode| !mode.constraints.is_empty()) {
        Kind::Constrained
    } else if modes.iter().any(is_changed) {
        Kind::Changed
    } else {
        Kind::Elastic
    }
}

/// Models whose constraints keep the positions on a leaf. The form is kept on each leaf.
const ON_LEAVES: [&str; 2] = ["holonomic_bead_on_ellipses", "two_wheels_rod"];

/// A walker whose steps map vectors along a leaf to vectors across leaves.
const ACROSS_LEAVES: &str = "spring_mass_walker";

#[test]
fn elastic_models_without_constraints_or_on_leaves_alone_are_symplectic() {
    let mut seen = [0; 5];
    for (name, text) in TEXTS {
        let kind = kind(&modes(text));
        if kind == Kind::FirstOrder {
            continue;
        }
        let found = findings(&claiming(text, "symplectic;"));
        let is_proved = |finding: &Finding| matches!(finding.verdict, Verdict::Proved(_));
        let has_point = |finding: &Finding| match &finding.verdict {
            Verdict::Refuted(witness) => witness.sample.is_some(),
            _ => false,
        };
        let is_open = |finding: &Finding| matches!(&finding.verdict, Verdict::Undecided(reason) if reason.contains("along leaves of the constraints behind"));
        let (holds, counted) = match kind {
            Kind::Elastic => (found.iter().all(is_proved), 0),
            Kind::Constrained if ON_LEAVES.contains(name) => (found.iter().all(is_proved), 1),
            Kind::Constrained if *name == ACROSS_LEAVES => (found.iter().any(is_open), 2),
            Kind::Constrained => (found.iter().any(has_point), 3),
            _ => (found.iter().all(has_point), 4),
        };
        let notes = found.iter().map(Finding::note).collect::<Vec<_>>();
        assert!(holds, "{name}, {kind:?}: {notes:?}");
        seen[counted] += 1;
    }
    // Numbers of models: elastic, on leaves, across leaves, nonholonomic, with forces or other maps.
    assert_eq!(seen, [11, 2, 1, 11, 4]);
}

/// Every shipped model claims something, and all of it is proved.
#[test]
fn claims_of_shipped_models_are_proved() {
    for (name, text) in TEXTS {
        let found = findings(text);
        assert!(!found.is_empty(), "{name}");
        for finding in found {
            let is_proved = matches!(finding.verdict, Verdict::Proved(_));
            assert!(is_proved, "{name}: {}", finding.note());
        }
    }
}
