//! The estimator in an image with next to nothing else: what it adds to flash and static memory,
//! and whether it can panic, is read off the linked images of `src/bin/alone_*.rs`.

use crate::exchange::frame::RecordedFrame;
use core::hint::black_box;
use estimator_core::effect::CATALOGUE;
use estimator_core::{AdoptedEffect, Estimator, Instant, Model, PersistentState, Scalar, Tuning};
use static_cell::StaticCell;

/// Returns a program that uses all of the estimator, with every effect to choose from; `None` when
/// there is no more input.
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
    let estimator = match kept {
        Some(kept) => Estimator::restore(model, tuning, &kept).ok()?,
        None => Estimator::new(model, tuning).ok()?,
    };
    let estimator = place.try_init(estimator)?;
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
    while let Some(cell) = estimator.drain_cell() {
        black_box(cell);
    }
    Some(())
}

/// Input of which the compiler knows nothing.
fn input<T>() -> Option<T> {
    black_box(None)
}
