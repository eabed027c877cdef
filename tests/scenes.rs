//! A scene has the code of a model that declares only the parts that the scene uses.

use std::collections::BTreeMap;

use dalembert::declaration::SceneVisitor;
use dalembert::kernels::Tables;
use dalembert::{
    Described, Divergence, Impacting, Impacts, Lagrangian, Outcome, Projection, Scene, System,
    TaylorField,
};
use dalembert_cli::{Exit, Integrator};
use dalembert_codegen::Compiled;
use dalembert_codegen::program::Program;
use dalembert_codegen::tables::FormOf;
use dalembert_stability::course::Course;
use dalembert_stability::text::{Text, set};
use dalembert_tests::command::dalembert;
use quote::ToTokens;

/// A blade on a tilted plane, without forces and surfaces.
const BLADE: &str = "
    coordinates { x; y; theta: angle; }
    parameters { m > 0 = 1.5; I > 0 = 0.4; a = 0.2; g = 0.7; c >= 0 = 0.3; k >= 0 = 0.1; }
    lagrangian = m/2*(dot(x)^2 + dot(y)^2) + I/2*dot(theta)^2
        + m*a*dot(theta)*(cos(theta)*dot(y) - sin(theta)*dot(x)) + m*g*x;
    constraints { knife: sin(theta)*d(x) - cos(theta)*d(y) = 0; }
    frame { v: cos(theta)*d(x) + sin(theta)*d(y); omega: d(theta); }
    initial { dot(theta) = 1; dot(x) = 0.5; until = 3; }";

/// A model for which no frame is declared or found.
const TWISTED: &str = "
    coordinates { x; y; z; }
    parameters { m > 0 = 1.5; c >= 0 = 0.3; k >= 0 = 0.1; g = 1; }
    lagrangian = m/2*(dot(x)^2 + dot(y)^2 + dot(z)^2) + m*g*x;
    constraints { twist: (y - z)*d(x) + x*d(y) + y*z*d(z) = 0; }
    initial { x = 0.5; y = 0.2; until = 1; }";

const DRAG: &str = "drag: -c*dot(x)*d(x) - c*dot(y)*d(y);";
const DAMPING: &str = "damping: -k*dot(y)*d(y);";
const SIDES: &str = "side[1]: x + 1 >= 0; side[2]: 1 - x >= 0 => restitution(0.5);";
const LID: &str = "lid: 2 - y >= 0 when x > t;";

/// The functions, types and constants of the traits of a type.
type Implemented = BTreeMap<(String, String), String>;

/// Traits of a type with their items, without its kernels and its description.
fn implemented(source: &str, type_name: &str) -> Implemented {
    let tokens = dalembert_emit::try_expand(source.parse().expect("tokens")).expect(source);
    let file: syn::File = syn::parse2(tokens).expect("items");
    let blocks = file.items.iter().filter_map(|item| match item {
        syn::Item::Const(constant) => Some(&*constant.expr),
        _ => None,
    });
    let statements = blocks.flat_map(|block| match block {
        syn::Expr::Block(expression) => expression.block.stmts.as_slice(),
        _ => &[],
    });
    let mut all = Implemented::new();
    for statement in statements {
        let syn::Stmt::Item(syn::Item::Impl(block)) = statement else {
            continue;
        };
        let last = |path: &syn::Path| path.segments.last().expect("a name").ident.to_string();
        let (Some((path, _)), syn::Type::Path(of)) = (&block.trait_, &*block.self_ty) else {
            continue;
        };
        let name = last(path);
        if last(&of.path) == type_name && name != "Documented" {
            let items = block.items.iter().map(|item| {
                let (item, text) = named(item);
                ((name.clone(), item), text)
            });
            let is_code = |item: &str| match name.as_str() {
                // Tables are compared as data.
                "Emitted" => false,
                _ => !item.eq_ignore_ascii_case("kernels"),
            };
            all.extend(items.filter(|((_, item), _)| is_code(item)));
            // A trait without items is listed by its name.
            all.entry((name, String::new())).or_default();
        }
    }
    assert!(!all.is_empty(), "{type_name} of {source}");
    all
}

/// The name of an item of a trait, and its text.
fn named(item: &syn::ImplItem) -> (String, String) {
    let (name, tokens) = match item {
        syn::ImplItem::Fn(item) => (&item.sig.ident, item.block.to_token_stream()),
        syn::ImplItem::Type(item) => (&item.ident, item.ty.to_token_stream()),
        syn::ImplItem::Const(item) => (&item.ident, item.expr.to_token_stream()),
        _ => panic!("an item that is no function, type or constant"),
    };
    (name.to_string(), tokens.to_string())
}

