//! Cost of expansion: time per model, time of verdicts on densities, and growth with the N-link chain.
//!
//! The bounds are those of a user's build. Cargo builds procedural macros without optimisation in every profile; each
//! model must then expand in under a second. With optimisation it must expand in under 50 ms. Times are the shortest of
//! several. On a slow machine the bound is relative to the time of reading the generated text as tokens.

use std::sync::Mutex;
use std::time::Duration;

use dalembert_codegen::claims::{Exactness, Problem, Undecided, decide};
use dalembert_codegen::spec::Declaration;
use dalembert_codegen::{mechanics, model, program, read, spec};
use dalembert_declarations::bodies::{ball, train};
use dalembert_declarations::visible::{declaration, visible_systems};
use dalembert_emit::try_expand;
use dalembert_texts::TEXTS;
use proc_macro2::{Delimiter, Group, TokenStream, TokenTree};

/// Serialises the measurements, since the tests of one file run in parallel.
static ALONE: Mutex<()> = Mutex::new(());

/// The shortest times of several expansions.
struct Expansion {
    time: Duration,
    /// The smallest ratio of the time to the time of reading the generated code, both measured one after the other.
    to_reading: f64,
    /// Characters of the generated code.
    length: usize,
}

/// On a slow machine, largest ratio of the time of an expansion to that of reading the generated code. The chain of 16
/// links has a ratio of up to 2.74, depending on the load of the machine.
const READINGS: f64 = 3.0;
/// On a slow machine, largest ratio of the time of a model's claims to that of an expansion without them.
const EXPANSIONS: u32 = 10;
/// Number of measurements of a time that is compared with others.
const MEASUREMENTS: usize = 5;
/// A time that is measured once.
const LONG: Duration = Duration::from_millis(100);
/// Number of measurements after which a time that is over its bound is believed. Other programs slow down the memory
/// for seconds.
const PATIENCE: usize = 30;

impl Expansion {
    /// Measures one expansion.
    fn of(source: &str) -> Self {
        let _alone = ALONE.lock();
        let tokens = source.parse().expect("tokens");
        let (time, items) = timed(|| try_expand(tokens).expect("a model"));
        let text = items.to_string();
        let (reading, read) = timed(|| text.parse::<TokenStream>());
        assert!(read.is_ok());
        Self {
            time,
            to_reading: time.as_secs_f64() / reading.as_secs_f64(),
            length: text.len(),
        }
    }

    /// The same with one more measurement.
    fn again(self, source: &str) -> Self {
        let other = Self::of(source);
        Self {
            time: self.time.min(other.time),
            to_reading: self.to_reading.min(other.to_reading),
            length: self.length,
        }
    }
}

/// The shortest of several times; one time if it is long, since other programs change it less.
fn expansion(source: &str) -> Expansion {
    let first = Expansion::of(source);
    if first.time > LONG {
        return first;
    }
    (1..MEASUREMENTS).fold(first, |found, _| found.again(source))
}

/// The processor time of `work`, and its result. Other programs do not count.
fn timed<T>(work: impl FnOnce() -> T) -> (Duration, T) {
    let start = on_processor();
    let result = work();
    (on_processor() - start, result)
}

/// The time that this thread has spent on a processor.
#[cfg(target_os = "linux")]
fn on_processor() -> Duration {
    use rustix::time::{ClockId, clock_gettime};
    let now = clock_gettime(ClockId::ThreadCPUTime);
    Duration::new(now.tv_sec.unsigned_abs(), now.tv_nsec as u32)
}

/// Wall-clock time.
#[cfg(not(target_os = "linux"))]
fn on_processor() -> Duration {
    static START: std::sync::LazyLock<std::time::Instant> =
        std::sync::LazyLock::new(std::time::Instant::now);
    START.elapsed()
}

