//! Parallel work whose results arrive in order.
//!
//! Free threads take the next block of items. Results that arrive early wait. The number of waiting results is bounded,
//! because no thread takes a block that is too far ahead of the first missing result.

use std::collections::BTreeMap;
use std::ops::Range;
use std::sync::mpsc::{self, Receiver, Sender};
use std::sync::{Condvar, Mutex, MutexGuard, PoisonError};
use std::thread;

/// Number of blocks per thread that may be handed out ahead of the first missing result.
const AHEAD: u64 = 8;

/// Smallest number of items in a block, as long as every thread gets that many. Runs side by side fill SIMD lanes.
const TOGETHER: u64 = 8;

/// Division of the work.
#[derive(Debug, Clone, Copy)]
pub struct Division {
    /// Number of threads.
    pub threads: u64,
    /// Items in a block.
    pub block: u64,
}

impl Division {
    /// Divides the work into blocks of at most `largest` items. Every thread gets about 16 blocks if there are many
    /// items. Few items are divided into blocks of up to 8.
    pub fn new(items: u64, threads: u64, largest: u64) -> Self {
        let threads = threads.clamp(1, items.max(1));
        let least = items.div_ceil(threads).min(TOGETHER);
        let block = (items / (threads * 16)).max(least).clamp(1, largest.max(1));
        Self { threads, block }
    }
}

/// Works on all items. Every thread calls `prepare` once and `work` for every block. The calling thread calls `take`,
/// in the order of the items, with the first item of every block and the block's results, one per item.
///
/// # Errors
/// The first error of `take`, which ends the work.
pub fn in_order<W, T: Send, E>(
    items: Range<u64>,
    division: Division,
    prepare: impl Fn() -> W + Sync,
    work: impl Fn(&mut W, Range<u64>) -> Vec<T> + Sync,
    mut take: impl FnMut(u64, Vec<T>) -> Result<(), E>,
) -> Result<(), E> {
    let gate = Gate::new(items.clone(), division);
    thread::scope(|scope| {
        // This guard is dropped at the end, also after an error, so that no thread keeps waiting for results to be
        // taken.
        let _closing = Closing(&gate);
        let (sender, receiver) = mpsc::channel();
        for _ in 0..division.threads {
            let sender: Sender<(u64, Vec<T>)> = sender.clone();
            let (gate, prepare, work) = (&gate, &prepare, &work);
            scope.spawn(move || {
                let _closing = Closing(gate);
                let mut worker = prepare();
                while let Some(block) = gate.next() {
                    let start = block.start;
                    let results = work(&mut worker, block);
                    if sender.send((start, results)).is_err() {
                        return;
                    }
                }
            });
        }
        drop(sender);
        collect(items.start, &receiver, &gate, &mut take)
    })
}

/// Takes results in order until all threads have ended.
fn collect<T, E>(
    first: u64,
    receiver: &Receiver<(u64, Vec<T>)>,
    gate: &Gate,
    take: &mut impl FnMut(u64, Vec<T>) -> Result<(), E>,
) -> Result<(), E> {
    let mut next = first;
    let mut early = BTreeMap::new();
    for (start, results) in receiver {
        early.insert(start, results);
        while let Some(results) = early.remove(&next) {
            let count = results.len() as u64;
            take(next, results)?;
            next += count;
            gate.taken(next);
        }
    }
    Ok(())
}

/// Hands out blocks.
struct Gate {
    state: Mutex<State>,
    moved: Condvar,
    end: u64,
    block: u64,
    /// Number of items that may be handed out before their results are taken.
    ahead: u64,
}

struct State {
    /// The first item that is not handed out yet.
    next: u64,
    /// The first item whose result is not taken yet.
    taken: u64,
    /// True once a thread, or the taker of results, has left before all items were handed out.
    is_closed: bool,
}

