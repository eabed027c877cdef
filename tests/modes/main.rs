//! Models with modes compared with reference values: changes of constraints, refraction, wheels with many spokes.

mod departures;
mod slides;
mod transitions;

use core::ops::ControlFlow;

use dalembert::declaration::Described;
use dalembert::{
    Event, Impacting, Instance, Observer, Outcome, StateVector, System, TaylorField, VectorField,
};
use dalembert_cli::Integrator;
use dalembert_models::refracted_particle::refracted_particle;
use dalembert_models::two_wheels_arrested::two_wheels_arrested;
use dalembert_models::{
    RefractedParticle, SmoothAndRoughPlane, TwoWheelsArrested,
    smooth_and_rough_plane::smooth_and_rough_plane,
};
use dalembert_stability::course::{Course, Driven, state};
use dalembert_stability::text::{Large, Model, set, shipped, value};
use dalembert_tests::interpreted::compare_motion;
use dalembert_tests::reference::{number, numbers, paired, read};
use serde_json::Value;

/// Events of a run.
struct Events<S>(Vec<Event<S>>);

impl<Sys: System> Observer<Sys> for Events<Sys::State> {
    fn event(&mut self, event: &Event<Sys::State>) -> ControlFlow<()> {
        self.0.push(*event);
        ControlFlow::Continue(())
    }
}

/// A shipped model with values for some of its parameters.
fn large<const K: usize>(name: &str, values: [(&str, f64); K]) -> Large {
    let mut model = shipped(name).sized();
    for (name, value) in values {
        set(&mut model, name, value);
    }
    model
}

/// Runs with `Dop853` and `Taylor`, and asserts that their events agree. Returns the events and end of the first run.
fn run<S: Driven>(
    system: &S,
    q: &[f64],
    qdot: &[f64],
    until: f64,
) -> (Vec<Event<S::State>>, S::State) {
    let state = state(system, q, qdot);
    let made = |integrator| {
        let mut events = Events(Vec::new());
        let end = Course::from_state(system, state, until)
            .tol(1e-13)
            .observed(integrator, &mut events);
        assert_eq!(end.outcome, Outcome::Done);
        (events.0, end.state)
    };
    let (events, end) = made(Integrator::Dop853);
    let (again, _) = made(Integrator::Taylor);
    assert_eq!(events.len(), again.len());
    for (one, other) in events.iter().zip(&again) {
        assert_eq!(one.surface, other.surface);
        assert!((one.t - other.t).abs() < 1e-10 * (1.0 + one.t));
    }
    (events, end)
}

fn close(found: f64, stored: f64, bound: f64, what: &str) {
    let error = (found - stored).abs() / (1.0 + stored.abs());
    assert!(
        error <= bound,
        "{what}: {found} instead of {stored}, relative error {error:e}"
    );
}

/// Rates of the Euler angles (phi, theta, psi) of a ball with these angular velocities, at psi = 0.
fn euler_rates(theta: f64, [x, y, z]: [f64; 3]) -> [f64; 3] {
    let phi = -y / theta.sin();
    [phi, x, z - theta.cos() * phi]
}

/// Velocity of the centre, then angular velocity.
fn speeds<S: Instance>(system: &S, t: f64, state: &S::State) -> [f64; 5] {
    let qdot = system.velocity(t, state).expect("a velocity");
    let qdot = qdot.as_slice();
    let mut spin = [0.0; 3];
    system.outputs(t, state, &mut spin).expect("outputs");
    [qdot[0], qdot[1], spin[0], spin[1], spin[2]]
}