/// The kernels of both forms, as the operations that they consist of.
fn kernels(compiled: &Compiled) -> Vec<String> {
    let programs = &compiled.programs;
    let programs = core::iter::once(&programs.main).chain(&programs.global);
    let kernels = programs.flat_map(Program::kernels);
    kernels
        .map(|(kernel, function)| format!("{kernel:?} {:?} {:?}", function.ops, function.outputs))
        .collect()
}

/// Tables of both forms.
fn tables(compiled: &Compiled) -> Vec<Tables> {
    let forms = FormOf::all(compiled, &[]);
    forms.iter().map(FormOf::tables).collect()
}

/// Asserts that a scene that uses these parts equals the model that declares only them.
fn assert_same(body: &str, [forces, impacts]: [&str; 2], uses: &str) {
    let plain = format!("P {{ {body} forces {{ {forces} }} impacts {{ {impacts} }} }}");
    let all = format!("forces {{ {DRAG} {DAMPING} }} impacts {{ {LID} {SIDES} }}");
    let scene =
        format!("P {{ {body} {all} scenes {{ only: {uses} projection, volume, variations; }} }}");
    let compile =
        |source: &str| dalembert_codegen::compile(source.parse().expect("tokens")).expect(uses);
    let (of_scene, of_plain) = (&compile(&scene).scenes[0], &compile(&plain));
    assert_eq!(kernels(of_scene), kernels(of_plain), "{uses}");
    assert_eq!(tables(of_scene), tables(of_plain), "{uses}");
    let [plain, scene] = [plain, scene].map(|source| match body {
        TWISTED => source,
        _ => format!("#[global] {source}"),
    });
    for [type_name, plain_name] in [["Only", "P"], ["OnlyGlobal", "PGlobal"]] {
        if plain_name == "PGlobal" && body == TWISTED {
            continue;
        }
        // A scene contains the model, so that its parameters have a longer path.
        let found: Implemented = implemented(&scene, type_name)
            .into_iter()
            .filter(|((name, _), _)| name != "InvariantVolume")
            .map(|(name, text)| {
                (
                    name,
                    text.replace("self . 0 .", "self .")
                        .replace("p :: Only", "P"),
                )
            })
            .collect();
        assert_eq!(found, implemented(&plain, plain_name), "{uses}");
    }
}

#[test]
fn a_scene_has_the_code_of_a_model_with_nothing_else() {
    for body in [BLADE, TWISTED] {
        assert_same(body, ["", ""], "");
        assert_same(body, [DRAG, ""], "drag,");
        assert_same(body, ["", SIDES], "side,");
        assert_same(body, [DAMPING, LID], "lid, damping,");
        assert_same(
            body,
            [&format!("{DRAG}{DAMPING}"), SIDES],
            "damping, drag, side[2], side[i in 1..=1],",
        );
    }
}

dalembert::model! {
    /// A point that is thrown, with drag and a motor, between two walls.
    pub Thrown {
        coordinates { x; y; }
        parameters { m > 0 = 2; c >= 0 = 0.5; f = 3; }
        lagrangian = m/2*(dot(x)^2 + dot(y)^2);
        forces { drag: -c*dot(x)*d(x) - c*dot(y)*d(y); motor: f*d(x); }
        impacts { left: x + 1 >= 0; right: 1 - x >= 0 => newton(0.5); }
        scenes {
            /// Straight lines.
            free;
            slowed: drag;
            walls: left, right;
            slowed_right: slowed, right, volume;
        }
        initial { dot(x) = 1; until = 10; }
        claims { not conserved: energy; }
        claims for free { conserved: energy; conserved: dot(x); }
        claims for walls { conserved under left: energy; not conserved under right: energy; }
    }
}

dalembert::model! {
    /// A blade in global form on a line that projection keeps.
    Guided {
        coordinates { x; y; theta: angle; }
        lagrangian = (dot(x)^2 + dot(y)^2 + dot(theta)^2)/2;
        constraints { line: dot(y) = 0; knife: sin(theta)*d(x) - cos(theta)*d(y) = x*d(theta); }
        scenes { bare; kept: projection; }
        initial { dot(x) = 1; theta = 0.3; until = 1; }
    }
}

dalembert::model! {
    /// A disk above a floor on which it does not slip, between two smooth walls.
    Rolled {
        coordinates { x; y; theta; }
        lagrangian = (dot(x)^2 + dot(y)^2 + dot(theta)^2)/2 - y;
        impacts {
            floor: y >= 1 => newton(1/2), instantaneous { roll: dot(x) - dot(theta) = 0; };
            left: x >= 0;
            turned: 9 - x >= 0 => reset { dot(x) = -dot(x); };
        }
        scenes { walls: left, turned; fast: turned; all_but_left: floor, turned; }
        initial { x = 1; y = 2; dot(x) = 1; until = 1; }
    }
}

