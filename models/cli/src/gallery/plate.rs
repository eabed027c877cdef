//! One picture of a gallery: its name, its command, and its production.

use std::time::Instant;

use clap::Parser;

use super::{Figure, Panel, Picture, density, starts};
use crate::args::{Command, CommandLine, SimulateArgs};
use crate::command::orbit::branch;
use crate::command::{accuracy, connect, control, map, simulate};
use crate::entry::Entry;
use crate::error::CliError;
use crate::plot::Drawn;

/// Effort spent on pictures that take long.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Effort {
    /// The effort that the captions state.
    Full,
    /// A fiftieth of the positions of densities, an eighth of the values along each axis of `--vary`, and no timed
    /// pictures.
    Quick,
}

/// A picture of a figure that is to be drawn.
#[derive(Debug, Clone, Copy)]
pub struct Plate<'a> {
    /// Its figure.
    pub figure: &'a Figure,
    /// Its panel in the figure.
    pub panel: &'a Panel,
    /// The effort.
    pub effort: Effort,
    /// True if pictures of `simulate` are animated, too.
    pub is_animated: bool,
}

/// A finished picture.
pub struct Print {
    /// The picture.
    pub svg: String,
    /// A page that plays the run of the picture, for a picture of `simulate` in a gallery with animations.
    pub animation: Option<String>,
    /// The outcome of the run, in words.
    pub outcome: String,
    /// Seconds taken to make it.
    pub seconds: f64,
}

impl<'a> Plate<'a> {
    /// All pictures of the figures; timed ones only with full effort.
    pub fn all(figures: &'a [Figure], effort: Effort, is_animated: bool) -> Vec<Self> {
        let plates = figures.iter().flat_map(|figure| {
            figure.panels.iter().map(move |panel| Plate {
                figure,
                panel,
                effort,
                is_animated,
            })
        });
        plates
            .filter(|plate| effort == Effort::Full || !plate.is_timed())
            .collect()
    }

    /// Its name, which is the file name without the extension.
    pub fn name(&self) -> String {
        let Figure { model, name, .. } = self.figure;
        match self.panel.name.as_str() {
            "" => format!("{model}-{name}"),
            panel => format!("{model}-{name}-{panel}"),
        }
    }

    /// Its file name.
    pub fn file(&self) -> String {
        format!("{}.svg", self.name())
    }

    /// The file name of the page that plays its run.
    pub fn animation_file(&self) -> String {
        format!("{}.html", self.name())
    }

    /// True if it shows measured times, so that no other work may run at the same time.
    pub fn is_timed(&self) -> bool {
        matches!(self.panel.picture, Picture::Accuracy(_))
    }

    /// The command that draws this picture, into the current folder.
    pub fn command(&self) -> String {
        match &self.panel.picture {
            Picture::Simulate(flags) => self.drawing("simulate", flags),
            Picture::Accuracy(flags) => self.drawing("accuracy", flags),
            Picture::Connect(flags) => self.drawing("connect", flags),
            Picture::Control(flags) if self.effort == Effort::Full || !flags.contains("--vary") => {
                self.drawing("control", flags)
            }
            Picture::Branch(flags) => self.drawing("orbit", flags),
            Picture::Map(flags) if self.effort == Effort::Full => self.drawing("map", flags),
            Picture::Starts(_) | Picture::Density(_) | Picture::Map(_) | Picture::Control(_) => {
                let quick = match self.effort {
                    Effort::Quick => " --quick",
                    Effort::Full => "",
                };
                format!("dalembert gallery . --picture {}{quick}", self.name())
            }
        }
    }

    fn drawing(&self, command: &str, flags: &str) -> String {
        let words = ["dalembert", command, self.figure.model, flags, "--plot"];
        let given = words.into_iter().filter(|word| !word.is_empty());
        let mut words: Vec<&str> = given.collect();
        let file = self.file();
        words.push(&file);
        words.join(" ")
    }

    /// Makes the picture.
    ///
    /// # Errors
    /// Flags that are not accepted, a state that is refused, a picture that cannot be drawn.
    pub fn make(&self, models: &[Entry]) -> Result<Print, CliError> {
        let started = Instant::now();
        let Drawn { svg, outcome } = self.draw(models)?;
        Ok(Print {
            svg,
            animation: self.animation(models)?,
            outcome,
            seconds: started.elapsed().as_secs_f64(),
        })
    }

