//! The estimator in an image with nearly nothing else. The linked images of `src/bin/alone_*.rs`
//! show how much flash and static memory it adds, and whether it can panic.

use crate::exchange::frame::RecordedFrame;
use core::hint::black_box;
use estimator_core::effect::CATALOGUE;
use estimator_core::{AdoptedEffect, Estimator, Instant, Model, PersistentState, Scalar, Tuning};
use static_cell::StaticCell;

/// Uses all of the estimator, with every effect of the catalogue. Returns `None` when an input is
/// missing or refused.
pub fn run<S: Scalar>(place: &'static StaticCell<Estimator<S>>) -> Option<()> {
    let mut model: Model = input()?;
    for effect in CATALOGUE {
        if let Some((amount, sigma)) = input() {
            model
                .effects
                .adopt(AdoptedEffect::new(effect, amount, sigma))
                .ok()?;
        }
    }
    let tuning = Tuning::default();
    let stored: Option<[u8; PersistentState::LEN]> = input();
    let kept = stored.and_then(|bytes| PersistentState::from_bytes(&bytes).ok());
    let estimator = Estimator::new_in(place.try_uninit()?, &model, &tuning).ok()?;
    if let Some(kept) = kept {
        estimator.resume(&kept).ok()?;
    }
    while let Some((now, frame)) = input::<(Instant, RecordedFrame)>() {
        black_box(estimator.on_frame(now, &frame));
        while let Some(step) = estimator.step() {
            black_box(step);
            while let Some(cell) = estimator.next_cell() {
                black_box(cell);
            }
        }
        black_box(estimator.live());
        black_box(estimator.counters());
        black_box(estimator.persistent_state().map(|kept| kept.to_bytes()));
    }
    while estimator.drain_step() {
        while let Some(cell) = estimator.next_cell() {
            black_box(cell);
        }
    }
    Some(())
}

/// Returns an input that the compiler cannot predict.
fn input<T>() -> Option<T> {
    black_box(None)
}
