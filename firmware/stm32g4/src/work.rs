//! The loop of the estimator: reads the inbox, sends the estimate, stores the persistent state.

use crate::inbox::{InboxItem, InboxReceiver};
use crate::store::FlashStore;
use embassy_futures::select::select;
use embassy_stm32::can::{CanTx, Frame, Properties};
use embassy_stm32::peripherals::IWDG;
use embassy_stm32::wdg::IndependentWatchdog;
use embassy_time::{Duration, Ticker, with_timeout};
use estimator_core::{Cell, Disagreement, Estimator, Live, Step, Tuning, broadcast};
use firmware::map_region;
use firmware::on_map::OnMap;
use static_cell::StaticCell;

/// J1939 source address of this controller: free for any use on the vehicle.
const SOURCE: u8 = 0xFE;
/// Period of the sent estimate.
const PERIOD: Duration = Duration::from_millis(100);
/// Ticks from one status to the next, 1 s, unless a switch in it changes.
const STATUS_TICKS: u32 = 10;
/// Longest wait for a mailbox. Frames are dropped while the bus is off.
const SENDING: Duration = Duration::from_millis(5);
/// Ticks without a new cell after which the vehicle counts as standing: 10 s. Cells since the last
/// write after which a stop is worth a write: 1 km.
const STANDS_TICKS: u32 = 100;
const WORTH_CELLS: u32 = 400;

/// Static, since it is too large for a stack. Its size can be read from the image.
static ESTIMATOR: StaticCell<Estimator<f32>> = StaticCell::new();
static ON_MAP: StaticCell<OnMap<'static>> = StaticCell::new();

/// Creates the estimator of the flashed vehicle, with the persistent state of the last drive.
/// Returns `None` and logs the reason if there is no possible vehicle.
pub async fn estimator(store: &mut FlashStore) -> Option<&'static mut Estimator<f32>> {
    let model = match store.model() {
        Ok(model) => model,
        Err(error) => {
            let error = defmt::Display2Format(&error);
            defmt::error!("no usable vehicle is flashed ({}): no estimate", error);
            return None;
        }
    };
    let estimator = match Estimator::new_in(ESTIMATOR.uninit(), model, &Tuning::default()) {
        Ok(estimator) => estimator,
        Err(problem) => {
            defmt::error!("no such vehicle: {}", problem);
            return None;
        }
    };
    if let Some(state) = store.persistent_state().await
        && let Err(problem) = estimator.resume(&state)
    {
        defmt::warn!("the state of the last drive is not used: {}", problem);
    }
    Some(estimator)
}

/// Opens the flashed map. Returns `None` and logs the reason if there is none.
pub fn on_map() -> Option<&'static mut OnMap<'static>> {
    match map_region::open() {
        Ok(map) => {
            defmt::info!("a map of {} bytes", map.len());
            Some(ON_MAP.init_with(|| OnMap::new(map)))
        }
        Err(error) => {
            let error = defmt::Display2Format(&error);
            defmt::info!("no map is flashed ({}): the road ahead is not told", error);
            None
        }
    }
}

