//! Many items at once on a given number of threads.

use std::collections::BTreeMap;
use std::sync::atomic::{AtomicUsize, Ordering};
use std::{sync::mpsc, thread};

use anyhow::{Result, anyhow};
use indicatif::ProgressBar;
use rayon::{ThreadPool, ThreadPoolBuilder};

use crate::failure::Outcome;
use crate::{interrupt, terminal};

/// Calls `work` on every item and `report` with the results, in the order of the items. Each thread that takes items has
/// a `Tool` of its own, which it hands to `work` as the last item left it.
///
/// As many items are open at a time as there are threads, and each has an equal share of the threads to itself.
/// A common pool would let a thread that waits within one item start another, so that ever more are open at once.
/// After Ctrl-C, if it is [caught](interrupt::catch), no more items are taken.
///
/// # Errors
/// When the threads cannot be had.
pub(crate) fn in_order<T: Sync, Tool: Default + Send, R: Send>(
    items: &[T],
    threads: usize,
    work: impl Fn(&mut Tool, &T) -> R + Sync,
    mut report: impl FnMut(&T, R),
) -> Result<()> {
    let workers = threads.min(items.len());
    let pools = (0..workers)
        .map(|k| pool(threads / workers + usize::from(k < threads % workers)))
        .collect::<Result<Vec<_>>>()?;

    let next = AtomicUsize::new(0);
    let take = || if interrupt::is_asked() { None } else { take(items, &next) };
    let (sender, results) = mpsc::channel();
    thread::scope(|scope| {
        // Owned here, so that the workers stop when this scope ends early.
        let results = results;
        for pool in &pools {
            let (sender, take, work) = (sender.clone(), &take, &work);
            let worker = move || {
                let mut tool = Tool::default();
                while let Some((k, item)) = take() {
                    if sender.send((k, pool.install(|| work(&mut tool, item)))).is_err() {
                        break;
                    }
                }
            };
            thread::Builder::new()
                .spawn_scoped(scope, worker)
                .map_err(|e| anyhow!("cannot start a thread ({e}): give fewer with --threads"))?;
        }
        drop(sender);

        let mut early = BTreeMap::new();
        let mut due = 0;
        for (k, result) in results {
            early.insert(k, result);
            while let Some(result) = early.remove(&due) {
                report(&items[due], result);
                due += 1;
            }
        }
        Ok(())
    })
}

/// How many items ended.
pub(crate) struct Reported {
    /// How many of how many were done.
    done: usize,
    total: usize,
    /// How many failed; each was named on stderr.
    failed: usize,
    /// Whether everything could be printed that there was to say of those done. Work goes on when it could not.
    printed: Result<()>,
}

impl Reported {
    /// Says on stderr how many `what` are done, when there is anything to tell; how the command ends. `refused` more could
    /// not even be begun.
    ///
    /// # Errors
    /// When stdout could not be written.
    pub(crate) fn sum_up(self, what: &str, refused: usize) -> Result<Outcome> {
        let Self { done, failed, printed, .. } = self;
        let (total, failed) = (self.total + refused, failed + refused);
        let is_interrupted = done + failed < total;
        let ends = [(failed > 0, format!(", {failed} failed")), (is_interrupted, ", interrupted".to_owned())];
        let ends: String = ends.into_iter().filter_map(|(holds, text)| holds.then_some(text)).collect();
        // Without a frame the errors have said everything.
        if self.total > 0 && (total > 1 || !ends.is_empty()) {
            terminal::complain(&format!("{done} of {total} {what} done{ends}"));
        }
        printed?;
        Ok(match (is_interrupted, failed) {
            (true, _) => Outcome::Interrupted,
            (false, 0) => Outcome::AllDone,
            (false, _) => Outcome::SomeFailed,
        })
    }
}