#[test]
fn a_ball_comes_onto_a_rough_plane() {
    let file = read("cortes_vinogradov");
    let cases = file["cv61_smooth_rough"].as_array().expect("cases");
    let ball = large("smooth_and_rough_plane", []);
    let mut reflected = 0;
    for case in cases {
        let velocity = numbers(&case["velocity_smooth"]);
        // At these angles only `phi` changes with this angular velocity; `theta` and `psi` are constant.
        let spin = [velocity[2], velocity[3], velocity[4]];
        let size = spin.iter().map(|rate| rate * rate).sum::<f64>().sqrt();
        let (theta, psi) = ((spin[2] / size).acos(), spin[0].atan2(-spin[1]));
        let q = [number(&case["x0"]), number(&case["y0"]), 0.3, theta, psi];
        let qdot = [velocity[0], velocity[1], size, 0.0, 0.0];
        let until = number(&case["T"]);
        let (events, end) = run(&ball, &q, &qdot, until);
        let is_refracted = case["outcome"] == "refracted";
        assert_eq!(events.len(), if is_refracted { 1 } else { 2 });
        reflected += usize::from(!is_refracted);
        let last = events.last().expect("an event");
        close(last.t, number(&case["t_cross"]), 1e-12, "time");
        close(
            ball.position(&last.after).as_slice()[1],
            number(&case["y_cross"]),
            1e-12,
            "place",
        );
        let after = speeds(&ball, last.t, &last.after);
        for (found, stored) in paired(&after, &case["velocity_after"]) {
            close(found, stored, 1e-12, "velocity");
        }
        let energies = [&events[0].before, &last.after]
            .map(|state| ball.energy(0.0, state).expect("an energy"));
        close(
            energies[0],
            number(&case["energy_before"]),
            1e-12,
            "energy before",
        );
        close(
            energies[1],
            number(&case["energy_after"]),
            1e-12,
            "energy after",
        );
        let place = ball.position(&end);
        for (found, stored) in paired(&place.as_slice()[..2], &case["position_at_T"]) {
            close(found, stored, 1e-11, "end");
        }
        let mode = if is_refracted {
            smooth_and_rough_plane::Mode::Rough
        } else {
            smooth_and_rough_plane::Mode::Smooth
        };
        assert_eq!(ball.mode(&end), mode as usize);
    }
    assert!(reflected > 0);
}

#[test]
fn a_table_switches_its_speed() {
    let file = read("cortes_vinogradov");
    for trajectory in file["cv63_table"]["trajectories"]
        .as_array()
        .expect("trajectories")
    {
        let ball = large("ball_on_switching_table", []);
        let slow = value(&ball, "Om_minus");
        assert_eq!(number(&trajectory["Omega_initial"]), slow);
        let initial = numbers(&trajectory["initial(x,y,vx,vy,wz)"]);
        let (x, y, vx, vy) = (initial[0], initial[1], initial[2], initial[3]);
        let theta = 1.3;
        let spin = [slow * x - vy, vx + slow * y, initial[4]];
        let rates = euler_rates(theta, spin.map(|rate| rate / value(&ball, "r")));
        let rates = [rates[0], rates[1], initial[4] - theta.cos() * rates[0]];
        let switches = trajectory["switches"].as_array().expect("switches");
        let until = number(&switches[switches.len() - 1]["t"]) + 1e-3;
        let q = [x, y, 0.2, theta, 0.0];
        let (events, _) = run(&ball, &q, &[vx, vy, rates[0], rates[1], rates[2]], until);
        assert_eq!(events.len(), switches.len());
        for (event, stored) in events.iter().zip(switches) {
            close(event.t, number(&stored["t"]), 1e-11, "time");
            close(
                ball.position(&event.after).as_slice()[0],
                number(&stored["x"]),
                1e-11,
                "place",
            );
            let sides = [
                ("velocity_minus", &event.before),
                ("velocity_plus", &event.after),
            ];
            for (name, state) in sides {
                let velocities = speeds(&ball, event.t, state);
                for (found, stored) in paired(&velocities, &stored[name]) {
                    close(found, stored, 1e-11, name);
                }
            }
        }
    }
}

