//! The groups of a file and their channels.

use super::channel::{Channel, Problem};
use crate::source::mdf::field::Clock;
use crate::source::mdf::group::GroupHead;
use crate::source::mdf::records::Size;
use std::collections::BTreeMap;

/// What a file has.
#[derive(Default)]
pub(super) struct Catalog {
    pub data_groups: Vec<DataGroup>,
    pub groups: Vec<Group>,
    /// True if there are frames of a bus.
    pub has_frames: bool,
    /// Start of the measurement, µs since the Unix epoch.
    pub origin_us: Option<u64>,
}

/// A data group: groups whose records stand in the same data.
#[derive(Clone, Debug)]
pub(super) struct DataGroup {
    pub link: u64,
    pub id_bytes: usize,
    /// By the number of the group.
    pub sizes: BTreeMap<u64, Size>,
    /// True if invalidation bits have blocks of their own (DV, LD; MDF 4.2).
    pub is_columns: bool,
}

/// A channel group.
pub(super) struct Group {
    /// Where its block is.
    pub at: u64,
    /// From 1, in the order of the file.
    pub number: usize,
    pub data_group: usize,
    pub head: GroupHead,
    /// Names of what recorded it: those of the group first.
    pub names: Vec<String>,
    pub time: Time,
    pub channels: Vec<Channel>,
}

/// The time of the records of a group.
#[derive(Clone, Debug)]
pub(super) enum Time {
    Clock(Clock),
    /// That of the records of another group: where its block is.
    OfBlock(u64),
    /// The same: its place among the groups.
    Remote(usize),
    /// There is none; why.
    None(String),
}

impl Catalog {
    /// Returns the number of channels that have numbers with a time.
    pub(super) fn signal_count(&self) -> usize {
        let groups = self.groups.iter();
        let with_time = groups.filter(|group| !matches!(group.time, Time::None(_)));
        let channels = with_time.flat_map(|group| &group.channels);
        channels
            .filter(|channel| !matches!(channel.problem, Some(Problem::NoSignal(_))))
            .count()
    }

    /// Finds the groups whose times others use.
    pub(super) fn link_times(&mut self) {
        let places: BTreeMap<u64, usize> = self
            .groups
            .iter()
            .enumerate()
            .filter(|(_, group)| matches!(group.time, Time::Clock(_)))
            .map(|(place, group)| (group.at, place))
            .collect();
        for group in &mut self.groups {
            if let Time::OfBlock(at) = group.time {
                group.time = match places.get(&at) {
                    Some(place) => Time::Remote(*place),
                    None => Time::None("the group with its times is not there".to_owned()),
                };
            }
        }
    }
}

impl Group {
    /// Returns its name, for tables and messages.
    pub(super) fn label(&self) -> String {
        let name = self.names.first().cloned();
        name.unwrap_or_else(|| self.numbered())
    }

    /// Returns a name that no other group has.
    pub(super) fn numbered(&self) -> String {
        format!("group {}", self.number)
    }

    /// Returns whether this is one of its names.
    pub(super) fn is_named(&self, name: &str) -> bool {
        self.names.iter().any(|own| own == name) || self.numbered() == name
    }
}