/// The declaration without its claims.
fn without_claims(source: &str) -> String {
    let tokens: TokenStream = source.parse().expect("tokens");
    let TokenTree::Group(body) = tokens.clone().into_iter().last().expect("a body") else {
        panic!("a declaration ends with its body");
    };
    let mut kept = Vec::new();
    let mut entries = body.stream().into_iter();
    while let Some(token) = entries.next() {
        if matches!(&token, TokenTree::Ident(word) if word == "claims") {
            // Skips the claims of the model or of a scene up to their braces.
            entries.find(|token| matches!(token, TokenTree::Group(_)));
        } else {
            kept.push(token);
        }
    }
    let body = Group::new(Delimiter::Brace, kept.into_iter().collect());
    let mut all: Vec<TokenTree> = tokens.into_iter().collect();
    all.pop();
    all.push(body.into());
    all.into_iter().collect::<TokenStream>().to_string()
}

/// A bound in milliseconds, with and without optimisation.
fn milliseconds(optimised: u64, unoptimised: u64) -> Duration {
    Duration::from_millis(if cfg!(debug_assertions) {
        unoptimised
    } else {
        optimised
    })
}

/// The declaration of a shipped model.
fn shipped(name: &str) -> &'static str {
    let (_, text) = TEXTS.iter().find(|(known, _)| *known == name).expect(name);
    text
}

fn assert_expands_in_time(name: &str, source: &str, coordinates: usize) {
    let without = without_claims(source);
    let (mut bare, mut whole) = (Expansion::of(&without), Expansion::of(source));
    for _ in 1..PATIENCE {
        if over_its_bound(&bare, &whole, coordinates).is_none() {
            break;
        }
        bare = bare.again(&without);
        whole = whole.again(source);
    }
    println!(
        "{name:28} {:8.1} ms {:8} characters, claims {:8.1} ms",
        bare.time.as_secs_f64() * 1e3,
        bare.length,
        whole.time.saturating_sub(bare.time).as_secs_f64() * 1e3,
    );
    if let Some(late) = over_its_bound(&bare, &whole, coordinates) {
        panic!("{name}: {late}");
    }
}

/// Description of a time over its bound, given the expansions without and with claims; `None` if there is none.
fn over_its_bound(bare: &Expansion, whole: &Expansion, coordinates: usize) -> Option<String> {
    let Expansion {
        time, to_reading, ..
    } = bare;
    if *time >= milliseconds(50, 1000) && *to_reading >= READINGS {
        return Some(format!(
            "{time:?}, {to_reading:.2} times as long as reading it"
        ));
    }
    let claims = whole.time.saturating_sub(*time);
    let is_late = claims >= milliseconds(100, 1500) && claims >= EXPANSIONS * *time;
    (coordinates <= 6 && is_late).then(|| format!("claims {claims:?}"))
}

#[test]
fn every_model_expands_in_time() {
    let mut count = 0;
    for (name, source) in TEXTS {
        let Declaration::Model(spec) = read(source.parse().expect("tokens")).expect(name) else {
            continue;
        };
        let model = model::check(&spec).expect(name);
        if !model.is_first_order() {
            assert_expands_in_time(name, source, model.coordinates.len());
            count += 1;
        }
    }
    assert!(count > 20, "{count} models");
}

/// The shortest of three times for a verdict, and the verdict.
fn verdict(source: &str) -> (Duration, Result<Exactness, Undecided>) {
    let _alone = ALONE.lock();
    let spec = spec::parse(source.parse().expect("tokens")).expect("a declaration");
    let mut model = model::check(&spec).expect("a model");
    let derivation = mechanics::derive(&mut model);
    let problem = Problem::of(&mut model, &derivation);
    let (times, verdicts): (Vec<_>, Vec<_>) = (0..3)
        .map(|_| timed(|| decide(&mut model, &problem, 1)))
        .unzip();
    let verdict = verdicts.into_iter().next().expect("a verdict");
    (times.into_iter().min().expect("a time"), verdict)
}

#[test]
fn verdicts_on_up_to_six_coordinates_are_reached_in_time() {
    let mut sources: Vec<_> = visible_systems().iter().map(declaration).collect();
    let triaxial = "A*b1^2 + B*b2^2 + C*b3^2";
    sources.push(ball("l, 0, k", triaxial, ""));
    sources.push(ball("l, 0, k", triaxial, "rubber: s3 = 0;"));
    sources.push(ball("0, 0, l", "A*(b1^2 + b2^2) + C*b3^2", ""));
    sources.extend((1..=3).map(train));
    for source in sources {
        let (time, verdict) = verdict(&source);
        println!("{:8.1} ms  {source}", time.as_secs_f64() * 1e3);
        assert!(verdict.is_ok(), "{source}: {verdict:?}");
        assert!(time < milliseconds(100, 1500), "{source}: {time:?}");
    }
}

