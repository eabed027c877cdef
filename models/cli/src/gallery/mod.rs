//! Galleries: figures of models on one page, as made by `dalembert gallery`.
//!
//! Every model has figures of its motion. A [`Catalogue`](crate::Catalogue) may add others, such as those of the papers
//! its models come from: [`Catalogue::with_figures`](crate::Catalogue::with_figures). A picture is specified by flags
//! of `simulate`, `map`, `orbit`, `connect`, `control` or `accuracy`, so that its caption can give the command that draws it.

mod density;
mod manifest;
mod mathematics;
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
    /// A word for the figure; file names consist of the model and this word.
    pub name: &'static str,
    /// Its title, one line.
    pub title: &'static str,
    /// The heading of the page that it stands under. Headings come in the order of their first figures.
    pub chapter: &'static str,
    /// The panel that is shown in the first row of the page, if one is.
    pub highlight: Option<usize>,
    /// Its content, with values chosen here because the source does not state them. Formulas stand between dollar signs.
    pub caption: String,
    /// The reproduced figure.
    pub source: Option<&'static str>,
    /// Its pictures, in reading order.
    pub panels: Vec<Panel>,
}

/// One picture of a figure.
#[derive(Debug, Clone, PartialEq)]
pub struct Panel {
    /// A word for the picture, which ends its file name; empty for an only picture.
    pub name: String,
    /// Its title, one line.
    pub title: String,
    /// Its content.
    pub picture: Picture,
}

/// Content of a picture. Flags follow the model's name, without `--plot`; single quotes hold a flag with spaces together.
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
    /// Positions of many runs at one time.
    Starts(Starts),
    /// Long-run density of a run.
    Density(Density),
}

/// Runs that start near each other, with their positions in the declared view at one time.
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