#[test]
fn a_rod_is_arrested() {
    let file = read("cortes_vinogradov");
    for case in file["cv64"]["cases"].as_array().expect("cases") {
        let wheels = large("two_wheels_arrested", []);
        let initial = numbers(&case["initial(x1,x2,v1,v2)"]);
        let first = &case["elastic_sequence"][0];
        let q = [initial[0], initial[1], 0.0, 0.0];
        let qdot = [
            initial[2],
            initial[3],
            initial[2] / value(&wheels, "r1"),
            initial[3] / value(&wheels, "r2"),
        ];
        let (events, _) = run(&wheels, &q, &qdot, 10.0);
        assert_eq!(events.len(), 1);
        close(events[0].t, number(&first["t"]), 1e-12, "time");
        let p = wheels.momentum(0.0, &events[0].after).expect("momenta");
        for (found, stored) in paired(p.as_slice(), &first["inelastic_p_plus"]) {
            close(found, stored, 1e-13, "momentum");
        }
        let energy = wheels.energy(0.0, &events[0].after).expect("an energy");
        close(energy, number(&first["energy_inelastic"]), 1e-13, "energy");
    }
}

#[test]
fn light_is_refracted_as_snell_says() {
    let file = read("refraction");
    let cases = file["snell"].as_array().expect("cases");
    let mut reflected = 0;
    for case in cases {
        let values = ["m1", "m2", "V1", "V2"].map(|name| (name, number(&case[name])));
        let particle = shipped("refracted_particle").with(values);
        let (p, m1) = (numbers(&case["p_before"]), value(&particle, "m1"));
        let qdot = [p[0] / m1, p[1] / m1];
        let (events, end) = run(&particle, &[-qdot[0], 0.0], &qdot, 1.5);
        assert_eq!(events.len(), 1);
        let after = particle.momentum(1.5, &end).expect("momenta");
        for (found, stored) in paired(after.as_slice(), &case["p_after"]) {
            close(found, stored, 4e-16, "momentum");
        }
        let is_reflected = case["outcome"] == "total reflection";
        reflected += usize::from(is_reflected);
        assert_eq!(particle.mode(&end), usize::from(!is_reflected));
    }
    assert!(reflected > 0);
}

#[test]
fn a_point_crosses_a_sphere_in_a_plane() {
    let file = read("refraction");
    for case in file["sphere_in_plane"].as_array().expect("cases") {
        let initial = numbers(&case["initial(rho,x,y,px,py)"]);
        let point: Model = shipped("sphere_in_plane").with([("rho", initial[0])]);
        let until = number(&case["t_out"]) + 0.5;
        let (events, _) = run(&point, &initial[1..3], &initial[3..5], until);
        assert_eq!(events.len(), 2);
        let compare = |found: &[f64], name: &str| {
            for (found, stored) in paired(found, &case[name]) {
                close(found, stored, 1e-11, name);
            }
        };
        let momentum = |t: f64, state: &_| point.momentum(t, state).expect("momenta");
        close(events[0].t, number(&case["t_in"]), 1e-12, "t_in");
        compare(point.position(&events[0].after).as_slice(), "q_in");
        compare(momentum(0.0, &events[0].after).as_slice(), "p_in_after");
        let qdot = point.velocity(0.0, &events[0].after).expect("a velocity");
        compare(qdot.as_slice(), "qdot_in_after");
        close(events[1].t, number(&case["t_out"]), 1e-11, "t_out");
        compare(point.position(&events[1].before).as_slice(), "q_out");
        compare(momentum(0.0, &events[1].before).as_slice(), "p_before_exit");
        compare(momentum(0.0, &events[1].after).as_slice(), "p_after_exit");
        for event in &events {
            let energy = |state: &_| point.energy(event.t, state).expect("an energy");
            close(energy(&event.after), energy(&event.before), 1e-15, "energy");
        }
    }
}

