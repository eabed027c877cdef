//! Simplification of polylines.

/// Largest number of points in a stretch. The ends of a stretch are kept, and its work is at most quadratic in its
/// points. Without stretches, the work for an oscillating curve would be quadratic in all points.
const STRETCH: usize = 1024;

/// The indices of the kept points of a polyline; omitted points lie within `tolerance` of the simplified polyline
/// (Douglas and Peucker). The first and the last point are kept.
pub fn thinned(points: &[[f64; 2]], tolerance: f64) -> Vec<usize> {
    let mut keep = vec![false; points.len()];
    let Some(last) = points.len().checked_sub(1) else {
        return Vec::new();
    };
    let mut open: Vec<(usize, usize)> = (0..last)
        .step_by(STRETCH)
        .map(|first| (first, (first + STRETCH).min(last)))
        .collect();
    (keep[0], keep[last]) = (true, true);
    for (_, end) in &open {
        keep[*end] = true;
    }
    while let Some((first, last)) = open.pop() {
        let inside = first + 1..last;
        let farthest = inside
            .map(|index| (index, distance(points[index], points[first], points[last])))
            .max_by(|a, b| a.1.total_cmp(&b.1));
        if let Some((index, _)) = farthest.filter(|(_, far)| *far > tolerance) {
            keep[index] = true;
            open.extend([(first, index), (index, last)]);
        }
    }
    let kept = keep.iter().enumerate().filter(|(_, keep)| **keep);
    kept.map(|(index, _)| index).collect()
}

/// Distance of a point from the segment between two others.
fn distance(point: [f64; 2], from: [f64; 2], to: [f64; 2]) -> f64 {
    let along = [to[0] - from[0], to[1] - from[1]];
    let out = [point[0] - from[0], point[1] - from[1]];
    let square = along[0] * along[0] + along[1] * along[1];
    let share = if square > 0.0 {
        ((out[0] * along[0] + out[1] * along[1]) / square).clamp(0.0, 1.0)
    } else {
        0.0
    };
    (out[0] - share * along[0]).hypot(out[1] - share * along[1])
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_straight_line_keeps_its_ends_and_a_corner_stays() {
        let line: Vec<[f64; 2]> = (0..100)
            .map(|k| [f64::from(k), 2.0 * f64::from(k)])
            .collect();
        assert_eq!(thinned(&line, 1e-9), [0, 99]);
        let corner = [[0.0, 0.0], [1.0, 0.0], [2.0, 0.0], [2.0, 5.0]];
        assert_eq!(thinned(&corner, 0.1), [0, 2, 3]);
        assert!(thinned(&[], 1.0).is_empty());
    }

    /// The work is proportional to the number of points, because each is examined at most once per kept point of its
    /// stretch.
    #[test]
    fn a_curve_that_swings_to_and_fro_many_times_is_thinned_at_once() {
        let swings = 50_000_u32;
        let line: Vec<[f64; 2]> = (0..swings)
            .map(|k| [f64::from(k), f64::from(k % 2) * f64::from(swings - k)])
            .collect();
        let begun = std::time::Instant::now();
        assert_eq!(thinned(&line, 0.1).len(), line.len());
        let elapsed = begun.elapsed().as_secs_f64();
        assert!(elapsed < 20.0, "{elapsed} s");
    }

    #[test]
    fn a_stretch_that_is_run_back_over_stays() {
        let there_and_back = [[0.0, 0.0], [3.0, 0.0], [1.0, 0.0]];
        assert_eq!(thinned(&there_and_back, 0.5), [0, 1, 2]);
    }

    #[test]
    fn nothing_is_left_out_that_shows() {
        let circle: Vec<[f64; 2]> = (0..=720)
            .map(|k| f64::from(k) * std::f64::consts::PI / 360.0)
            .map(|angle| [100.0 * angle.cos(), 100.0 * angle.sin()])
            .collect();
        let kept = thinned(&circle, 0.1);
        assert!(kept.len() < 200, "{}", kept.len());
        for point in &circle {
            let near = kept
                .windows(2)
                .map(|pair| distance(*point, circle[pair[0]], circle[pair[1]]))
                .fold(f64::INFINITY, f64::min);
            assert!(near <= 0.1, "{near}");
        }
    }
}
