//! A model that is loaded from its text while the program runs, without a compiler. Its results have the same bits as
//! those of `model!`.
//!
//! `cargo run --release -p dalembert-examples --example model_from_text -- oscillator.dal`

use std::error::Error;
use std::{env, fs};

use dalembert::describe::Instance;
use dalembert::erased::Erased;
use dalembert::{Dop853, Scene, Simulation, StateVector, System, Tolerance};

/// The model that is used if no file is given.
const OSCILLATOR: &str = "
    /// Two masses between walls, joined by springs.
    Oscillator {
        coordinates { x; y; }
        parameters { k > 0 = 4; coupling > 0 = 1/2; }
        lagrangian = (dot(x)^2 + dot(y)^2)/2 - k*(x^2 + y^2)/2 - coupling*(x - y)^2/2;
        initial { x = 1; until = 10; }
        claims { conserved: energy; }
    }
";

fn main() -> Result<(), Box<dyn Error>> {
    let (name, text) = match env::args().nth(1) {
        Some(path) => (path.clone(), fs::read_to_string(path)?),
        None => ("oscillator.dal".into(), OSCILLATOR.into()),
    };
    // A refusal shows the source line with a caret under the error.
    let models = match dalembert_jit::load(&name, &text) {
        Ok(models) => models,
        Err(refused) => return Err(refused.to_string().into()),
    };
    for loaded in &models {
        let model = Erased::<32>::of(&loaded.form)?;
        let start = model.initial();
        let state = model.state(0.0, &start.q, &start.qdot)?;
        let integrator = Dop853::new(Tolerance::new(1e-12)?);
        let until = start.until.unwrap_or(10.0);
        let run =
            Simulation::new(&model, integrator, model.effects()).run(0.0, state, until, &mut ())?;
        println!("{}: {} at t = {}", loaded.name, run.outcome, run.t);
        for (index, coordinate) in model.description().coordinates.iter().enumerate() {
            println!(
                "  {} = {}",
                coordinate.name,
                model.position(&run.state).as_slice()[index]
            );
        }
    }
    Ok(())
}