    fn animation(&self, models: &[Entry]) -> Result<Option<String>, CliError> {
        if !self.is_animated || !matches!(self.panel.picture, Picture::Simulate(_)) {
            return Ok(None);
        }
        let args = self.simulate(&self.command())?;
        simulate::play(models, &args).map(Some)
    }

    fn draw(&self, models: &[Entry]) -> Result<Drawn, CliError> {
        match &self.panel.picture {
            Picture::Simulate(_) => simulate::draw(models, &*self.simulate(&self.command())?),
            Picture::Accuracy(_) => match self.parse(&self.command())? {
                Command::Accuracy(args) => accuracy::draw(models, &args),
                _ => Err(self.refusal("no `accuracy`")),
            },
            Picture::Branch(_) => match self.parse(&self.command())? {
                Command::Orbit(args) => branch::draw(models, &args),
                _ => Err(self.refusal("no `orbit`")),
            },
            Picture::Connect(_) => match self.parse(&self.command())? {
                Command::Connect(args) => connect::draw(models, &args),
                _ => Err(self.refusal("no `connect`")),
            },
            Picture::Control(flags) => match self.parse(&self.drawing("control", flags))? {
                Command::Control(mut args) => {
                    if self.effort == Effort::Quick {
                        args.vary.iter_mut().for_each(|axis| *axis = coarser(axis));
                    }
                    control::draw(models, &args)
                }
                _ => Err(self.refusal("no `control`")),
            },
            Picture::Map(flags) => match self.parse(&self.drawing("map", flags))? {
                Command::Map(mut args) => {
                    if self.effort == Effort::Quick {
                        args.vary.iter_mut().for_each(|axis| *axis = coarser(axis));
                    }
                    map::draw(models, &args)
                }
                _ => Err(self.refusal("no `map`")),
            },
            Picture::Starts(it) => {
                let args = self.simulate(&self.drawing("simulate", &it.flags))?;
                starts::draw(models, &args, it, &self.panel.title)
            }
            Picture::Density(it) => {
                let it = match self.effort {
                    Effort::Full => it.clone(),
                    Effort::Quick => it.quick(),
                };
                let flags = format!("{} --until {}", it.flags, it.until());
                let args = self.simulate(&self.drawing("simulate", &flags))?;
                density::draw(models, &args, &it, &self.panel.title)
            }
        }
    }

    fn simulate(&self, line: &str) -> Result<Box<SimulateArgs>, CliError> {
        match self.parse(line)? {
            Command::Simulate(args) => Ok(args),
            _ => Err(self.refusal("no `simulate`")),
        }
    }

    fn parse(&self, line: &str) -> Result<Command, CliError> {
        let parsed = CommandLine::try_parse_from(words(line));
        match parsed {
            Ok(line) => Ok(line.command),
            Err(error) => Err(self.refusal(&error.to_string())),
        }
    }

    fn refusal(&self, reason: &str) -> CliError {
        CliError::Input {
            place: format!("picture `{}`", self.name()),
            reason: reason.to_owned(),
        }
    }
}

/// An axis `NAME=A..B:COUNT` with an eighth of its values.
fn coarser(axis: &str) -> String {
    let parts = axis.rsplit_once(':');
    let counted = parts.and_then(|(range, count)| Some((range, count.parse::<u64>().ok()?)));
    match counted {
        Some((range, count)) => format!("{range}:{}", (count / 8).max(2)),
        None => axis.to_owned(),
    }
}

/// Splits a command line into words; single quotes enclose a word with spaces.
fn words(line: &str) -> Vec<String> {
    let mut words = Vec::new();
    for (index, part) in line.split('\'').enumerate() {
        match index % 2 {
            0 => words.extend(part.split_whitespace().map(str::to_owned)),
            _ => words.push(part.to_owned()),
        }
    }
    words
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn quoted_words_stay_together() {
        assert_eq!(
            words("map a --fail 'x > 1' --plot b"),
            ["map", "a", "--fail", "x > 1", "--plot", "b"]
        );
        assert_eq!(words("  simulate  a "), ["simulate", "a"]);
    }

    #[test]
    fn quick_axes_have_an_eighth_of_the_values() {
        assert_eq!(coarser("xi=-3..1:400"), "xi=-3..1:50");
        assert_eq!(coarser("xi=-3..1:4"), "xi=-3..1:2");
        assert_eq!(coarser("xi=1,2"), "xi=1,2");
    }
}