#[test]
fn a_surface_of_a_scene_has_its_own_functions_at_its_own_place() {
    let whole = Rolled {};
    let state = whole
        .state(0.0, &[1.0, 2.0, 0.0].into(), &[1.0, -1.0, 0.0].into())
        .expect("a state");
    let has = |found: [Option<bool>; 2]| found.map(|found| found.is_some());
    let asked = |system: &dyn Fn(usize) -> [Option<bool>; 2]| [0, 1, 2].map(|s| has(system(s)));
    macro_rules! of {
        ($system:expr) => {
            asked(&|surface| {
                let system = $system;
                let focus = system.focus(surface, 0.0, &state).expect("no fault");
                let reset = system.reset(surface, 0.0, &state).expect("no fault");
                [focus.map(|_| true), reset.map(|_| true)]
            })
        };
    }
    let [rough, smooth, map, none] = [[true, false], [false; 2], [false, true], [false; 2]];
    assert_eq!(of!(whole), [rough, smooth, map]);
    assert_eq!(of!(rolled::Walls(whole)), [smooth, map, none]);
    assert_eq!(of!(rolled::Fast(whole)), [map, none, none]);
    assert_eq!(of!(rolled::AllButLeft(whole)), [rough, map, none]);
    assert_eq!(
        rolled::Walls(whole).gaps(0.0, &state).as_slice(),
        [1.0, 8.0]
    );
}

/// A run of a scene of the loaded [`Thrown`] from its declared start: final `x`, outcome and number of impacts.
fn run(scene: &str, until: f64) -> (f64, Outcome, u64) {
    static THROWN: Text = Text::new(Thrown::DESCRIPTION.source.value());
    let mut thrown = THROWN.scene(scene);
    set(&mut thrown, "f", -1.0);
    let run = Course::declared(&thrown, until).observed(Integrator::Dop853, &mut ());
    (run.state.as_ref()[0], run.outcome, run.counters.impacts)
}

#[test]
fn a_scene_moves_under_what_it_uses() {
    let (x, outcome, impacts) = run("free", 10.0);
    assert_eq!((outcome, impacts), (Outcome::Done, 0));
    assert!((x - 10.0).abs() < 1e-12);
    // The position is m v/c (1 - exp(-c t/m)).
    let (x, _, impacts) = run("slowed", 10.0);
    assert_eq!(impacts, 0);
    assert!((x - 4.0 * (1.0 - (-2.5_f64).exp())).abs() < 1e-11);
    // The left wall is elastic, the right one halves the speed: the impacts are at 1, 1 + 2/0.5 and 5 + 2/0.5.
    let (x, _, impacts) = run("walls", 9.5);
    assert_eq!(impacts, 3);
    assert!((x - 0.875).abs() < 1e-12, "{x}");
    let (_, _, impacts) = run("slowed_right", 10.0);
    assert_eq!(impacts, 1);
}

/// Compiles only if the scene has these effects.
fn has_effects<S: Scene<Effects = Effects>, Effects>(_: &S) {}

#[test]
fn what_a_scene_leaves_out_is_no_part_of_its_effects() {
    let thrown = Thrown::default();
    has_effects::<_, ()>(&thrown::Free(thrown));
    has_effects::<_, (Impacts<thrown::Walls>,)>(&thrown::Walls(thrown));
    let guided = Guided {};
    has_effects::<_, ()>(&guided::Bare(guided));
    has_effects::<_, (Projection<guided::Kept>,)>(&guided::Kept(guided));
    has_effects::<_, (Projection<Guided>,)>(&guided);
}

#[test]
fn densities_are_there_where_they_are_asked_for() {
    let scene = thrown::SlowedRight::default();
    let state = scene
        .state(0.0, &[0.0, 0.0].into(), &[1.0, 0.0].into())
        .expect("a state");
    // The divergence is -2 c/m.
    assert!((scene.divergence(0.0, &state).expect("a divergence") + 0.5).abs() < 1e-15);
    let source = Thrown::DESCRIPTION.source.value();
    let has = |scene: &str| {
        let all = implemented(source, scene);
        all.keys()
            .any(|(name, _)| name == "HasDivergence" || name == "InvariantVolume")
    };
    assert!(has("SlowedRight") && has("Thrown"));
    assert!(!has("Free") && !has("Slowed") && !has("Walls"));
    let wide = source.replace("slowed_right :", "w : volume ; slowed_right :");
    let wide = match wide == source {
        true => source.replace("slowed_right:", "w: volume; slowed_right:"),
        false => wide,
    };
    let all = implemented(&wide, "W");
    assert!(
        all.keys().any(|(name, _)| name == "InvariantVolume"),
        "dx dy dvx dvy"
    );
}

