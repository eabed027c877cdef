//! Families of modes and transitions against their members written out.

use dalembert_codegen::compile_modes;
use dalembert_codegen::spec::{Declaration, Modes};
use dalembert_emit::modes;

fn read(source: &str) -> Modes {
    match dalembert_codegen::read(source.parse().unwrap()).unwrap() {
        Declaration::Modes(declared) => declared,
        Declaration::Model(_) => panic!("no modes"),
    }
}

/// The emitted items. The source text is removed first.
fn emitted(source: &str) -> String {
    let mut declared = read(source);
    for mode in &mut declared.modes {
        mode.spec.source.clear();
    }
    modes::tokens(&compile_modes(&declared).unwrap()).to_string()
}

/// A hopper on three legs, with the given modes and transitions.
fn hopper(rest: &str) -> String {
    format!(
        "Hopper {{
            const N = 3;
            coordinates {{ x; y; }}
            parameters {{ l[N] > 0 = 1; k[N] > 0 = [1, 2, 3]; }}
            {rest}
        }}"
    )
}

#[track_caller]
fn same(family: &str, written_out: &str) {
    assert_eq!(emitted(&hopper(family)), emitted(&hopper(written_out)));
}

const WRITTEN_OUT: &str = "
    modes {
        /// On a leg.
        leg1 { lagrangian = (dot(x)^2 + dot(y)^2)/2 - k[1]*y^2; initial { y = 1; until = 2; } }
        /// On a leg.
        leg2 { lagrangian = (dot(x)^2 + dot(y)^2)/2 - k[2]*y^2; }
        /// On a leg.
        leg3 { lagrangian = (dot(x)^2 + dot(y)^2)/2 - k[3]*y^2; }
        /// In the air.
        flight { lagrangian = (dot(x)^2 + dot(y)^2)/2 - y; }
    }
    transitions {
        /// Another leg.
        swap1: leg1 -> leg2 when x >= 1 => reset { y = l[1]/l[2]*y; dot(x) = -1*dot(x); };
        /// Another leg.
        swap2: leg2 -> leg3 when x >= 2 => reset { y = l[2]/l[3]*y; dot(x) = -2*dot(x); };
        /// Another leg.
        swap3: leg3 -> leg1 when x >= 3 => reset { y = l[3]/l[1]*y; dot(x) = -3*dot(x); };
        lift1: leg1 -> flight when y >= l[1];
        lift2: leg2 -> flight when y >= l[2];
        lift3: leg3 -> flight when y >= l[3];
        land: flight -> leg2 when y <= 0;
    }";

#[test]
fn a_family_is_its_members_written_out() {
    let family = "
        modes {
            /// On a leg.
            leg[i in 1..=N] { lagrangian = (dot(x)^2 + dot(y)^2)/2 - k[i]*y^2; }
            leg[1] { initial { y = 1; until = 2; } }
            /// In the air.
            flight { lagrangian = (dot(x)^2 + dot(y)^2)/2 - y; }
        }
        transitions {
            /// Another leg.
            swap[i in 1..=N]: leg[i] -> leg[i%N + 1] when x >= i => reset {
                y = l[i]/l[i%N + 1]*y; dot(x) = -i*dot(x);
            };
            lift[j in 1..=3]: leg[j] -> flight when y >= l[j];
            land: flight -> leg[N - 1] when y <= 0;
        }";
    same(family, WRITTEN_OUT);
}

/// Entries may name single members and overlapping ranges, in any position. Modes are numbered in order of first
/// appearance.
#[test]
fn entries_of_one_member_add_up() {
    let family = "
        transitions {
            /// Another leg.
            swap[1]: leg[1] -> leg[2] when x >= 1 => reset { y = l[1]/l[2]*y; dot(x) = -1*dot(x); };
            /// Another leg.
            swap[i in 2..=N]: leg[i] -> leg[i%3 + 1] when x >= i => reset {
                y = l[i]/l[i%3 + 1]*y; dot(x) = -i*dot(x);
            };
        }
        modes {
            leg[1] { initial { y = 1; until = 2; } }
            leg[i in 2..=N] { let height = k[i]*y^2; }
            /// On a leg.
            leg[i in 1..=N] { lagrangian = (dot(x)^2 + dot(y)^2)/2 - height; }
            leg[N - 2] { let height = k[1]*y^2; }
        }
        modes {
            /// In the air.
            flight { lagrangian = (dot(x)^2 + dot(y)^2)/2 - y; }
        }
        transitions {
            lift[j in 1..=3]: leg[j] -> flight when y >= l[j];
            land: flight -> leg[2] when y <= 0;
        }";
    let declared = read(&hopper(family));
    let names: Vec<&str> = declared
        .modes
        .iter()
        .map(|mode| mode.name.text.as_str())
        .collect();
    assert_eq!(names, ["leg1", "leg2", "leg3", "flight"]);
    same(family, WRITTEN_OUT);
}

/// Inside a mode, other indices and arguments with the name of the family's index shadow it from their declaration on.
#[test]
fn inner_names_hide_the_index() {
    let shell = |modes: &str, from: &str, to: &str| {
        format!(
            "modes {{ {modes} }}
            transitions {{ go: {from} -> {to} when x >= 1; back: {to} -> {from} when x <= -1; }}"
        )
    };
    let family = "
        leg[i in 1..=2] {
            coordinates { q[N]; }
            let square(i) = i^2;
            let partial_sum[i in 1..=i + 1] = sum(j in 1..=i: k[j]);
            let weight = sum(i in i..=i + 1: i*k[i]) + sum(j in i..=2: i*j);
            lagrangian = (dot(x)^2 + dot(y)^2 + sum(i in 1..=N: dot(q[i])^2))/2
                - square(x)*weight - partial_sum[i]*y^2 - sum(i in 1..=i: q[i]);
            constraints { fixed[i in 1..=1]: d(q[1]) = i*d(x); }
            forces { push: -i*d(y); }
            outputs { load[i in 1..=i]: i*x; last: i; }
            initial { q[i in 1..=i + 1] = 0.1*i; dot(q[i in 2..=i + 1]) = i; y = i; }
            claims { not conserved: i*x; }
        }";
    let member = |i: &str, more: &str| {
        format!(
            "leg{i} {{
            coordinates {{ q[N]; }}
            let square(u) = u^2;
            let partial_sum[n in 1..={more}] = sum(j in 1..=n: k[j]);
            let weight = sum(n in {i}..={more}: n*k[n]) + sum(j in {i}..=2: {i}*j);
            lagrangian = (dot(x)^2 + dot(y)^2 + sum(n in 1..=N: dot(q[n])^2))/2
                - square(x)*weight - partial_sum[{i}]*y^2 - sum(n in 1..={i}: q[n]);
            constraints {{ fixed[n in 1..=1]: d(q[1]) = n*d(x); }}
            forces {{ push: -{i}*d(y); }}
            outputs {{ load[n in 1..={i}]: n*x; last: {i}; }}
            initial {{ q[n in 1..={more}] = 0.1*n; dot(q[n in 2..={more}]) = n; y = {i}; }}
            claims {{ not conserved: {i}*x; }}
        }}"
        )
    };
    let written_out = [member("1", "2"), member("2", "3")].concat();
    same(
        &shell(family, "leg[1]", "leg[2]"),
        &shell(&written_out, "leg1", "leg2"),
    );
}
