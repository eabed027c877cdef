//! A page that plays a run: the path in the plane of the declared view, the quantities of `--axes`, or all coordinates
//! against time. The motion is drawn up to the time of the slider, with impacts and walls.

use dalembert_driver::{padded, player};
use serde_json::{Value, json};

use super::Picture;
use super::contour::{Contour, Window};
use super::portrait;
use super::region::{COARSE, FINE, Region};
use super::trace::{Mark, Source};
use crate::gallery::escaped;
use crate::{names, symbols};

/// Frames in a second.
const FPS: f64 = 30.0;

/// Number of points of a path beyond which points between impacts are left out.
const MANY: usize = 4000;

/// Width of the plot within the canvas, and height of the canvas around the plot, in pixels, as in the script of the
/// page.
const WIDTH: f64 = 572.0;
const AROUND: f64 = 62.0;

/// Least height of a plot, in pixels.
const LEAST: f64 = 200.0;

/// A component of a curve.
#[derive(Clone, Copy)]
enum Component {
    Time,
    /// The entry of this index among the values of a mark.
    Entry(usize),
}

impl Component {
    fn of(self, t: f64, values: &[f64]) -> f64 {
        match self {
            Self::Time => t,
            Self::Entry(index) => values.get(index).copied().unwrap_or(f64::NAN),
        }
    }
}

/// A curve of the page: its label, its abscissa and its ordinate.
type Curve = (String, [Component; 2]);

/// The page. `duration` is the time from the first to the last frame at full speed, in seconds.
pub fn page(picture: &Picture<'_>, duration: f64) -> String {
    let title = escaped(&picture.title);
    format!(
        "<!DOCTYPE html>\n<html lang=\"en\"><head><meta charset=\"utf-8\" />\
         <meta name=\"viewport\" content=\"width=device-width, initial-scale=1\" /><title>{title}</title></head>\n\
         <body style=\"font:15px sans-serif\">\n{}\n<p>{}</p></body></html>\n",
        player::element("player", &data(picture, duration).to_string()),
        escaped(&picture.subtitle)
    )
}

/// The data of the player.
fn data(picture: &Picture<'_>, duration: f64) -> Value {
    let is_view = matches!(picture.trace.source(), Source::View);
    let (labels, curves) = shown(picture);
    let times = frames(picture.trace.points(), duration);
    let (window, borders) = match is_view {
        true => behind(picture, &times, path_window(picture, &curves)),
        false => (path_window(picture, &curves), Vec::new()),
    };
    let shape = match is_view {
        true => (window.y[1] - window.y[0]) / (window.x[1] - window.x[0]),
        false => 0.5,
    };
    json!({
        "title": picture.title,
        "labels": labels,
        "box": [window.x[0], window.x[1], window.y[0], window.y[1]],
        "ticks": [ticks(window.x), ticks(window.y)],
        "equal": is_view,
        "height": ((WIDTH * shape).clamp(LEAST, WIDTH) + AROUND).round(),
        "fps": FPS,
        "times": times,
        "borders": borders,
        "curves": curves.iter().map(|curve| curve_data(picture, curve, &times)).collect::<Vec<_>>(),
    })
}

/// The labels of both axes, and the curves.
fn shown(picture: &Picture<'_>) -> ([String; 2], Vec<Curve>) {
    let description = picture.model.description();
    match (picture.trace.source(), &description.view) {
        (Source::View, Some(view)) => {
            let labels = view.labels.each_ref().map(|label| symbols::text(label));
            let path = [Component::Entry(0), Component::Entry(1)];
            (labels, vec![(String::new(), path)])
        }
        (Source::Quantities(quantities), _) => {
            let labels = quantities.iter().map(|it| it.label(description));
            against(labels.collect(), 1, Component::Entry(0))
        }
        _ => {
            let coordinates = names::coordinates(description).map(symbols::text);
            let outputs = description.outputs.iter().map(|it| it.replace('_', " "));
            let labels = ["t".to_owned()]
                .into_iter()
                .chain(coordinates)
                .chain(outputs);
            against(labels.collect(), 0, Component::Time)
        }
    }
}

/// Curves against an abscissa. `labels` are the label of the abscissa, then one for each ordinate. The first ordinate
/// is the entry `first` of a mark.
fn against(labels: Vec<String>, first: usize, abscissa: Component) -> ([String; 2], Vec<Curve>) {
    let mut labels = labels.into_iter();
    let x = labels.next().unwrap_or_default();
    let ordinates: Vec<String> = labels.collect();
    let y = ordinates.join(", ");
    let curves = ordinates.into_iter().enumerate();
    let curves = curves.map(|(index, label)| (label, [abscissa, Component::Entry(first + index)]));
    ([x, y], curves.collect())
}

/// The part of the plane around the curves.
fn path_window(picture: &Picture<'_>, curves: &[Curve]) -> Window {
    let marks = picture.trace.points();
    let points = |axis: usize| {
        let parts = curves.iter().map(move |(_, components)| components[axis]);
        parts.flat_map(move |part| marks.iter().map(move |mark| part.of(mark.t, &mark.values)))
    };
    if matches!(picture.trace.source(), Source::View) {
        let points: Vec<[f64; 2]> = points(0).zip(points(1)).map(|(x, y)| [x, y]).collect();
        return portrait::extent(&points);
    }
    Window {
        x: padded(points(0), 0.05),
        y: padded(points(1), 0.05),
    }
}

