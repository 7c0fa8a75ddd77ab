//! What there is to see of a live estimate.

use crate::source::socketcan::BusEvent;
use estimator_core::{Condition, Counters, Live};
use serde::{Serialize, Serializer};
use std::collections::BTreeMap;

/// Everything that is shown.
#[derive(Clone, Debug)]
pub struct View {
    /// Time of the newest frame, from the first, s.
    pub time_s: f64,
    /// The estimate, once there is one.
    pub live: Option<Live>,
    /// Whether frames come.
    pub is_silent: bool,
    /// Cells finished, with their full lag.
    pub cells_finished: usize,
    /// Grade and sigma of the newest of them, %.
    pub newest_cell_percent: Option<(f32, f32)>,
    /// What the core counted.
    pub counters: Counters,
    /// The interfaces, in the order in which they were named.
    pub interfaces: Vec<InterfaceView>,
    /// Frames that could not be published; `None` if none are to be.
    pub unpublished: Option<u64>,
    /// Frames without a time, where the log's is asked for.
    pub untimed: u64,
}

/// One interface.
#[derive(Clone, Debug, Default, PartialEq, Serialize)]
pub struct InterfaceView {
    /// Its name.
    pub name: String,
    /// Frames taken from it.
    pub frames: u64,
    /// Frames a second, over the last second.
    pub frames_per_s: f64,
    /// Frames that the kernel had to drop because they were not read fast enough.
    pub lost: u64,
    /// What else happened on it.
    #[serde(serialize_with = "by_name")]
    pub events: BTreeMap<BusEvent, u64>,
}

fn by_name<S: Serializer>(events: &BTreeMap<BusEvent, u64>, to: S) -> Result<S::Ok, S::Error> {
    to.collect_map(events)
}

impl View {
    /// What the estimate is worth now, in a word or two.
    #[must_use]
    pub fn mode(&self) -> String {
        match &self.live {
            _ if self.is_silent => "silent".to_owned(),
            None => "waiting".to_owned(),
            Some(live) => mode_of(live.end.condition),
        }
    }

    /// Frames that the kernel dropped, on all interfaces.
    #[must_use]
    pub fn lost(&self) -> u64 {
        self.interfaces.iter().map(|interface| interface.lost).sum()
    }

    /// Events on all interfaces.
    #[must_use]
    pub fn events(&self) -> u64 {
        let counts = |interface: &InterfaceView| interface.events.values().sum::<u64>();
        self.interfaces.iter().map(counts).sum()
    }

    /// Frames a second on all interfaces.
    #[must_use]
    pub fn frames_per_s(&self) -> f64 {
        self.interfaces.iter().map(|i| i.frames_per_s).sum()
    }
}

/// What the model suffers, joined by `+`; `valid` if nothing.
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
