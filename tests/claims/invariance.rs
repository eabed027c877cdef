//! Verdicts on densities do not depend on the choice of constraint forms, on the coordinates and their order, or on the
//! seed of the random points.

use dalembert_codegen::claims::{Geometry, geometry_at};
use dalembert_declarations::visible::{Scheme, declaration, visible_system, visible_systems};
use dalembert_expr::SymbolId;
use dalembert_tests::verdict::{Decided, Existence};

/// Every system of `reference/verdicts_visible.json`, unchanged, with its verdict.
fn systems() -> Vec<(Scheme, Decided)> {
    visible_systems()
        .iter()
        .map(|system| {
            let scheme = Scheme::of(system);
            let decided = Decided::of(&scheme.declaration());
            (scheme, decided)
        })
        .collect()
}

fn assert_same(decided: &Decided, other: &Decided, what: &str) {
    let (local, known) = (&decided.exactness().local, &other.exactness().local);
    assert_eq!(decided.existence(), other.existence(), "{what}");
    assert_eq!(
        (local.rank, local.extended_rank),
        (known.rank, known.extended_rank),
        "{what}"
    );
    assert_eq!(local.growth, known.growth, "{what}");
}

/// A function of the coordinates that is at least 2.
fn positive(scheme: &Scheme) -> String {
    let terms: Vec<String> = scheme
        .coordinates
        .iter()
        .map(|(name, domain)| match domain.as_str() {
            "R" => format!("{name}^2"),
            _ => format!("(1 + sin({name}))"),
        })
        .collect();
    format!("(2 + ({})/8)", terms.join(" + "))
}

/// The same distribution with the forms `F eta`, where the matrix `F` is regular everywhere, and the formula `det F`.
fn rescaled(scheme: &Scheme) -> (Scheme, String) {
    let f = positive(scheme);
    let mut other = scheme.clone();
    if let [first, second] = scheme.forms.as_slice() {
        let row = |a: &str, b: &str| {
            let entry = |(p, q): (&String, &String)| format!("{a}*({p}) + {b}*({q})");
            first.iter().zip(second).map(entry).collect()
        };
        other.forms = vec![row(&f, "1"), row("-1", &f)];
        return (other, format!("({f}^2 + 1)"));
    }
    assert_eq!(scheme.forms.len(), 1);
    for entry in &mut other.forms[0] {
        *entry = format!("{f}*({entry})");
    }
    (other, f)
}

/// Values of coordinates and parameters of a model, and its geometry there.
fn at(decided: &Decided, attempt: usize, dependent: &[usize]) -> (Vec<(SymbolId, f64)>, Geometry) {
    let mut values = decided.defaults();
    for (i, coordinate) in decided.model.coordinates.iter().enumerate() {
        values.push((coordinate.q, 0.4 + ((3 * i + 5 * attempt) % 7) as f64 / 9.0));
    }
    let (pool, problem) = (&decided.model.pool, &decided.problem);
    let geometry = geometry_at(pool, problem, &values, Some(dependent)).expect("a regular point");
    (values, geometry)
}

/// Compares verdicts and volumes. Returns true if volumes were found and compared.
fn assert_same_verdict_and_volume(scheme: &Scheme, decided: &Decided) -> bool {
    let (other, factor) = rescaled(scheme);
    let source = other.declaration();
    let body = source.strip_suffix('}').expect("a body");
    let other = Decided::of(&format!("{body} outputs {{ factor: {factor}; }} }}"));
    let (local, known) = (&other.exactness().local, &decided.exactness().local);
    assert_eq!(local.exists, known.exists, "{source}");
    assert_eq!(local.growth, known.growth, "{source}");
    // If the motion stays on leaves, the search finds only densities that have a closed form.
    if other.potential().is_some() || known.rank == decided.model.coordinates.len() {
        assert_eq!(other.existence(), decided.existence(), "{source}");
    }
    let (coordinates, mut values) = (decided.model.coordinates.iter(), decided.defaults());
    values.extend(
        coordinates
            .zip(1..)
            .map(|(coordinate, i)| (coordinate.q, 0.3 + 0.1 * f64::from(i))),
    );
    let dependent = decided.regular_dependent(&values);
    let mut ratios = Vec::new();
    for attempt in 0..4 {
        let (values, before) = at(decided, attempt, &dependent);
        let (other_values, after) = at(&other, attempt, &dependent);
        let factor = other.model.outputs[0].value;
        let value = |symbol| {
            let found = other_values.iter().find(|(known, _)| *known == symbol);
            found.map_or(f64::NAN, |(_, value)| *value)
        };
        let factor = other.model.pool.eval(&[factor], &value)[0];
        let size = factor.powi(2) * before.mass_determinant;
        assert!(
            (after.mass_determinant / size - 1.0).abs() < 1e-12,
            "{source}"
        );
        if let (Some(_), Some(_)) = (decided.potential(), other.potential()) {
            ratios.push(
                log_volume(&other, &other_values, &after) - log_volume(decided, &values, &before),
            );
        }
    }
    for ratio in &ratios {
        assert!((ratio - ratios[0]).abs() < 1e-10, "{source}");
    }
    !ratios.is_empty()
}

