//! The declarations of the shipped models, as texts of the language.

#![forbid(unsafe_code)]

/// Calls a macro with every shipped model: its name, and its type in `dalembert-models`.
#[macro_export]
macro_rules! shipped {
    ($with:path) => {
        $with! {
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
            compass_walker: CompassWalker,
            constant_speed: ConstantSpeed,
            controlled_ball: ControlledBall,
            dimensionless_walker: DimensionlessWalker,
            double_pendulum: DoublePendulum,
            filippov_field: FilippovField,
            harmonic_oscillator: HarmonicOscillator,
            holonomic_bead_on_ellipses: HolonomicBeadOnEllipses,
            mathieu: Mathieu,
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
    };
}

/// The list of names and texts.
macro_rules! texts {
    ($($name:ident: $model:ident,)*) => {
        /// The shipped models: name and text.
        pub const TEXTS: &[(&str, &str)] = &[$((
            stringify!($name),
            include_str!(concat!("../../src/", stringify!($name), ".dal")),
        )),*];
    };
}

shipped!(texts);