/// Compares the steps of one turn on the limit cycle, from the first spoke on, with stored values.
fn check_wheel<S: Driven + Impacting>(wheel: &S, stored: &Value) {
    let cycle = &stored["limit_cycle_xi_true"];
    let steps = cycle["steps"].as_array().expect("steps");
    let first = [
        number(&steps[0]["start_angle"]),
        number(&steps[0]["start_rate"]),
    ];
    let period = number(&cycle["period"]);
    let (events, end) = run(wheel, &first[..1], &first[1..], period * (1.0 + 1e-9));
    assert_eq!(events.len(), steps.len());
    let mut t = 0.0;
    for (n, (event, step)) in events.iter().zip(steps).enumerate() {
        t += number(&step["duration"]);
        close(event.t, t, 1e-11, "time");
        assert_eq!(wheel.mode(&event.before), n);
        let before = [event.before.as_slice()[0], wheel_rate(wheel, &event.before)];
        close(before[0], number(&step["end_angle"]), 1e-11, "angle");
        close(before[1], number(&step["end_rate"]), 1e-11, "rate");
        let next = &steps[(n + 1) % steps.len()];
        close(
            event.after.as_slice()[0],
            number(&next["start_angle"]),
            1e-11,
            "angle after",
        );
        close(
            wheel_rate(wheel, &event.after),
            number(&next["start_rate"]),
            1e-11,
            "rate after",
        );
    }
    assert_eq!(wheel.mode(&end), 0);
}

fn wheel_rate<S: System>(wheel: &S, state: &S::State) -> f64 {
    let qdot = wheel.velocity(0.0, state).expect("a velocity");
    qdot.as_slice()[0]
}

#[test]
fn wheels_of_many_spokes_have_the_stored_limit_cycles() {
    let file = read("rimless_wheels");
    let [five, ten] = ["rimless_wheel_five", "rimless_wheel_ten"].map(|name| large(name, []));
    check_wheel(&five, &file["wheels"][0]);
    check_wheel(&ten, &file["wheels"][1]);
}

/// A motion that starts away from the limit cycle converges to it.
#[test]
fn a_wheel_tends_to_its_limit_cycle() {
    let file = read("rimless_wheels");
    let cycle = &file["wheels"][0]["limit_cycle_xi_true"]["steps"][0];
    let wheel = shipped("rimless_wheel_five").model();
    let start = [number(&cycle["start_angle"]), -0.6];
    let (events, _) = run(&wheel, &start[..1], &start[1..], 60.0);
    let turns: Vec<_> = events
        .iter()
        .filter(|event| wheel.mode(&event.after) == 0)
        .collect();
    assert!(turns.len() >= 3);
    let rate = wheel_rate(&wheel, &turns[2].after);
    close(rate, number(&cycle["start_rate"]), 1e-11, "rate");
    assert_eq!(wheel.state_len(), 3);
}

/// The modes of a model, compiled from its source.
fn compiled<S: Described>() -> Vec<dalembert_codegen::Compiled> {
    let tokens = S::DESCRIPTION.source.parse().expect("tokens");
    let declared = dalembert_codegen::read(tokens).expect("a declaration");
    let dalembert_codegen::spec::Declaration::Modes(declared) = declared else {
        panic!("a model with modes");
    };
    dalembert_codegen::compile_modes(&declared)
        .expect("modes")
        .modes
}

/// Compares the emitted code of a mode with the interpreter of its programs.
fn check_emitted<M: Described<Global: TaylorField> + TaylorField>(
    mode: &dalembert_codegen::Compiled,
) {
    let system = M::with_defaults();
    let global = compare_motion(
        &system.global().expect("the global form"),
        mode.programs.global(),
    );
    assert!(compare_motion(&system, &mode.programs.main) + global > 0);
}

#[test]
fn emitted_code_of_modes_is_what_the_interpreter_executes() {
    let modes = compiled::<SmoothAndRoughPlane>();
    check_emitted::<smooth_and_rough_plane::Smooth>(&modes[0]);
    check_emitted::<smooth_and_rough_plane::Rough>(&modes[1]);
    let modes = compiled::<TwoWheelsArrested>();
    check_emitted::<two_wheels_arrested::Sliding>(&modes[0]);
    check_emitted::<two_wheels_arrested::Arrested>(&modes[1]);
    let modes = compiled::<RefractedParticle>();
    check_emitted::<refracted_particle::Left>(&modes[0]);
    check_emitted::<refracted_particle::Right>(&modes[1]);
}