/// The logarithm of `exp(G) mu_C` relative to `dq dv_ind`.
fn log_volume(decided: &Decided, values: &[(SymbolId, f64)], geometry: &Geometry) -> f64 {
    let volume = geometry.metric_determinant / geometry.dependent_determinant.abs();
    volume.ln()
        + decided
            .log_density(values, geometry)
            .expect("a closed form")
}

#[test]
fn other_forms_of_the_same_distribution_have_the_same_verdict_and_volume() {
    let systems = systems();
    let compared = systems
        .iter()
        .filter(|(scheme, decided)| assert_same_verdict_and_volume(scheme, decided));
    assert_eq!(compared.count(), 15);
}

/// The system in coordinates `Q` with `q_i = Q_i + f(q_(i+1))`. The map is invertible. Coordinates on intervals do not
/// change.
fn bent(scheme: &Scheme) -> Scheme {
    let mut other = scheme.clone();
    let names: Vec<_> = scheme
        .coordinates
        .iter()
        .map(|coordinate| coordinate.0.clone())
        .collect();
    for (i, (name, domain)) in scheme.coordinates.iter().enumerate().rev() {
        if domain.starts_with('(') {
            continue;
        }
        let new = format!("bent_{name}");
        let bend = match scheme.coordinates.get(i + 1) {
            None => String::new(),
            Some((next, domain)) if domain == "R" => format!(" + {next}^2/10 - {next}^3/50"),
            Some((next, _)) => format!(" + sin({next})/10"),
        };
        other.coordinates[i].0.clone_from(&new);
        other.definitions += &format!("let {name} = {new}{bend}; ");
    }
    other.columns = names;
    other
}

#[test]
fn other_coordinates_have_the_same_verdict() {
    for (scheme, decided) in systems() {
        let source = bent(&scheme).declaration();
        let other = Decided::of(&source);
        let (local, known) = (&other.exactness().local, &decided.exactness().local);
        assert_eq!(local.exists, known.exists, "{source}");
        assert_eq!(local.growth, known.growth, "{source}");
        if known.rank == decided.model.coordinates.len() {
            assert_eq!(other.existence(), decided.existence(), "{source}");
        }
    }
}

#[test]
fn the_order_of_coordinates_and_constraints_does_not_matter() {
    for (scheme, decided) in systems() {
        let mut other = scheme.clone();
        for turn in 0..scheme.coordinates.len() {
            other.coordinates.rotate_left(1);
            other.forms.reverse();
            if turn % 2 == 1 {
                let mut swapped = other.clone();
                swapped.coordinates.swap(0, 1);
                let source = swapped.declaration();
                assert_same(&Decided::of(&source), &decided, &source);
            }
            let source = other.declaration();
            assert_same(&Decided::of(&source), &decided, &source);
        }
    }
}

fn assert_same_for_a_thousand_seeds(name: &str, expected: Existence) {
    let source = declaration(&visible_system(name));
    for seed in 0..1000 {
        // Seeds are small or large, because the seeds of builds are hashes.
        let seed = if seed % 2 == 0 {
            seed
        } else {
            seed << 50 | seed
        };
        assert_eq!(
            Decided::with_seed(&source, seed).existence(),
            expected,
            "seed {seed}"
        );
    }
}

#[test]
fn a_thousand_seeds_agree_on_a_density() {
    assert_same_for_a_thousand_seeds("nh_particle", Existence::Global);
}

#[test]
fn a_thousand_seeds_agree_on_an_obstruction() {
    assert_same_for_a_thousand_seeds("chaplygin_sleigh", Existence::None);
}

#[test]
fn a_thousand_seeds_agree_on_a_many_valued_density() {
    assert_same_for_a_thousand_seeds("helical_circle", Existence::Local);
}
