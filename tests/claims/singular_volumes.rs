//! Volumes `f mu_C` with densities `f = (det m)^k |l|^s` that depend on velocities. Finite differences at states away
//! from `l = 0` show that the motion keeps these volumes.

use dalembert::Described;
use dalembert::math::larger;
use dalembert_codegen::claims::{MomentumDensity, Problem, find_momentum_density};
use dalembert_declarations::visible::declaration;
use dalembert_expr::SymbolId;
use dalembert_models::ChaplyginSleigh;
use dalembert_tests::flow::Flow;
use dalembert_tests::reference::read;
use dalembert_tests::sampling::Random;
use dalembert_tests::volume::{WithVolume, divergence};

/// A system without a density of the configuration, with its density that depends on velocities.
struct Singular {
    system: WithVolume,
    density: MomentumDensity,
}

impl Singular {
    fn of(source: &str) -> Self {
        let mut system = WithVolume::natural(source);
        let problem = Problem::of(&mut system.model, &system.derivation);
        let found = find_momentum_density(
            &mut system.model,
            &system.derivation,
            &problem,
            &system.exactness,
            1,
        );
        let density = found.expect("points").expect("a density");
        Self { system, density }
    }

    fn independent(&self) -> &[usize] {
        let volume = self.system.program.volume.as_ref();
        &volume.expect("functions").independent
    }

    /// `l` at `(q, v_ind)`.
    fn factor(&self, t: f64, at: &[f64]) -> f64 {
        let (q, independent) = at.split_at(self.system.model.coordinates.len());
        let qdot = self.system.velocities(t, q, independent);
        let is = |symbol: SymbolId| move |known: &SymbolId| *known == symbol;
        let velocities: Vec<SymbolId> = self
            .system
            .model
            .coordinates
            .iter()
            .map(|coordinate| coordinate.qdot)
            .collect();
        let value = |symbol| match velocities.iter().position(is(symbol)) {
            Some(i) => qdot[i],
            None => self.system.value(symbol, t, q),
        };
        self.system.model.pool.eval(&[self.density.factor], &value)[0]
    }

    /// `ln f` with exponents multiplied by these factors, plus the logarithm of `mu_C`.
    fn log_volume(&self, t: f64, at: &[f64], [mass, power]: [f64; 2]) -> f64 {
        let q = &at[..self.system.model.coordinates.len()];
        let [_, mass_determinant] = self.system.determinants(t, q);
        self.system.log_volume(t, q)
            + mass * self.density.mass_exponent.to_f64() * mass_determinant.ln()
            + power * self.density.exponent.to_f64() * self.factor(t, at).abs().ln()
    }

    /// The largest divergence at random states away from `l = 0`, relative to its terms, or to 1 if that is larger.
    fn divergence(&self, motion: impl Fn(f64, &[f64]) -> Vec<f64>, exponents: [f64; 2]) -> f64 {
        let mut random = Random::new(23);
        let mut largest = 0.0_f64;
        let mut states = 0;
        while states < 6 {
            let mut at = self.system.configuration(&mut random);
            at.extend(self.independent().iter().map(|_| random.within(-1.0, 1.0)));
            if self.factor(0.0, &at).abs() < 0.3 {
                continue;
            }
            let volume = |t: f64, at: &[f64]| self.log_volume(t, at, exponents);
            let [sum, terms] = divergence(0.0, &at, &motion, volume);
            largest = larger(largest, sum.abs() / terms.max(1.0));
            states += 1;
        }
        largest
    }
}

#[test]
fn singular_volumes_are_kept() {
    let file = read("verdicts_visible");
    let systems = file["systems"].as_array().expect("systems").iter();
    let mut kept = 0;
    for system in systems.filter(|entry| entry.get("momentum_density").is_some()) {
        let singular = Singular::of(&declaration(system));
        let motion = |t: f64, at: &[f64]| singular.system.motion(t, at);
        let divergence = singular.divergence(motion, [1.0, 1.0]);
        println!("{} {divergence:.1e}", system["name"]);
        assert!(divergence < 1e-9, "{}: {divergence:e}", system["name"]);
        let wrong = singular.divergence(motion, [1.0, 2.0]);
        assert!(wrong > 1e-3, "{}: {wrong:e}", system["name"]);
        kept += 1;
    }
    assert!(kept >= 4, "{kept}");
}

#[test]
fn the_shipped_sleigh_keeps_its_singular_volume() {
    let singular = Singular::of(ChaplyginSleigh::DESCRIPTION.source.value());
    let system = ChaplyginSleigh::with_defaults();
    let flow = Flow {
        system: &system,
        independent: singular.independent(),
    };
    let motion = |t: f64, at: &[f64]| flow.motion(t, at);
    let divergence = singular.divergence(motion, [1.0, 1.0]);
    assert!(divergence < 1e-9, "{divergence:e}");
    // mu_C itself is not kept.
    assert!(singular.divergence(motion, [0.0, 0.0]) > 1e-3);
}
