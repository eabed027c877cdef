//! The shipped models as texts, for the `dalembert` command, and the [`figures`] of the papers that they come from.
//!
//! No model is compiled: a command loads the text of the model that it names. With the feature `inlined` the models are compiled, and their
//! functions inlined into the code that runs them.

pub mod figures;

use std::sync::OnceLock;

use dalembert_cli::{Catalogue, Entry};

/// Every shipped model: its name, and its type in `dalembert-models`.
macro_rules! shipped {
    ($($name:ident: $model:ident,)*) => {
        /// The shipped models: name and text.
        pub const TEXTS: &[(&str, &str)] = &[$((
            stringify!($name),
            include_str!(concat!("../../src/", stringify!($name), ".dal")),
        )),*];

        #[cfg(feature = "inlined")]
        fn entries() -> Vec<Entry> {
            dalembert_cli::models![$(dalembert_models::$model),*]
        }
    };
}

shipped! {
    appell_hamel: AppellHamel,
    ball_on_rotating_table: BallOnRotatingTable,
    ball_on_switching_table: BallOnSwitchingTable,
    bouncing_ball: BouncingBall,
    chain2: Chain2,
    chain3: Chain3,
    chain4: Chain4,
    chain8: Chain8,
    chain16: Chain16,
    chaplygin_sleigh: ChaplyginSleigh,
    constant_speed: ConstantSpeed,
    dimensionless_walker: DimensionlessWalker,
    double_pendulum: DoublePendulum,
    filippov_field: FilippovField,
    harmonic_oscillator: HarmonicOscillator,
    holonomic_bead_on_ellipses: HolonomicBeadOnEllipses,
    moving_wall_disk: MovingWallDisk,
    point_billiard: PointBilliard,
    refracted_particle: RefractedParticle,
    rimless_wheel_five: RimlessWheelFive,
    rimless_wheel_ten: RimlessWheelTen,
    rolling_ball_euler: RollingBallEuler,
    rolling_ball_wall: RollingBallWall,
    rolling_disk: RollingDisk,
    smooth_and_rough_plane: SmoothAndRoughPlane,
    spasmodic_hamiltonian: SpasmodicHamiltonian,
    sphere_in_plane: SphereInPlane,
    spring_mass_walker: SpringMassWalker,
    super_elastic_strip: SuperElasticStrip,
    tent_map: TentMap,
    two_wheels_arrested: TwoWheelsArrested,
    two_wheels_rod: TwoWheelsRod,
    walker_foot_slip: WalkerFootSlip,
}

#[cfg(not(feature = "inlined"))]
fn entries() -> Vec<Entry> {
    let texts = TEXTS.iter();
    texts
        .map(|(name, text)| Entry::of_text(name, text))
        .collect()
}

/// Every shipped model, for the command line. A text is loaded once in a process.
pub fn all() -> Vec<Entry> {
    static MODELS: OnceLock<Vec<Entry>> = OnceLock::new();
    MODELS.get_or_init(entries).clone()
}

/// The catalogue of the `dalembert` command: every shipped model, and the figures of the papers.
pub fn catalogue() -> Catalogue {
    Catalogue::of(all()).with_figures(figures::all())
}