/// Scenes that a model shows.
#[derive(Default)]
struct Shown(Vec<(&'static str, Vec<&'static str>, Vec<&'static str>)>);

impl SceneVisitor for Shown {
    fn visit<S>(&mut self, name: &'static str)
    where
        S: Described<Global: TaylorField + Lagrangian> + Scene + TaylorField + Lagrangian + 'static,
    {
        let surfaces = S::DESCRIPTION.surfaces.iter();
        let surfaces = surfaces.map(|surface| surface.name).collect();
        self.0
            .push((name, S::DESCRIPTION.forces.to_vec(), surfaces));
    }
}

#[test]
fn a_model_shows_its_scenes() {
    let mut shown = Shown::default();
    Thrown::visit_scenes(&mut shown);
    let expected: [(&str, &[&str], &[&str]); 4] = [
        ("free", &[], &[]),
        ("slowed", &["drag"], &[]),
        ("walls", &[], &["left", "right"]),
        ("slowed_right", &["drag"], &["right"]),
    ];
    let shown: Vec<(&str, &[&str], &[&str])> = shown
        .0
        .iter()
        .map(|(name, forces, surfaces)| (*name, forces.as_slice(), surfaces.as_slice()))
        .collect();
    assert_eq!(shown, expected);
    let names = ["all", "free", "slowed", "walls", "slowed_right"];
    assert_eq!(*Thrown::DESCRIPTION.scenes, names);
    assert_eq!(*thrown::Free::DESCRIPTION.scenes, names);
    assert_eq!(thrown::slowed_right::surface::right, 0);
    assert_eq!(thrown::surface::right, 1);
}

#[test]
fn a_claim_about_a_scene_is_examined_there() {
    let refusal = |claims: &str| {
        let source = format!(
            "P {{ coordinates {{ x; }} parameters {{ c > 0; }} lagrangian = dot(x)^2/2;
                forces {{ drag: -c*dot(x)*d(x); }} impacts {{ floor: x >= 0; }}
                scenes {{ free; slowed: drag; floored: floor; }} {claims} }}"
        );
        let refused = dalembert_emit::try_expand(source.parse().expect("tokens"));
        refused.err().map(|errors| {
            let messages = errors.iter().map(|error| error.message().to_owned());
            messages.collect::<Vec<_>>().join("\n")
        })
    };
    let proved = "claims for free { conserved: dot(x); } claims for floored { conserved under floor: energy; }
        claims for slowed { not conserved: energy; } claims { not conserved: energy; }";
    assert_eq!(refusal(proved), None);
    let text =
        refusal("claims for slowed { conserved: energy; } claims for free { density: none; }");
    let text = text.expect("two refusals");
    assert!(text.contains("`conserved: energy` is refuted"), "{text}");
    assert!(text.contains("`density: none` is refuted"), "{text}");
    let text = refusal("claims for slowed { conserved under floor: energy; }").expect("a refusal");
    assert!(
        text.contains("the scene `slowed` does not use the surface `floor`"),
        "{text}"
    );
}

/// Output of a command line, as JSON.
fn printed(line: &str, input: &str) -> serde_json::Value {
    let words: Vec<&str> = line.split_whitespace().collect();
    let done = dalembert(&words, input);
    assert_eq!(done.exit, Exit::Reached, "{line}: {}", done.errors);
    serde_json::from_str(&done.output).expect("JSON")
}

#[test]
fn the_command_line_runs_prints_and_derives_a_scene() {
    let run = printed(
        "simulate rolling_disk --scene free --until 200 --json -",
        "",
    );
    assert_eq!(run["scene"], "free");
    assert_eq!(run["events"], serde_json::json!([]));
    let state = r#"[{"q": [0, 0, 0, 0], "qdot": [0.1, 0, 10, 0.2]}]"#;
    let whole = printed("eval rolling_disk", state);
    let free = printed("eval rolling_disk --scene free", state);
    assert_eq!(free[0]["pdot"], whole[0]["pdot"]);
    for name in [
        "density_form_theta",
        "divergence_mu_C",
        "log_density",
        "mu_C_density_frame",
    ] {
        assert!(!whole[0][name].is_null(), "{name} in {whole}");
        assert!(free[0][name].is_null(), "{name} in {free}");
    }
    assert_eq!(free[0]["impacts"], serde_json::json!({}));
    let whole = printed("derive rolling_disk --format json", "").to_string();
    let free = printed("derive rolling_disk --scene free --format json", "").to_string();
    let mentions = |text: &str, part: &str| text.contains(part);
    assert!(mentions(&whole, "leading_edge") && !mentions(&free, "leading_edge"));
    let checked = printed("check rolling_disk --format json", "");
    assert_eq!(checked["scenes"], serde_json::json!(["all", "free"]));
    let claims = checked["claims"].as_array().expect("claims");
    let of_free = claims.iter().filter(|claim| claim["scene"] == "free");
    let of_free: Vec<_> = of_free.map(|claim| claim["claim"].clone()).collect();
    assert_eq!(of_free, ["conserved: dot(theta)"]);
}
