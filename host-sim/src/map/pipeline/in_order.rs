//! Work on many items at once, whose results are taken in the order of the items.
//!
//! Each thread makes results, and takes the next one if it is there: none waits for a batch to end.
//! Results that wait to be taken are limited by what the items cost.

use crate::error::Result;
use std::collections::BTreeMap;
use std::sync::{Condvar, Mutex, MutexGuard, PoisonError};

/// An item that can be worked on.
pub(super) trait Item: Sync {
    /// Returns what its result takes, in any unit.
    fn cost(&self) -> usize;
}

/// Passes the result of `make` for each item to `take`, in their order. As many results are in
/// memory at once as cost `most` together, but at least one for each thread that finds it empty.
/// Each thread has a scratch of its own, which `make` may use again for the next item.
///
/// # Errors
/// Returns the first error of `take`; later items are then not taken.
pub(super) fn in_order<T: Item, S: Default, R: Send>(
    items: &[T],
    most: usize,
    make: impl Fn(&T, &mut S) -> R + Sync,
    take: impl FnMut(&T, R) -> Result<()> + Send,
) -> Result<()> {
    let work = Work {
        items,
        most,
        state: Mutex::new(State::default()),
        changed: Condvar::new(),
        take: Mutex::new(take),
    };
    rayon::broadcast(|_| work.join_in(&make));
    let state = work.state.into_inner();
    state.unwrap_or_else(PoisonError::into_inner).result
}

struct Work<'i, T, R, F> {
    items: &'i [T],
    most: usize,
    state: Mutex<State<R>>,
    changed: Condvar,
    /// Held by the thread that takes.
    take: Mutex<F>,
}

struct State<R> {
    /// Index of the next item to make, and of the next to take.
    next: usize,
    next_taken: usize,
    /// True while a thread takes.
    is_taking: bool,
    /// Results that wait to be taken.
    made: BTreeMap<usize, R>,
    /// Cost of the items that are made or wait.
    cost: usize,
    /// True after an error or a panic.
    is_stopped: bool,
    result: Result<()>,
}

impl<R> Default for State<R> {
    fn default() -> Self {
        Self {
            next: 0,
            next_taken: 0,
            is_taking: false,
            made: BTreeMap::new(),
            cost: 0,
            is_stopped: false,
            result: Ok(()),
        }
    }
}

/// What a thread does next.
enum Step<R> {
    Make(usize),
    Take(usize, R),
    Wait,
    End,
}

/// Lets the other threads end if this one panics.
struct Guard<'w, T, R, F>(&'w Work<'w, T, R, F>);

impl<T, R, F> Drop for Guard<'_, T, R, F> {
    fn drop(&mut self) {
        if std::thread::panicking() {
            self.0.lock().is_stopped = true;
            self.0.changed.notify_all();
        }
    }
}

impl<T, R, F> Work<'_, T, R, F> {
    fn lock(&self) -> MutexGuard<'_, State<R>> {
        self.state.lock().unwrap_or_else(PoisonError::into_inner)
    }
}

impl<T: Item, R, F: FnMut(&T, R) -> Result<()>> Work<'_, T, R, F> {
    /// Makes and takes results until all are taken.
    fn join_in<S: Default>(&self, make: &impl Fn(&T, &mut S) -> R) {
        let _guard = Guard(self);
        let mut scratch = S::default();
        let mut state = self.lock();
        loop {
            match self.next_step(&mut state) {
                Step::Make(i) => {
                    drop(state);
                    let result = make(&self.items[i], &mut scratch);
                    state = self.lock();
                    state.made.insert(i, result);
                }
                Step::Take(i, result) => {
                    drop(state);
                    let mut take = self.take.lock().unwrap_or_else(PoisonError::into_inner);
                    let taken = take(&self.items[i], result);
                    drop(take);
                    state = self.lock();
                    state.took(self.items[i].cost(), taken);
                }
                Step::Wait => {
                    let waited = self.changed.wait(state);
                    state = waited.unwrap_or_else(PoisonError::into_inner);
                    continue;
                }
                Step::End => break,
            }
            self.changed.notify_all();
        }
    }

    fn next_step(&self, state: &mut State<R>) -> Step<R> {
        if state.is_stopped || state.next_taken == self.items.len() {
            return Step::End;
        }
        let i = state.next_taken;
        if !state.is_taking
            && let Some(result) = state.made.remove(&i)
        {
            state.is_taking = true;
            return Step::Take(i, result);
        }
        let Some(item) = self.items.get(state.next) else {
            return Step::Wait;
        };
        let cost = state.cost.saturating_add(item.cost());
        if state.cost > 0 && cost > self.most {
            return Step::Wait;
        }
        state.cost = cost;
        state.next += 1;
        Step::Make(state.next - 1)
    }
}

impl<R> State<R> {
    /// Notes that a result was taken.
    fn took(&mut self, cost: usize, result: Result<()>) {
        self.is_taking = false;
        self.next_taken += 1;
        self.cost = self.cost.saturating_sub(cost);
        if result.is_err() {
            self.is_stopped = true;
            self.result = result;
        }
    }
}
