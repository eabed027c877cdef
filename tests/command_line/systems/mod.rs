//! The models of the tests: a ball on a floor, an oscillator with a view of the plane, a bead that a constraint holds on a
//! line, and systems with an unsure event search.

mod unsure;

use std::sync::OnceLock;

use dalembert::describe::Description;
use dalembert::erased::Held;
use dalembert_cli::Entry;
use dalembert_driver::{AnyModel, Code, of_form, of_system};
use dalembert_stability::text::Text;

pub use unsure::Unsure;

const BOUNCING_BALL: &str = "
    /// A ball above a floor.
    /// It bounces.
    pub BouncingBall {
        coordinates { x; }
        parameters { m > 0 = 1; g > 0 = 1; }
        lagrangian = m/2*dot(x)^2 - m*g*x;
        impacts { floor: x >= 0; }
        initial { x = 1; dot(x) = 0; }
        claims { conserved: energy; not conserved under floor: dot(x); assume conserved: sin(asin(x)) - x; }
    }";

const OSCILLATOR: &str = "
    /// Two springs of different strength.
    pub Oscillator {
        coordinates { x[2]; }
        parameters { k > 0; }
        lagrangian = (dot(x[1])^2 + dot(x[2])^2)/2 - (x[1]^2 + k*x[2]^2)/2;
        initial { x[1] = 1; x[2] = 0; dot(x[2]) = 1/2; until = 20; }
        outputs { radius: sqrt(x[1]^2 + x[2]^2); }
        view { path: (x[1], x[2]); region: 2 - x[1]^2 - x[2]^2 >= 0; }
    }";

const BEAD: &str = "
    pub Bead {
        coordinates { x; y in (-1, 1); }
        lagrangian = (dot(x)^2 + dot(y)^2)/2;
        constraints { wire: d(y) = d(x); }
        initial { x = 0; y = 0; dot(x) = 1/4; until = 2; }
    }";

/// The models that most tests run.
pub fn entries() -> &'static [Entry] {
    static ENTRIES: OnceLock<Vec<Entry>> = OnceLock::new();
    ENTRIES.get_or_init(|| {
        vec![
            Entry::of_text("bouncing_ball", BOUNCING_BALL),
            Entry::of_text("oscillator", OSCILLATOR),
            Entry::of_text("bead", BEAD),
        ]
    })
}

/// The ball, outside of the command line.
pub fn ball() -> Box<dyn AnyModel> {
    loaded(BOUNCING_BALL)
}

/// The oscillator, outside of the command line.
pub fn oscillator() -> Box<dyn AnyModel> {
    loaded(OSCILLATOR)
}

fn loaded(text: &str) -> Box<dyn AnyModel> {
    let models = dalembert_jit::load("text", text).expect("a model");
    let form = models.into_iter().next().expect("a model").form;
    of_form(form.into(), Code::Loaded).expect("room")
}

/// The oscillator as a system that is made without a text, with an event search that misses impacts.
pub fn made_by_hand() -> Entry {
    static SPRINGS: Text = Text::new(OSCILLATOR);
    fn description() -> &'static Description {
        static DESCRIPTION: OnceLock<Description> = OnceLock::new();
        DESCRIPTION.get_or_init(|| {
            let springs = SPRINGS.description();
            Description {
                type_name: springs.type_name,
                name: springs.name,
                documentation: Held::Static(""),
                source: Held::Static(""),
                is_first_order: false,
                coordinates: Held::Static(&springs.coordinates),
                parameters: Held::Static(&springs.parameters),
                constraints: Held::Static(&[]),
                quasi_velocities: Held::Static(&[]),
                forces: Held::Static(&[]),
                surfaces: Held::Static(&[]),
                outputs: Held::Static(&springs.outputs),
                integrals: Held::Static(&[]),
                scenes: Held::Static(&["all"]),
                modes: Held::Static(&[]),
                view: None,
            }
        })
    }
    Entry::of_system(description(), || {
        of_system(Unsure::of(SPRINGS.large([]), description()))
    })
}

/// The entry of a text with an event search that misses impacts. Its runs fail if a parameter is 13.
// NOTE: the code of a run is compiled once, for the erased system of all texts.
macro_rules! missing {
    ($text:ident) => {
        dalembert_cli::Entry::of_system($text.description(), || {
            let system = $crate::systems::Unsure::of($text.large([]), $text.description());
            dalembert_driver::of_system(system)
        })
    };
}
pub(crate) use missing;
