//! The estimator in an image with nearly nothing else; with a map; with a road memory. The linked images
//! of `src/bin/alone_*.rs` show how much flash and static memory it adds, and whether it can panic.

use crate::exchange::frame::RecordedFrame;
use crate::memory_budget::{FLASH_BYTES, RamFlash, SECTORS};
use crate::on_map::OnMap;
use core::cell::RefCell;
use core::hint::black_box;
use estimator_core::effect::CATALOGUE;
use estimator_core::roadmap::PackedMap;
use estimator_core::roadmap::memory::{RoadMemory, Sector};
use estimator_core::{
    AdoptedEffect, Cell, Estimator, Instant, Live, Model, PersistentState, Scalar, Tuning,
};
use static_cell::StaticCell;

/// Uses all of the estimator, with every effect of the catalogue. Returns `None` when an input is
/// missing or refused.
pub fn run<S: Scalar>(place: &'static StaticCell<Estimator<S>>) -> Option<()> {
    drive(place, |_| {}, |_| {})
}

/// Does the same with a map, and uses all of the map.
pub fn run_on_map<S: Scalar>(
    place: &'static StaticCell<Estimator<S>>,
    map_place: &'static StaticCell<OnMap<'static>>,
) -> Option<()> {
    let map: &'static [u8] = input()?;
    let map = PackedMap::open(map).ok()?;
    let on_map = RefCell::new(map_place.try_init(OnMap::new(map))?);
    let step = |live: &Live| {
        if let Ok(mut on_map) = on_map.try_borrow_mut() {
            on_map.advance(live);
            black_box(on_map.map().applied(live));
            let frame: Option<RecordedFrame> = on_map.pcc1(live, 0);
            black_box(frame);
            for frame in on_map.ahead_frames::<RecordedFrame>(live, 0) {
                black_box(frame);
            }
        }
    };
    let finish = |cell: &Cell| {
        if let Ok(mut on_map) = on_map.try_borrow_mut() {
            on_map.finish(cell);
        }
    };
    drive(place, step, finish)
}

/// A road memory of 64 kB.
pub type AloneMemory = RoadMemory<RamFlash<'static>, [Sector; SECTORS]>;

/// Does the same with a road memory, and uses all of it.
pub fn run_with_memory<S: Scalar>(
    place: &'static StaticCell<Estimator<S>>,
    memory_place: &'static StaticCell<AloneMemory>,
) -> Option<()> {
    let flash: &'static mut [u8; FLASH_BYTES] = input()?;
    let memory = AloneMemory::open(RamFlash(flash), [Sector::default(); SECTORS]).ok()?;
    let memory = RefCell::new(memory_place.try_init(memory)?);
    let step = |live: &Live| {
        if let Ok(mut memory) = memory.try_borrow_mut() {
            memory.advance(live);
            black_box((memory.grade(), memory.place(), memory.is_left_out()));
        }
    };
    let finish = |cell: &Cell| {
        if let Ok(mut memory) = memory.try_borrow_mut() {
            black_box(memory.finish(cell).is_ok());
        }
    };
    drive(place, step, finish)?;
    let mut memory = memory.try_borrow_mut().ok()?;
    black_box((memory.close().is_ok(), memory.level().is_ok()));
    black_box((memory.opened(), memory.counters(), memory.map_counters()));
    Some(())
}

fn drive<S: Scalar>(
    place: &'static StaticCell<Estimator<S>>,
    on_step: impl Fn(&Live),
    on_cell: impl Fn(&Cell),
) -> Option<()> {
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
            if let Some(live) = estimator.live() {
                on_step(&live);
            }
            while let Some(cell) = estimator.next_cell() {
                on_cell(&cell);
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
