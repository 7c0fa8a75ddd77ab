//! The view of a live estimate.

use super::road_view::RoadView;
use crate::files::flash_image::RoadMemoryFile;
use crate::source::socketcan::BusEvent;
use estimator_core::roadmap::memory::MemoryCounters;
use estimator_core::{Condition, Counters, Live, Uncertain};
use serde::{Serialize, Serializer};
use std::collections::BTreeMap;

/// Everything that the panel, the lines and the JSON output show.
#[derive(Clone, Debug)]
pub struct LiveView {
    /// Time of the newest frame since the first frame, s.
    pub time_s: f64,
    /// The estimate, once there is one; with the map where it counts.
    pub live: Option<Live>,
    /// The map and the road ahead; `None` without a map.
    pub road: Option<RoadView>,
    /// The roads that the vehicle has learned; `None` without a road memory.
    pub memory: Option<MemoryView>,
    /// True if no frame has arrived for two seconds.
    pub is_silent: bool,
    /// Number of finished cells (those with their full lag).
    pub cells_finished: usize,
    /// Grade and sigma of the newest of them, %.
    pub newest_cell_percent: Option<(f32, f32)>,
    /// Counters of the core.
    pub counters: Counters,
    /// The interfaces, in the order of the command line.
    pub interfaces: Vec<InterfaceView>,
    /// Number of frames that could not be published; `None` if publishing is off.
    pub unpublished: Option<u64>,
    /// Number of frames without a log time stamp, with `--log-time`.
    pub untimed: u64,
}

/// What the road memory knows and learns.
#[derive(Clone, Copy, Debug)]
pub struct MemoryView {
    /// Its grade under the wheels, %, where it counts.
    pub grade_percent: Option<Uncertain>,
    /// What the drive gave.
    pub counters: MemoryCounters,
}

impl MemoryView {
    /// Returns what there is to see.
    #[must_use]
    pub fn of(memory: &RoadMemoryFile) -> Self {
        Self {
            grade_percent: memory.grade().map(|grade| grade.grade_percent),
            counters: memory.counters(),
        }
    }
}

/// One interface.
#[derive(Clone, Debug, Default, PartialEq, Serialize)]
pub struct InterfaceView {
    /// Its name.
    pub name: String,
    /// Number of frames received.
    pub frames: u64,
    /// Frame rate over the last second, 1/s.
    pub frames_per_s: f64,
    /// Number of frames that the kernel dropped because they were not read fast enough.
    pub lost: u64,
    /// Number of bus events, by event.
    #[serde(serialize_with = "by_name")]
    pub events: BTreeMap<BusEvent, u64>,
}

fn by_name<S: Serializer>(events: &BTreeMap<BusEvent, u64>, to: S) -> Result<S::Ok, S::Error> {
    to.collect_map(events)
}

impl LiveView {
    /// Returns the mode: `silent`, `waiting`, `valid`, or the conditions in which the model does not
    /// hold, joined by `+`.
    #[must_use]
    pub fn mode(&self) -> String {
        match &self.live {
            _ if self.is_silent => "silent".to_owned(),
            None => "waiting".to_owned(),
            Some(live) => mode_of(live.end.condition),
        }
    }

    /// Returns the number of frames that the kernel dropped, on all interfaces.
    #[must_use]
    pub fn lost(&self) -> u64 {
        self.interfaces.iter().map(|interface| interface.lost).sum()
    }

    /// Returns the number of events on all interfaces.
    #[must_use]
    pub fn events(&self) -> u64 {
        let counts = |interface: &InterfaceView| interface.events.values().sum::<u64>();
        self.interfaces.iter().map(counts).sum()
    }

    /// Returns the frame rate of all interfaces together, 1/s.
    #[must_use]
    pub fn frames_per_s(&self) -> f64 {
        self.interfaces.iter().map(|i| i.frames_per_s).sum()
    }
}

/// Returns the conditions in which the model does not hold, joined by `+`, or `valid`.
fn mode_of(condition: Condition) -> String {
    let Condition {
        shifting,
        braking,
        no_traction,
        crawling,
    } = condition;
    let words: Vec<&str> = [
        (shifting, "shifting"),
        (braking, "braking"),
        (no_traction, "no-traction"),
        (crawling, "crawling"),
    ]
    .into_iter()
    .filter_map(|(is_so, word)| is_so.then_some(word))
    .collect();
    if words.is_empty() {
        "valid".to_owned()
    } else {
        words.join("+")
    }
}
