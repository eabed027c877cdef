//! Three squares that are crossed from left to right, and whose first return map is the tent map: a system of three modes
//! whose every motion is trivial, and chaos.
//!
//! Fact: the square `first` is entered at heights `y, T(y), T(T(y)), ..`, `T` the tent map. Source: W. Clark, thesis, Example IV.28.

dalembert::model_file!("src/tent_map.dal");

#[cfg(test)]
mod tests {
    use super::*;
    use dalembert::{Dop853, EventLog, Outcome, Scene, Simulation, System, Tolerance};

    /// Doubling is exact in binary: motions come to 1/2, from there to 1 and to 0, where they stay.
    #[test]
    fn heights_of_one_half_stay_in_the_squares() {
        let squares = TentMap::default();
        let stepper = Dop853::new(Tolerance::new(1e-10).unwrap());
        let state = squares
            .state(0.0, &[0.0, 0.125].into(), &[0.0; 2].into())
            .unwrap();
        let run = Simulation::new(&squares, stepper, squares.effects())
            .run(0.0, state, 40.5, &mut ())
            .unwrap();
        assert_eq!(run.outcome, Outcome::Done);
        assert!(run.state[0] <= 1.0, "{:?}", run.state);
        assert_eq!(run.state[1], 0.0);
    }

    #[test]
    fn the_return_map_is_the_tent_map() {
        let squares = TentMap::default();
        let stepper = Dop853::new(Tolerance::new(1e-10).unwrap());
        let mut y = 0.34;
        let state = squares
            .state(0.0, &[0.0, y].into(), &[0.0; 2].into())
            .unwrap();
        let mut log = EventLog::<_, 40>::new();
        let run = Simulation::new(&squares, stepper, squares.effects())
            .run(0.0, state, 40.5, &mut log)
            .unwrap();
        assert_eq!(run.outcome, Outcome::Done);
        for pair in log.iter().collect::<Vec<_>>().chunks(2) {
            y = if y <= 0.5 { 2.0 * y } else { 2.0 * (1.0 - y) };
            assert_eq!(pair[1].after[1], y);
            assert_eq!(squares.mode(&pair[1].after), tent_map::Mode::First as usize);
        }
    }
}