/// The part of the plane that is shown, and the walls behind the path. The walls are given once if they are at rest,
/// for each frame if they depend on time alone, and left out if they depend on other coordinates.
fn behind(picture: &Picture<'_>, times: &[f64], path: Window) -> (Window, Vec<Value>) {
    let (first, last) = (picture.first, picture.last);
    if let Some(region) = Region::of(picture.model, first, last, path) {
        let window = region.window(path);
        let lines = polylines(&region.contours(window, FINE));
        return (window, vec![lines]);
    }
    match Region::about(picture.model, &first.q) {
        Some(region) if region.depends_on_time_only(last, path) => {
            let window = region.window(path);
            let lines = times
                .iter()
                .map(|t| polylines(&region.contours_at(*t, window, COARSE)));
            (window, lines.collect())
        }
        _ => (path.grown(0.06), Vec::new()),
    }
}

fn polylines(contours: &[Contour]) -> Value {
    let strokes = contours.iter().flat_map(portrait::strokes);
    let long = strokes.filter(|stroke| stroke.len() > 1);
    long.map(|stroke| {
        stroke
            .into_iter()
            .map(|(x, y)| point([x, y]))
            .collect::<Value>()
    })
    .collect()
}

/// Equally spaced times from the first to the last mark.
fn frames(marks: &[Mark], duration: f64) -> Vec<f64> {
    let (Some(first), Some(last)) = (marks.first(), marks.last()) else {
        return vec![0.0, 0.0];
    };
    let intervals = (duration * FPS).round().max(1.0) as usize;
    (0..=intervals)
        .map(|k| first.t + (last.t - first.t) * (k as f64 / intervals as f64))
        .collect()
}

fn curve_data(picture: &Picture<'_>, (label, components): &Curve, times: &[f64]) -> Value {
    let marks = picture.trace.points();
    let place = |t: f64, values: &[f64]| components.map(|component| component.of(t, values));
    let stride = marks.len().div_ceil(MANY).max(1);
    let (mut path, mut path_times) = (Vec::new(), Vec::new());
    for (index, mark) in marks.iter().enumerate() {
        if index > 0 && marks[index - 1].jumps_to(mark) {
            path.push(json!([null, null]));
            path_times.push(mark.t);
        }
        if mark.corner || index % stride == 0 {
            path.push(point(place(mark.t, &mark.values)));
            path_times.push(mark.t);
        }
    }
    let source = picture.trace.source();
    let impacts = picture.impacts.iter().map(|impact| {
        let values = source.values(impact.t, &impact.after, picture.first.energy);
        let [x, y] = place(impact.t, &values).map(rounded);
        json!([impact.t, x, y])
    });
    let heads = times
        .iter()
        .map(|t| point(place(*t, &values_at(marks, *t))));
    json!({
        "label": label,
        "times": path_times,
        "path": path,
        "heads": heads.collect::<Vec<_>>(),
        "impacts": impacts.collect::<Vec<_>>(),
    })
}

/// The values at a time, interpolated linearly between the neighbouring marks.
fn values_at(marks: &[Mark], t: f64) -> Vec<f64> {
    let next = marks.partition_point(|mark| mark.t <= t);
    let (Some(left), right) = (marks.get(next.saturating_sub(1)), marks.get(next)) else {
        return Vec::new();
    };
    let Some(right) = right else {
        return left.values.clone();
    };
    let part = ((t - left.t) / (right.t - left.t)).clamp(0.0, 1.0);
    let values = left.values.iter().zip(&right.values);
    values
        .map(|(left, right)| left + part * (right - left))
        .collect()
}

fn point(values: [f64; 2]) -> Value {
    json!(values.map(rounded))
}

/// The value rounded to six digits, which suffice for a screen.
fn rounded(value: f64) -> f64 {
    format!("{value:.5e}").parse().unwrap_or(value)
}

/// Two to six round numbers within a range.
fn ticks([low, high]: [f64; 2]) -> Vec<f64> {
    let size = 10_f64.powf(((high - low) / 4.0).log10().floor());
    let steps = [1.0, 2.0, 5.0, 10.0].map(|factor| factor * size);
    let step = steps.into_iter().find(|step| *step >= (high - low) / 5.0);
    let step = step.unwrap_or(high - low);
    if !(step > 0.0 && step.is_finite()) {
        return Vec::new();
    }
    let places = (low / step).ceil() as i64..=(high / step).floor() as i64;
    places.map(|place| rounded(place as f64 * step)).collect()
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn ticks_are_round_numbers_within_the_range() {
        assert_eq!(ticks([0.0, 1.0]), [0.0, 0.2, 0.4, 0.6, 0.8, 1.0]);
        assert_eq!(ticks([-0.07, 0.31]), [0.0, 0.1, 0.2, 0.3]);
        assert_eq!(ticks([95.0, 2105.0]), [500.0, 1000.0, 1500.0, 2000.0]);
    }

    #[test]
    fn heads_lie_between_their_marks_and_behind_jumps() {
        let mark = |t: f64, x: f64| Mark {
            t,
            values: vec![x],
            corner: true,
            step: 1,
        };
        let marks = [
            mark(0.0, 0.0),
            mark(1.0, 2.0),
            mark(1.0, 5.0),
            mark(3.0, 6.0),
        ];
        let at = |t: f64| values_at(&marks, t)[0];
        assert_eq!([0.0, 0.5, 1.0, 2.0, 3.0].map(at), [0.0, 1.0, 5.0, 5.5, 6.0]);
        assert_eq!(frames(&marks, 0.1), [0.0, 1.0, 2.0, 3.0]);
    }
}
