//! Galleries: figures of models on one page, drawn by `dalembert gallery`.
//!
//! Every model has figures of its motion. A [`Catalogue`](crate::Catalogue) may add others, such as those of the papers
//! its models come from: [`Catalogue::with_figures`](crate::Catalogue::with_figures). A picture is specified by flags
//! of `simulate`, `map`, `orbit`, `connect`, `control` or `accuracy`, so that its caption can give the command that
//! draws it.

mod density;
mod manifest;
mod mathematics;
mod page;
mod plate;
mod standard;
mod starts;

pub(crate) use manifest::write as write_manifest;
pub(crate) use page::{escaped, page};
pub(crate) use plate::{Effort, Plate, Print};
pub(crate) use standard::figure as standard_figure;

/// Pictures under one caption.
#[derive(Debug, Clone, PartialEq)]
pub struct Figure {
    /// The name of the model on the command line.
    pub model: &'static str,
    /// A word for the figure; its file names begin with the model and this word.
    pub name: &'static str,
    /// Its title, one line.
    pub title: &'static str,
    /// The heading of its chapter on the page. Chapters come in the order of their first figures.
    pub chapter: &'static str,
    /// The index of the panel that the first row of the page shows, if any.
    pub highlight: Option<usize>,
    /// Its description, with the values that were chosen because the source does not state them. Formulas stand between
    /// dollar signs.
    pub caption: String,
    /// The figure of a source that it reproduces, if any.
    pub source: Option<&'static str>,
    /// Its pictures, in reading order.
    pub panels: Vec<Panel>,
}

/// One picture of a figure.
#[derive(Debug, Clone, PartialEq)]
pub struct Panel {
    /// A word for the picture, which ends its file name; empty if the figure has one picture only.
    pub name: String,
    /// Its title, one line.
    pub title: String,
    /// Its content.
    pub picture: Picture,
}

/// Content of a picture. Flags follow the model's name and lack `--plot`; single quotes enclose a flag with spaces.
#[derive(Debug, Clone, PartialEq)]
pub enum Picture {
    /// The picture that `simulate` draws with these flags.
    Simulate(String),
    /// The picture that `map` draws with these flags; a quick gallery takes an eighth of the values along each axis.
    Map(String),
    /// The picture that `connect` draws with these flags.
    Connect(String),
    /// The picture that `control` draws with these flags; a quick gallery takes an eighth of the values of `--vary`.
    Control(String),
    /// The picture that `orbit --continue` draws with these flags.
    Branch(String),
    /// The picture that `accuracy` draws with these flags; it contains measured times.
    Accuracy(String),
    /// Positions of many runs at the same time.
    Starts(Starts),
    /// Long-run density of a run.
    Density(Density),
}

/// Runs that start near each other. The picture shows their positions in the declared view at one time.
#[derive(Debug, Clone, PartialEq)]
pub struct Starts {
    /// Flags of `simulate`, with `--until` for the time.
    pub flags: String,
    /// Number of runs.
    pub members: u32,
    /// The scattered quantities: name of a coordinate or velocity, central value, and largest deviation.
    pub scatter: Vec<(&'static str, f64, f64)>,
    /// Seed of the random numbers.
    pub seed: u64,
}

/// Density of a run in boxes of the plane of the declared view, from positions at equally spaced times.
#[derive(Debug, Clone, PartialEq)]
pub struct Density {
    /// Flags of `simulate`, without `--until`.
    pub flags: String,
    /// The time between two positions.
    pub every: f64,
    /// Number of counted positions.
    pub positions: u64,
    /// Number of discarded positions before them.
    pub discarded: u64,
    /// Number of boxes along each side of the region.
    pub boxes: usize,
}
