//! The work-precision diagram: time against error, a curve for each integrator.

use dalembert_driver::accuracy::Study;

use super::logarithmic::draw_labelled;
use crate::suite::Curve;

/// Draws a study. Runs that do not end as the reference does are left out. Errors below the accuracy of the reference
/// are drawn at that accuracy.
///
/// # Errors
/// An error of the drawing library.
pub fn draw(title: &str, subtitle: &str, study: &Study) -> Result<String, String> {
    let floor = study.floor.max(f64::EPSILON / 2.0);
    let mut curves: Vec<Curve> = Vec::new();
    for sample in study.samples.iter().filter(|sample| sample.agrees) {
        let name = sample.integrator.name();
        let point = [sample.error.max(floor), sample.microseconds];
        match curves.last_mut().filter(|curve| curve.name == name) {
            Some(curve) => curve.points.push(point),
            None => curves.push(Curve {
                name: name.to_owned(),
                axes: [
                    "error of the positions, relative",
                    "microseconds per unit of time",
                ],
                points: vec![point],
            }),
        }
    }
    let labels: Vec<String> = curves.iter().map(|curve| curve.name.clone()).collect();
    let mut rings: Vec<[f64; 2]> = study
        .cheapest()
        .iter()
        .map(|(_, best)| [best.error.max(floor), best.microseconds])
        .collect();
    rings.dedup();
    draw_labelled((title, subtitle), &curves, &labels, &rings)
}
