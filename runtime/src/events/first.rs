//! Search for the first fraction of a step at which a predicate holds. Stretches on which an enclosure excludes the
//! predicate are skipped; others are halved.

/// Depths of halving. At the deepest level, the predicate at the end of a stretch decides. The first search halves to
/// `2^-40` of the step; the next ones use coarser stretches. They are made if too many stretches cannot be excluded,
/// for example where rounding decides the predicate.
const DEPTHS: [u32; 3] = [40, 20, 10];

/// Maximum number of stretches examined at each depth.
const STRETCHES: u32 = 4096;

/// Two neighbouring fractions of a step: the predicate does not hold at the first, and holds at the second.
#[derive(Debug, Clone, Copy, PartialEq)]
pub(crate) struct Onset {
    pub before: f64,
    pub after: f64,
}

/// Finds the first fraction up to `reach` at which a predicate holds. The predicate does not hold at the start. `holds`
/// evaluates it at a fraction. `is_out` is true for a stretch on which it certainly holds nowhere.
pub(crate) fn onset(
    reach: f64,
    is_out: impl FnMut([f64; 2]) -> bool,
    holds: impl FnMut(f64) -> bool,
) -> Option<Onset> {
    onset_among(STRETCHES, reach, is_out, holds)
}

/// Same as [`onset`], with a maximum number of stretches examined at each depth.
pub(crate) fn onset_among(
    stretches: u32,
    reach: f64,
    mut is_out: impl FnMut([f64; 2]) -> bool,
    mut holds: impl FnMut(f64) -> bool,
) -> Option<Onset> {
    let mut from = 0.0;
    for depth in DEPTHS {
        let begins = |ends: [f64; 2]| holds(ends[1]).then(|| narrowed(ends, &mut holds));
        match walk([from, reach], [depth, stretches], &mut is_out, begins) {
            Walk::Found(onset) => return Some(onset),
            Walk::Passed => return None,
            Walk::Stopped(at) => from = at,
        }
    }
    holds(reach).then(|| narrowed([from, reach], holds))
}

/// Result of a walk over stretches.
#[derive(Debug, Clone, Copy, PartialEq)]
pub(crate) enum Walk<T> {
    Found(T),
    /// All stretches are excluded.
    Passed,
    /// The maximum number of stretches was examined; the search stopped here.
    Stopped(f64),
}

/// Walks over the stretches of a span from its start. Halves those that `is_out` does not exclude, up to `leaves`
/// times, and calls `found` on the smallest. Examines at most `stretches` stretches.
pub(crate) fn walk<T>(
    span: [f64; 2],
    [leaves, stretches]: [u32; 2],
    mut is_out: impl FnMut([f64; 2]) -> bool,
    mut found: impl FnMut([f64; 2]) -> Option<T>,
) -> Walk<T> {
    let (mut index, mut depth) = (0_u64, 0_u32);
    for _ in 0..stretches {
        let ends = stretch(span, index, depth);
        if !is_out(ends) {
            if depth < leaves {
                (index, depth) = (2 * index, depth + 1);
                continue;
            }
            if let Some(found) = found(ends) {
                return Walk::Found(found);
            }
        }
        index += 1;
        while index.is_multiple_of(2) && depth > 0 {
            (index, depth) = (index / 2, depth - 1);
        }
        if depth == 0 {
            return Walk::Passed;
        }
    }
    Walk::Stopped(stretch(span, index, depth)[0])
}

/// The ends of stretch `index` of the `2^depth` equal stretches of a span.
fn stretch([from, to]: [f64; 2], index: u64, depth: u32) -> [f64; 2] {
    let count = (1_u64 << depth) as f64;
    [index, index + 1].map(|end| match end as f64 == count {
        true => to,
        false => from + (to - from) * (end as f64 / count),
    })
}

/// Bisects to neighbouring numbers: the predicate does not hold at the first, and holds at the second.
pub(crate) fn narrowed(
    [mut before, mut after]: [f64; 2],
    mut holds: impl FnMut(f64) -> bool,
) -> Onset {
    loop {
        let middle = 0.5 * (before + after);
        if middle <= before || middle >= after {
            return Onset { before, after };
        }
        match holds(middle) {
            true => after = middle,
            false => before = middle,
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    /// The first fraction that lies in one of these windows.
    fn first_in(windows: &[[f64; 2]], reach: f64) -> Option<f64> {
        let is_out = |[from, to]: [f64; 2]| {
            windows
                .iter()
                .all(|window| to < window[0] || window[1] < from)
        };
        let holds = |x: f64| windows.iter().any(|entry| entry[0] <= x && x <= entry[1]);
        onset(reach, is_out, holds).map(|found| found.after)
    }

    #[test]
    fn narrow_windows_are_found_where_they_begin() {
        for width in [0.3, 1e-3, 1e-9] {
            for start in [0.01, 0.37, 0.5, 0.99] {
                let windows = [[start, start + width], [start + 0.4, start + 0.5]];
                assert_eq!(first_in(&windows, 1.0), Some(start), "{start} {width}");
            }
        }
        assert_eq!(first_in(&[[0.6, 0.7]], 0.5), None);
        assert_eq!(first_in(&[[0.2, 0.9]], 0.5), Some(0.2));
        assert_eq!(first_in(&[], 1.0), None);
    }

    #[test]
    fn what_is_never_ruled_out_is_decided_at_the_end() {
        assert_eq!(onset(1.0, |_| false, |_| false), None);
        let found = onset(1.0, |_| false, |x| x >= 0.25);
        assert_eq!(found.map(|found| found.after), Some(0.25));
        // The predicate may also hold on a part of the step only.
        let found = onset(1.0, |_| false, |x| (0.25..0.5).contains(&x));
        assert_eq!(found.map(|found| found.after), Some(0.25));
    }
}
