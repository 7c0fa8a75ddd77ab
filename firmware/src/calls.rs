//! Each call of the estimator as a function of its own, so that the call graph of the linked image
//! shows what each needs (the package `evidence`). The image is never run.

use crate::exchange::frame::RecordedFrame;
use crate::on_map::OnMap;
use core::hint::black_box;
use core::mem::MaybeUninit;
use estimator_core::roadmap::{MapError, NumberedPart, PackedMap};
use estimator_core::{
    Cell, Estimator, Instant, Live, Model, Outcome, ParameterError, PersistentState,
    PersistentStateError, Reading, Scalar, Step, Tuning,
};

/// Makes each call once, with inputs that the compiler cannot predict.
pub fn run<S: Scalar>(place: &'static mut MaybeUninit<Estimator<S>>) -> Option<()> {
    let model: Model = input()?;
    let estimator = create(place, &model).ok()?;
    if let Some(state) = kept(&input()?) {
        black_box(resume(estimator, &state).is_ok());
    }
    let (now, frame, reading) = input()?;
    black_box(on_frame(estimator, now, &frame));
    black_box(on_reading(estimator, now, reading));
    black_box(step(estimator));
    let live = live(estimator)?;
    black_box(next_cell(estimator));
    black_box(drain_step(estimator));
    black_box(persistent_state(estimator));
    let on_map = &mut OnMap::new(open_map(input()?).ok()?);
    map_advance(on_map, &live);
    map_finish(on_map, &input()?);
    black_box(map_next_part(on_map, &live));
    black_box(map_pcc1(on_map, &live));
    Some(())
}

/// `Estimator::new_in`, with the tuning as it is by default.
#[inline(never)]
fn create<'a, S: Scalar>(
    place: &'a mut MaybeUninit<Estimator<S>>,
    model: &Model,
) -> Result<&'a mut Estimator<S>, ParameterError> {
    Estimator::new_in(place, model, &Tuning::default())
}

/// `PersistentState::from_bytes`.
#[inline(never)]
fn kept(bytes: &[u8; PersistentState::LEN]) -> Option<PersistentState> {
    PersistentState::from_bytes(bytes).ok()
}

/// `Estimator::resume`.
#[inline(never)]
fn resume<S: Scalar>(
    estimator: &mut Estimator<S>,
    state: &PersistentState,
) -> Result<(), PersistentStateError> {
    estimator.resume(state)
}

/// `Estimator::on_frame`.
#[inline(never)]
fn on_frame<S: Scalar>(
    estimator: &mut Estimator<S>,
    now: Instant,
    frame: &RecordedFrame,
) -> Outcome {
    estimator.on_frame(now, frame)
}

/// `Estimator::on_reading`.
#[inline(never)]
fn on_reading<S: Scalar>(estimator: &mut Estimator<S>, now: Instant, reading: Reading) -> Outcome {
    estimator.on_reading(now, reading)
}

/// `Estimator::step`.
#[inline(never)]
fn step<S: Scalar>(estimator: &mut Estimator<S>) -> Option<Step> {
    estimator.step()
}

/// `Estimator::live`.
#[inline(never)]
fn live<S: Scalar>(estimator: &Estimator<S>) -> Option<Live> {
    estimator.live()
}

/// `Estimator::next_cell`.
#[inline(never)]
fn next_cell<S: Scalar>(estimator: &mut Estimator<S>) -> Option<Cell> {
    estimator.next_cell()
}

/// `Estimator::drain_step`.
#[inline(never)]
fn drain_step<S: Scalar>(estimator: &mut Estimator<S>) -> bool {
    estimator.drain_step()
}

/// `Estimator::persistent_state` and its bytes.
#[inline(never)]
fn persistent_state<S: Scalar>(estimator: &Estimator<S>) -> Option<[u8; PersistentState::LEN]> {
    estimator.persistent_state().map(|state| state.to_bytes())
}

/// `PackedMap::open`.
#[inline(never)]
fn open_map(map: &'static [u8]) -> Result<PackedMap<'static>, MapError> {
    PackedMap::open(map)
}

/// `MapLive::advance`.
#[inline(never)]
fn map_advance(on_map: &mut OnMap<'_>, live: &Live) {
    on_map.advance(live);
}

/// `MapLive::finish`.
#[inline(never)]
fn map_finish(on_map: &mut OnMap<'_>, cell: &Cell) {
    on_map.finish(cell);
}

/// `HorizonParts::next_part`.
#[inline(never)]
fn map_next_part(on_map: &mut OnMap<'_>, live: &Live) -> Option<NumberedPart> {
    on_map.next_part(live)
}

/// `HorizonParts::next_grade` and its frame.
#[inline(never)]
fn map_pcc1(on_map: &OnMap<'_>, live: &Live) -> Option<RecordedFrame> {
    on_map.pcc1(live, 0)
}

/// Returns an input that the compiler cannot predict.
fn input<T>() -> Option<T> {
    black_box(None)
}
