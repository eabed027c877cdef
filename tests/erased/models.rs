//! The compared models, compiled and loaded from their texts.

use std::sync::{Arc, OnceLock};

use dalembert::declaration::{Described, SceneVisitor};
use dalembert::describe::Description;
use dalembert::erased::Form;
use dalembert::{Lagrangian, Scene, TaylorField};
use dalembert_jit::Loaded;
use dalembert_tests::systems;

dalembert::model! {
    /// A point in a square whose sides are one surface without a power series.
    pub Folded {
        coordinates { x; y; }
        lagrangian = (dot(x)^2 + dot(y)^2)/2;
        impacts { sides: 1 - abs(x) - abs(y) >= 0; }
        initial { x = 0.1; y = 0.2; dot(x) = 1; dot(y) = 0.3; until = 3; }
    }
}

/// A compiled model.
pub struct Compiled {
    /// The description of the model.
    pub description: &'static Description,
    /// The form of the model, named `all`, then those of its scenes by name.
    pub emitted: Vec<(&'static str, &'static Form)>,
    loaded: OnceLock<Loaded>,
}

impl Compiled {
    fn of<M>() -> Self
    where
        M: Described<Global: TaylorField + Lagrangian> + Scene + TaylorField + Lagrangian,
    {
        let mut compiled = Self {
            description: M::DESCRIPTION,
            emitted: Vec::new(),
            loaded: OnceLock::new(),
        };
        compiled.add::<M>("all");
        M::visit_scenes(&mut compiled);
        compiled
    }

    fn add<M: Described>(&mut self, name: &'static str) {
        let form = M::FORM.unwrap_or_else(|| panic!("{} has no form", M::DESCRIPTION.name));
        self.emitted.push((name, form));
    }

    /// The form of a scene, loaded from the text of the model; `scene` is an index of `emitted`.
    pub fn loaded(&self, scene: usize) -> &Arc<Form> {
        let loaded = self.loaded.get_or_init(|| {
            let models = dalembert_jit::load(self.description.name, &self.description.source);
            let models = models.unwrap_or_else(|refused| panic!("{refused}"));
            models.into_iter().next().expect("a model")
        });
        match scene.checked_sub(1) {
            None => &loaded.form,
            Some(scene) => {
                let (name, form) = &loaded.scenes[scene];
                assert_eq!(name, self.emitted[scene + 1].0);
                form
            }
        }
    }
}

impl SceneVisitor for Compiled {
    fn visit<S>(&mut self, name: &'static str)
    where
        S: Described<Global: TaylorField + Lagrangian> + Scene + TaylorField + Lagrangian + 'static,
    {
        self.add::<S>(name);
    }
}

/// The compared models. With the feature `every_model` they are every shipped model, the systems of the tests, and
/// [`Folded`]. Otherwise they are a few models that cover the language, since each is compiled for all number types.
pub fn compared() -> &'static [Compiled] {
    static MODELS: OnceLock<Vec<Compiled>> = OnceLock::new();
    macro_rules! compiled {
        ($package:path: $($model:ident)*) => {{
            use $package as package;
            vec![$(Compiled::of::<package::$model>()),*]
        }};
    }
    MODELS.get_or_init(|| {
        let mut models = compiled! {
            dalembert_models:
            AppellHamel Chain4 ControlledBall RimlessWheelFive RollingDisk TentMap
        };
        models.extend(compiled!(systems: AffineSleigh));
        models.push(Compiled::of::<Folded>());
        #[cfg(feature = "every_model")]
        {
            models.extend(compiled! {
                dalembert_models:
                BallOnRotatingTable BallOnSwitchingTable BouncingBall Chain2 Chain3 Chain8 Chain16 ChaplyginSleigh
                CompassWalker ConstantSpeed DimensionlessWalker DoublePendulum FilippovField HarmonicOscillator HolonomicBeadOnEllipses Mathieu
                MovingWallDisk PointBilliard RefractedParticle RimlessWheelTen RollingBallEuler RollingBallWall
                SmoothAndRoughPlane SpasmodicHamiltonian SphereInPlane SpringMassWalker SuperElasticStrip TwoWheelsArrested
                TwoWheelsRod WalkerFootSlip
            });
            models.extend(compiled! {
                systems:
                DampedSleigh OnePole WalkerWithMultiplier TableWall MagneticDisk IntegrableBead Rheonomic FallingDisk
                MixedDisk NonholonomicParticle HelicalCircle CurvedDual RouthSphere
            });
        }
        models
    })
}