/// Does `work` on every item as [`in_order`] does, prints what `text` says of each (it is done, or it failed) and names each that
/// failed, above a bar that moves on. Ctrl-C ends it after the items that are under way.
///
/// # Errors
/// When the threads cannot be had.
pub(crate) fn report_in_order<T: Sync, Tool: Default + Send, D: Send>(
    items: &[T],
    threads: usize,
    bar: &ProgressBar,
    work: impl Fn(&mut Tool, &T) -> Result<D> + Sync,
    mut text: impl FnMut(&T, Result<D, &anyhow::Error>) -> String,
) -> Result<Reported> {
    interrupt::catch()?;
    let mut reported = Reported { done: 0, total: items.len(), failed: 0, printed: Ok(()) };
    in_order(items, threads, work, |item, result| {
        let (text, failed) = match result {
            Ok(done) => (text(item, Ok(done)), None),
            Err(e) => (text(item, Err(&e)), Some(e)),
        };
        bar.suspend(|| {
            if reported.printed.is_ok() {
                reported.printed = terminal::print(&text);
            }
            match failed {
                None => reported.done += 1,
                Some(e) => {
                    reported.failed += 1;
                    terminal::error(&e);
                }
            }
        });
        if reported.failed > 0 {
            bar.set_message(format!(", {} failed", reported.failed));
        }
        bar.inc(1);
    })?;
    bar.finish_and_clear();
    Ok(reported)
}

/// A pool of threads.
///
/// # Errors
/// When they cannot be had.
pub(crate) fn pool(threads: usize) -> Result<ThreadPool> {
    ThreadPoolBuilder::new()
        .num_threads(threads)
        .build()
        .map_err(|e| anyhow!("cannot start {threads} threads ({e}): give fewer with --threads"))
}

/// The next item that no thread has taken, with its number.
fn take<'a, T>(items: &'a [T], next: &AtomicUsize) -> Option<(usize, &'a T)> {
    let k = next.fetch_add(1, Ordering::Relaxed);
    items.get(k).map(|item| (k, item))
}

#[cfg(test)]
mod tests {
    use std::time::Duration;

    use rayon::prelude::*;

    use super::*;

    #[test]
    fn results_come_in_order_and_no_more_items_are_open_than_threads() {
        for threads in [1, 2, 3, 8] {
            let (open, most) = (AtomicUsize::new(0), AtomicUsize::new(0));
            let work = |uses: &mut usize, &k: &usize| {
                *uses += 1;
                most.fetch_max(open.fetch_add(1, Ordering::SeqCst) + 1, Ordering::SeqCst);
                // Parallel work within an item, of uneven length.
                let sum: usize = (0..64)
                    .into_par_iter()
                    .map(|i| {
                        thread::sleep(Duration::from_micros(100));
                        i * k
                    })
                    .sum();
                open.fetch_sub(1, Ordering::SeqCst);
                (sum, rayon::current_num_threads(), *uses)
            };
            let items: Vec<usize> = (0..20).collect();
            let (mut seen, mut tools) = (Vec::new(), 0);
            in_order(&items, threads, work, |&k, (sum, share, uses)| {
                assert_eq!((sum, share), (2016 * k, 1));
                seen.push(k);
                tools += usize::from(uses == 1);
            })
            .unwrap();
            assert_eq!(seen, items);
            assert!(tools <= threads, "a thread keeps its tool: {tools} of {threads}");
            assert!(most.into_inner() <= threads);
        }
    }

    #[test]
    fn few_items_share_all_threads() {
        let mut shares = Vec::new();
        in_order(&[(); 2], 5, |(): &mut (), ()| rayon::current_num_threads(), |(), share| shares.push(share))
            .unwrap();
        shares.sort_unstable();
        assert!(shares == [2, 3] || shares == [2, 2] || shares == [3, 3], "{shares:?}");
        in_order(&[(); 0], 5, |(): &mut (), ()| (), |(), ()| panic!("nothing to report")).unwrap();
    }
}
