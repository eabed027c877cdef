//! Galleries: figures of models as one page, as `dalembert gallery` makes them.
//!
//! Every model has figures of its motion. A [`Catalogue`](crate::Catalogue) may add others, such as those of the papers its
//! models come from: [`Catalogue::with_figures`](crate::Catalogue::with_figures). What a picture shows is said by flags of
//! `simulate` or `accuracy`, so that its caption can name the command that draws it alone.

mod density;
mod manifest;
mod page;
mod plate;
mod standard;
mod starts;

pub(crate) use manifest::write as write_manifest;
pub(crate) use page::page;
pub(crate) use plate::{Effort, Plate, Print};
pub(crate) use standard::figure as standard_figure;

/// Pictures under one caption.
#[derive(Debug, Clone, PartialEq)]
pub struct Figure {
    /// The model, by its name on the command line.
    pub model: &'static str,
    /// A word for it; files are called by the model and this word.
    pub name: &'static str,
    /// What it is, in a line.
    pub title: &'static str,
    /// What it shows, and where that was chosen here because the source does not say.
    pub caption: String,
    /// The figure it reproduces.
    pub source: Option<&'static str>,
    /// Its pictures, in the order of reading.
    pub panels: Vec<Panel>,
}

/// One picture of a figure.
#[derive(Debug, Clone, PartialEq)]
pub struct Panel {
    /// A word for it, which ends the name of its file; empty where it is the only one.
    pub name: String,
    /// What it is, in a line.
    pub title: String,
    /// What it shows.
    pub picture: Picture,
}

/// What a picture shows. Flags are those that follow the model's name, without `--plot`.
#[derive(Debug, Clone, PartialEq)]
pub enum Picture {
    /// What `simulate` draws with these flags.
    Simulate(String),
    /// What `accuracy` draws with these flags: it holds measured times.
    Accuracy(String),
    /// Where many runs are at one time.
    Starts(Starts),
    /// How often a long run is where.
    Density(Density),
}

/// Runs that start near each other, and where the declared view shows them at one time.
#[derive(Debug, Clone, PartialEq)]
pub struct Starts {
    /// Flags of `simulate`, with `--until` for the time.
    pub flags: String,
    /// How many runs.
    pub members: u32,
    /// What is scattered: the name of a coordinate or velocity, the middle, and the largest deviation.
    pub scatter: Vec<(&'static str, f64, f64)>,
    /// Which random numbers.
    pub seed: u64,
}

/// How often a run is in each box of the plane of the declared view, at equally spaced times.
#[derive(Debug, Clone, PartialEq)]
pub struct Density {
    /// Flags of `simulate`, without `--until`.
    pub flags: String,
    /// The time between two positions.
    pub every: f64,
    /// How many positions count.
    pub positions: u64,
    /// How many are left out before.
    pub discarded: u64,
    /// Boxes along each side of the region.
    pub boxes: usize,
}