/// Six constraints on eight coordinates need brackets of depth seven.
#[test]
fn a_train_of_five_is_decided_or_says_how_far_it_was_followed() {
    let (time, verdict) = verdict(&train(5));
    println!("{:8.1} ms", time.as_secs_f64() * 1e3);
    match verdict {
        Ok(verdict) => assert!(!verdict.local.exists),
        Err(undecided) => assert!(matches!(undecided, Undecided::Depth(5..)), "{undecided}"),
    }
    assert!(time < milliseconds(1000, 7000), "{time:?}");
}

/// Bounds the time of claims that a density exists or that none does, for bodies with five coordinates and a train of
/// five. The time includes the search for conditions on parameters.
#[test]
fn claims_of_bodies_and_trains_are_examined_in_time() {
    let triaxial = "A*b1^2 + B*b2^2 + C*b3^2";
    let bodies = [
        (ball("l, 0, k", triaxial, ""), "none", (1000, 4000)),
        (
            ball("l, 0, k", triaxial, "rubber: s3 = 0;"),
            "none",
            (1000, 4000),
        ),
        (
            ball("0, 0, l", "A*(b1^2 + b2^2) + C*b3^2", ""),
            "exact",
            (1000, 4000),
        ),
        (train(5), "none", (2000, 9000)),
    ];
    for (source, claim, (optimised, unoptimised)) in bodies {
        let (declarations, end) = source.split_at(source.rfind('}').expect("an end"));
        let source = format!("{declarations} claims {{ density: {claim}; }} {end}");
        let time = expansion(&source).time;
        println!("{:8.1} ms  {source}", time.as_secs_f64() * 1e3);
        assert!(
            time < milliseconds(optimised, unoptimised),
            "{source}: {time:?}"
        );
    }
}

/// Number of operations of the rate.
fn operations(source: &str) -> usize {
    let spec = spec::parse(source.parse().expect("tokens")).expect("a declaration");
    let mut model = model::check(&spec).expect("a model");
    let derivation = mechanics::derive(&mut model);
    program::lower(&model, &derivation, None)
        .main
        .rate
        .cost
        .total()
}

#[test]
fn the_chain_grows_with_the_number_of_its_links() {
    let sources = [
        (2.0_f64, shipped("chain2")),
        (4.0, shipped("chain4")),
        (8.0, shipped("chain8")),
        (16.0, shipped("chain16")),
    ];
    let mut table = Vec::new();
    for (n, source) in sources {
        let Expansion { time, length, .. } = expansion(source);
        let operations = operations(source);
        println!(
            "N = {n:2}: {operations:6} operations, {:8.1} ms, {length} characters",
            time.as_secs_f64() * 1e3
        );
        table.push((n, operations as f64, time.as_secs_f64()));
    }
    let power = |value: fn(&(f64, f64, f64)) -> f64| {
        let (first, last) = (&table[1], &table[3]);
        (value(last) / value(first)).ln() / (last.0 / first.0).ln()
    };
    let (work, time) = (power(|row| row.1), power(|row| row.2));
    println!("fitted between N = 4 and 16: operations ~ N^{work:.2}, expansion time ~ N^{time:.2}");
    assert!(work <= 1.2, "operations grow like N^{work}");
    assert!(time <= 3.3, "expansion time grows like N^{time}");
}

#[test]
fn a_model_that_is_too_large_is_refused_with_its_size() {
    let source = shipped("chain16");
    let longer = source.replace("16", "48");
    // The metric is factorised where rates are enclosed along each step.
    let larger = longer.replace("m*g*Y[i])", "m*g*Y[i]) - sqrt(1 + X[N]^2)");
    assert_ne!(larger, longer);
    let _alone = ALONE.lock();
    let refused = try_expand(larger.parse().expect("tokens")).expect_err("48 links");
    let message = refused.iter().next().expect("a message").message();
    assert!(
        message.contains("operations; the limit is 50000"),
        "{message}"
    );
    assert!(try_expand(longer.parse().expect("tokens")).is_ok());
}