/// Runs the loop, forever.
pub async fn run(
    mut estimator: Option<&'static mut Estimator<f32>>,
    mut on_map: Option<&'static mut OnMap<'static>>,
    mut inbox: InboxReceiver,
    mut sender: CanTx<'static>,
    bus: Properties,
    mut store: FlashStore,
    mut watchdog: IndependentWatchdog<'static, IWDG>,
) -> ! {
    watchdog.unleash();
    let mut ticker = Ticker::every(PERIOD);
    let mut stop = Stop::default();
    let mut lost = 0;
    let mut newest = None;
    let mut status = Status::default();
    loop {
        let woken = select(ticker.next(), inbox.arrived()).await;
        while let Some(input) = inbox.take() {
            if let Some(estimator) = estimator.as_deref_mut() {
                take(estimator, on_map.as_deref_mut(), &input);
                while let Some(cell) = estimator.next_cell() {
                    if let Some(on_map) = on_map.as_deref_mut() {
                        on_map.finish(&cell);
                    }
                    send(&mut sender, broadcast::cell(&cell, SOURCE)).await;
                    newest = Some(cell);
                }
            }
        }
        if woken.is_second() {
            continue;
        }
        watchdog.pet();
        let live = estimator.as_deref().and_then(Estimator::live);
        let live = match (&on_map, live) {
            (Some(on_map), Some(live)) => Some(on_map.map().applied(&live)),
            (_, live) => live,
        };
        send(&mut sender, broadcast::live(live.as_ref(), SOURCE)).await;
        if let (Some(on_map), Some(live)) = (on_map.as_deref_mut(), &live) {
            send(&mut sender, on_map.pcc1(live, SOURCE)).await;
            for frame in on_map.ahead_frames(live, SOURCE) {
                send(&mut sender, Some(frame)).await;
            }
        }
        if status.is_due(live.as_ref(), newest.as_ref()) {
            let suspect = estimator
                .as_deref()
                .map_or(0, |estimator| estimator.counters().cells_suspect);
            let frame = broadcast::status(live.as_ref(), newest.as_ref(), suspect, SOURCE);
            send(&mut sender, frame).await;
        }
        if inbox.lost() != lost {
            lost = inbox.lost();
            defmt::warn!("{} inputs found the queue full", lost);
        }
        if let Some(estimator) = estimator.as_deref()
            && stop.is_worth_keeping(estimator.live().map_or(0, |live| live.end.cell))
            && let Some(state) = estimator.persistent_state()
        {
            let stored = store.save(&state).await;
            defmt::info!("state saved: {}, bus {}", stored, bus.bus_error_mode());
            defmt::info!("{}", estimator.counters());
            if let Some(on_map) = on_map.as_deref() {
                defmt::info!("{}", on_map.map().counters());
            }
        }
    }
}

fn take(
    estimator: &mut Estimator<f32>,
    mut on_map: Option<&mut OnMap<'static>>,
    input: &InboxItem,
) {
    match input {
        InboxItem::Frame(time, frame) => estimator.on_frame(*time, frame),
        InboxItem::Reading(time, reading) => estimator.on_reading(*time, *reading),
    };
    while let Some(step) = estimator.step() {
        if step != Step::Moved {
            continue;
        }
        if let (Some(on_map), Some(live)) = (on_map.as_deref_mut(), estimator.live()) {
            on_map.advance(&live);
        }
    }
}

async fn send(sender: &mut CanTx<'static>, frame: Option<Frame>) {
    if let Some(frame) = frame {
        let _ = with_timeout(SENDING, sender.write(&frame)).await;
    }
}

/// When the status is sent: once a second, and when a switch in it has changed.
#[derive(Default)]
struct Status {
    ticks: u32,
    switches: Option<(Option<Disagreement>, Option<bool>)>,
}

impl Status {
    /// At each tick; true if the status is due.
    fn is_due(&mut self, live: Option<&Live>, newest: Option<&Cell>) -> bool {
        let switches = Some((
            live.map(|live| live.disagreement),
            newest.map(|cell| cell.lagged_consistent),
        ));
        self.ticks = self.ticks.saturating_add(1);
        let is_due = self.ticks >= STATUS_TICKS || self.switches != switches;
        if is_due {
            (self.ticks, self.switches) = (0, switches);
        }
        is_due
    }
}

/// The state of standing: how long the vehicle stands, and the cell of the last write.
#[derive(Default)]
struct Stop {
    cell: u32,
    ticks: u32,
    kept_cell: u32,
}

impl Stop {
    /// Takes the newest cell at each tick. Returns true once at each stop that is worth a write.
    fn is_worth_keeping(&mut self, cell: u32) -> bool {
        if cell != self.cell {
            (self.cell, self.ticks) = (cell, 0);
            return false;
        }
        self.ticks = self.ticks.saturating_add(1);
        let is_worth = self.ticks == STANDS_TICKS && cell - self.kept_cell >= WORTH_CELLS;
        if is_worth {
            self.kept_cell = cell;
        }
        is_worth
    }
}
