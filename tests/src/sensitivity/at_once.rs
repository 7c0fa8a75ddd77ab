//! Many long measurements, several at once.

use host_sim::error::Result;
use std::panic::resume_unwind;
use std::sync::atomic::{AtomicUsize, Ordering};
use std::thread::{available_parallelism, scope};
use std::time::Instant;

/// Does jobs, as many at once as there are processors, and tells each on stderr: how many are done, the
/// time since the start, and the words of its result. Returns the results in the order of the jobs.
///
/// Its threads are no pool: one that waits for a part of its job must not begin another one.
pub fn at_once<J: Sync, R: Send>(
    jobs: &[J],
    act: impl Fn(&J) -> Result<R> + Sync,
    words: impl Fn(&R) -> String + Sync,
) -> Vec<Result<R>> {
    let (begun, next, done) = (Instant::now(), AtomicUsize::new(0), AtomicUsize::new(0));
    let work = || {
        let mut results = Vec::new();
        loop {
            let at = next.fetch_add(1, Ordering::Relaxed);
            let Some(job) = jobs.get(at) else {
                return results;
            };
            let result = act(job);
            let done = done.fetch_add(1, Ordering::Relaxed) + 1;
            let (count, elapsed_s) = (jobs.len(), begun.elapsed().as_secs());
            let words = result
                .as_ref()
                .map_or_else(|error| error.to_string(), &words);
            eprintln!("{done} of {count}, {elapsed_s} s: {words}");
            results.push((at, result));
        }
    };
    let mut results = scope(|scope| {
        let count = available_parallelism().map_or(1, usize::from);
        let threads: Vec<_> = (0..count).map(|_| scope.spawn(work)).collect();
        let results = threads.into_iter().flat_map(|thread| match thread.join() {
            Ok(results) => results,
            Err(panic) => resume_unwind(panic),
        });
        results.collect::<Vec<_>>()
    });
    results.sort_by_key(|(at, _)| *at);
    results.into_iter().map(|(_, result)| result).collect()
}

#[cfg(test)]
mod tests {
    use super::*;
    use host_sim::error::Error;

    #[test]
    fn results_are_in_the_order_of_the_jobs_and_an_error_costs_only_itself() {
        let jobs: Vec<u32> = (0..20).collect();
        let act = |job: &u32| match job {
            7 => Err(Error::Stopped),
            _ => Ok(10 * job),
        };
        let results = at_once(&jobs, act, u32::to_string);
        assert_eq!(results.len(), jobs.len());
        for (job, result) in jobs.iter().zip(&results) {
            assert_eq!(result.as_ref().ok().copied(), act(job).ok());
        }
    }
}
