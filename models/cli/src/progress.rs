//! Progress bars on a terminal.

use std::time::{Duration, Instant};

use indicatif::{ProgressBar, ProgressStyle};

/// Steps between two readings of the clock.
const STRIDE: u32 = 256;

/// Resolution of the bar.
const PARTS: u64 = 1000;

/// Progress bar of a run, shown after one second.
pub struct Progress {
    end: f64,
    steps: u32,
    started: Option<Instant>,
    bar: Option<ProgressBar>,
}

impl Progress {
    /// Progress towards the time `end`; shown only if `terminal`.
    pub fn new(end: f64, terminal: bool) -> Self {
        Self {
            end,
            steps: 0,
            started: terminal.then(Instant::now),
            bar: None,
        }
    }

    /// Notes that the run has reached time `t`.
    pub fn at(&mut self, t: f64) {
        let Some(started) = self.started else { return };
        self.steps = self.steps.wrapping_add(1);
        if !self.steps.is_multiple_of(STRIDE) || started.elapsed() < Duration::from_secs(1) {
            return;
        }
        let bar = self.bar.get_or_insert_with(|| new_bar(PARTS));
        bar.set_position((t / self.end * PARTS as f64) as u64);
        bar.set_message(format!("t = {t:.6} of {}", self.end));
    }

    /// Removes the bar.
    pub fn finish(&mut self) {
        if let Some(bar) = self.bar.take() {
            bar.finish_and_clear();
        }
    }
}

/// Progress bar of a number of tasks; shown from the start, because one task may take long.
pub struct Steps {
    bar: Option<ProgressBar>,
}

impl Steps {
    /// Progress through `count` tasks; shown only if `terminal`.
    pub fn new(count: usize, terminal: bool) -> Self {
        Self {
            bar: terminal.then(|| new_bar(count as u64)),
        }
    }

    /// Notes the start of the next task.
    pub fn begin(&mut self, what: &str) {
        if let Some(bar) = &self.bar {
            bar.set_message(what.to_owned());
            bar.tick();
        }
    }

    /// Completes a task; `write` prints its result on the same terminal.
    pub fn aside<T>(&mut self, write: impl FnOnce() -> T) -> T {
        match &self.bar {
            Some(bar) => {
                let written = bar.suspend(write);
                bar.inc(1);
                written
            }
            None => write(),
        }
    }

    /// Removes the bar.
    pub fn finish(&mut self) {
        if let Some(bar) = self.bar.take() {
            bar.finish_and_clear();
        }
    }
}

/// Progress bar of the members of an ensemble; shown from the start, because one member may take long.
pub struct Count {
    done: u64,
    members: u64,
    started: Instant,
    /// Time from the start to the next change of the message.
    next: Duration,
    bar: Option<ProgressBar>,
}

/// Time between two changes of a bar.
const TICK: Duration = Duration::from_millis(200);

impl Count {
    /// Progress through this number of members; shown only if `terminal`.
    pub fn new(members: u64, terminal: bool) -> Self {
        let bar = terminal.then(|| new_bar(members));
        if let Some(bar) = &bar {
            bar.enable_steady_tick(TICK);
        }
        Self {
            done: 0,
            members,
            started: Instant::now(),
            next: TICK,
            bar,
        }
    }

    /// Completes one more member; `strayed` is the number of members that did not reach their end.
    pub fn done(&mut self, strayed: u64) {
        self.done += 1;
        let Some(bar) = &self.bar else { return };
        let elapsed = self.started.elapsed();
        if elapsed < self.next {
            return;
        }
        self.next = elapsed + TICK;
        bar.set_position(self.done);
        let rate = self.done as f64 / elapsed.as_secs_f64();
        let left = (self.members - self.done) as f64 / rate;
        bar.set_message(format!(
            "{} of {} members, {strayed} did not reach their end, {left:.0} s left",
            self.done, self.members
        ));
    }

    /// Removes the bar.
    pub fn finish(&mut self) {
        if let Some(bar) = self.bar.take() {
            bar.finish_and_clear();
        }
    }
}

/// Progress along a branch of orbits.
pub struct Points {
    made: u64,
    bar: Option<ProgressBar>,
}

impl Points {
    /// Progress; shown only if `terminal`.
    pub fn new(terminal: bool) -> Self {
        let bar = terminal.then(|| new_bar(PARTS));
        if let Some(bar) = &bar {
            bar.enable_steady_tick(TICK);
        }
        Self { made: 0, bar }
    }

    /// Notes a point of the branch: the value of the parameter, and the fraction of the range that lies before it.
    pub fn at(&mut self, name: &str, value: f64, fraction: f64) {
        self.made += 1;
        let Some(bar) = &self.bar else { return };
        bar.set_position((fraction.clamp(0.0, 1.0) * PARTS as f64) as u64);
        bar.set_message(format!("{} points, {name} = {value:.6}", self.made));
    }

    /// Removes the bar.
    pub fn finish(&mut self) {
        if let Some(bar) = self.bar.take() {
            bar.finish_and_clear();
        }
    }
}

/// Progress bar of a search whose number of tasks may change; shown after one second.
pub struct Stages {
    started: Option<Instant>,
    bar: Option<ProgressBar>,
}

impl Stages {
    /// Progress of a search; shown only if `terminal`.
    pub fn new(terminal: bool) -> Self {
        Self {
            started: terminal.then(Instant::now),
            bar: None,
        }
    }

    /// Notes that `done` of `all` tasks are done.
    pub fn at(&mut self, done: usize, all: usize, message: &str) {
        let Some(started) = self.started else { return };
        if started.elapsed() < Duration::from_secs(1) {
            return;
        }
        let bar = self.bar.get_or_insert_with(|| new_bar(all as u64));
        bar.set_length(all as u64);
        bar.set_position(done as u64);
        bar.set_message(message.to_owned());
    }

    /// Removes the bar.
    pub fn finish(&mut self) {
        if let Some(bar) = self.bar.take() {
            bar.finish_and_clear();
        }
    }
}

fn new_bar(parts: u64) -> ProgressBar {
    let bar = ProgressBar::new(parts);
    // The template is a constant. If indicatif refuses it, the default style serves as well.
    if let Ok(style) = ProgressStyle::with_template("[{elapsed}] {bar:40} {percent}% {msg}") {
        bar.set_style(style);
    }
    bar
}
