//! Colour map, from dark to light.

use plotters::style::RGBColor;

/// Equally spaced colours of the map viridis (S. van der Walt and N. Smith, public domain). Colour-blind people can
/// distinguish them, and their order is visible in greyscale.
const COLOURS: [RGBColor; 9] = [
    RGBColor(68, 1, 84),
    RGBColor(71, 45, 123),
    RGBColor(59, 82, 139),
    RGBColor(44, 114, 142),
    RGBColor(33, 145, 140),
    RGBColor(40, 174, 128),
    RGBColor(94, 201, 98),
    RGBColor(173, 220, 48),
    RGBColor(253, 231, 37),
];

/// The colour of a fraction between low (0) and high (1).
pub fn colour(share: f64) -> RGBColor {
    let place = share * (COLOURS.len() - 1) as f64;
    let index = (place as usize).min(COLOURS.len() - 2);
    let (low, high) = (COLOURS[index], COLOURS[index + 1]);
    let part = place - index as f64;
    let mix = |low: u8, high: u8| {
        (f64::from(low) + part * (f64::from(high) - f64::from(low))).round() as u8
    };
    RGBColor(mix(low.0, high.0), mix(low.1, high.1), mix(low.2, high.2))
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn colours_run_from_the_first_to_the_last_and_get_lighter() {
        assert_eq!([colour(0.0), colour(1.0)], [COLOURS[0], COLOURS[8]]);
        let light = |share: f64| {
            let RGBColor(r, g, b) = colour(share);
            2 * u32::from(r) + 7 * u32::from(g) + u32::from(b)
        };
        assert!((0..64).all(|k| light(f64::from(k) / 64.0) < light(f64::from(k + 1) / 64.0)));
    }
}