impl Gate {
    fn new(items: Range<u64>, division: Division) -> Self {
        let state = State {
            next: items.start,
            taken: items.start,
            is_closed: false,
        };
        Self {
            state: Mutex::new(state),
            moved: Condvar::new(),
            end: items.end,
            block: division.block,
            ahead: AHEAD * division.threads * division.block,
        }
    }

    /// The next block, once it is not too far ahead; `None` at the end.
    fn next(&self) -> Option<Range<u64>> {
        let too_early = |state: &mut State| {
            !state.is_closed && state.next < self.end && state.next - state.taken >= self.ahead
        };
        let waited = self.moved.wait_while(self.lock(), too_early);
        let mut state = waited.unwrap_or_else(PoisonError::into_inner);
        if state.is_closed || state.next >= self.end {
            return None;
        }
        let start = state.next;
        state.next = self.end.min(start + self.block);
        Some(start..state.next)
    }

    fn taken(&self, taken: u64) {
        self.lock().taken = taken;
        self.moved.notify_all();
    }

    fn close(&self) {
        self.lock().is_closed = true;
        self.moved.notify_all();
    }

    /// Locks the state, which is consistent whenever the lock is free, even after a panic.
    fn lock(&self) -> MutexGuard<'_, State> {
        self.state.lock().unwrap_or_else(PoisonError::into_inner)
    }
}

/// Ends all work when a thread leaves before all items were handed out, as after a panic or an error.
struct Closing<'a>(&'a Gate);

impl Drop for Closing<'_> {
    fn drop(&mut self) {
        let done = self.0.lock().next >= self.0.end;
        if !done {
            self.0.close();
        }
    }
}

#[cfg(test)]
mod tests {
    use std::sync::atomic::{AtomicU64, Ordering};
    use std::time::Duration;

    use super::*;

    fn squares(items: Range<u64>, division: Division) -> Vec<u64> {
        let mut taken = Vec::new();
        let take = |first, squares: Vec<u64>| {
            for (item, square) in (first..).zip(squares) {
                taken.extend([item, square]);
            }
            Ok::<(), ()>(())
        };
        let done = in_order(
            items,
            division,
            || (),
            |(), block| block.map(|item| item * item).collect(),
            take,
        );
        assert_eq!(done, Ok(()));
        taken
    }

    #[test]
    fn results_come_in_order_whatever_the_threads() {
        let expected: Vec<u64> = (5..500).flat_map(|item| [item, item * item]).collect();
        for threads in [1, 2, 7] {
            for block in [1, 3, 1000] {
                assert_eq!(squares(5..500, Division { threads, block }), expected);
            }
        }
        assert!(squares(5..5, Division::new(0, 4, 64)).is_empty());
    }

    #[test]
    fn nobody_runs_far_ahead_of_a_slow_item() {
        let division = Division {
            threads: 2,
            block: 1,
        };
        let furthest = AtomicU64::new(0);
        let work = |(): &mut (), block: Range<u64>| {
            if block.start == 0 {
                thread::sleep(Duration::from_millis(50));
                assert!(furthest.load(Ordering::SeqCst) < 2 * AHEAD);
            }
            furthest.fetch_max(block.start, Ordering::SeqCst);
            vec![()]
        };
        let done = in_order(0..1000, division, || (), work, |_, _| Ok::<(), ()>(()));
        assert_eq!((done, furthest.into_inner()), (Ok(()), 999));
    }

    #[test]
    fn an_error_ends_the_work() {
        let worked = AtomicU64::new(0);
        let work = |(): &mut (), block: Range<u64>| {
            let count = |_| worked.fetch_add(1, Ordering::SeqCst);
            block.map(count).collect()
        };
        let division = Division {
            threads: 3,
            block: 2,
        };
        let take = |first, _| if first == 10 { Err("full") } else { Ok(()) };
        let done = in_order(0..1_000_000, division, || (), work, take);
        assert_eq!(done, Err("full"));
        assert!(worked.into_inner() < 100);
    }
}
