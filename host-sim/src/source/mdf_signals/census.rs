//! What the channels have: the number of values and their range.

use super::catalog::{Catalog, DataGroup, Group, Time};
use super::channel::{Channel, Record};
use super::reader::MdfSignals;
use super::source::Source;
use crate::error::Result;
use crate::numeric::rounding::round;
use crate::source::damage::DamageCheck;
use crate::source::mdf::conversion::Converted;
use crate::source::mdf::mdf_file::MdfFile;
use crate::source::mdf::records::{Records, Step};
use rustc_hash::FxHashMap;
use serde::Serialize;

/// Statistics of one channel.
#[derive(Clone, Debug, Serialize)]
pub struct ChannelCount {
    /// Name of its group.
    pub group: String,
    /// The name of the group that a mapping needs: the channel is in several.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub reference: Option<String>,
    /// Its name.
    pub channel: String,
    /// Unit, as the file writes it.
    pub unit: String,
    /// Number of values.
    pub count: u64,
    /// Smallest number, in `unit`; `None` without one.
    pub min: Option<f64>,
    /// Largest number.
    pub max: Option<f64>,
    /// The signal of ours that it becomes.
    pub signal: Option<&'static str>,
}

#[derive(Clone, Copy)]
struct Seen {
    count: u64,
    min: f64,
    max: f64,
}

impl MdfSignals {
    /// Counts the values of all channels that have numbers and a time. Reads the whole file.
    ///
    /// # Errors
    /// Returns an error of the disk, and, where no channel is mapped, what the damage of the file does
    /// not allow.
    pub fn census(&mut self) -> Result<Vec<ChannelCount>> {
        // The rows of mapped channels tell the damage too.
        let mut repeated = DamageCheck::new(false);
        let is_told = self.selection.channels.is_empty();
        let damage = if is_told {
            &mut self.damage
        } else {
            &mut repeated
        };
        let references = References::of(&self.catalog);
        let mut tallies: Vec<Tally> = self.catalog.groups.iter().map(Tally::of).collect();
        for (place, data) in self.catalog.data_groups.iter().enumerate() {
            let groups = self.catalog.groups.iter().zip(&mut tallies);
            let mut groups: Vec<_> = groups
                .filter(|(group, tally)| group.data_group == place && !tally.channels.is_empty())
                .collect();
            match &mut groups[..] {
                [] => {}
                [(group, tally)] => {
                    let mut source = Source::new(data, group);
                    while source.advance(&mut self.file, damage)? {
                        tally.add(source.record());
                    }
                }
                _ => count_together(data, &mut groups, &mut self.file, damage)?,
            }
        }
        let mut counts = Vec::new();
        for (place, (group, tally)) in self.catalog.groups.iter().zip(tallies).enumerate() {
            for (channel, seen) in tally.channels.into_iter().zip(tally.seen) {
                let selected = self.selection.channels.iter();
                let mut selected =
                    selected.filter(|of| of.group == place && of.channel.name == channel.name);
                counts.push(ChannelCount {
                    group: label(&self.catalog, group),
                    reference: references.reference(group, channel),
                    channel: channel.name.clone(),
                    unit: channel.unit.clone(),
                    count: seen.count,
                    min: seen.min.is_finite().then(|| round(seen.min, 7)),
                    max: seen.max.is_finite().then(|| round(seen.max, 7)),
                    signal: selected.next().map(|of| of.signal.column()),
                });
            }
        }
        Ok(counts)
    }
}

/// Counts the records of several groups that stand in the same data.
fn count_together(
    data: &DataGroup,
    groups: &mut [(&Group, &mut Tally)],
    file: &mut MdfFile,
    damage: &mut DamageCheck,
) -> Result<()> {
    let mut records = Records::new(data.link, data.id_bytes, data.sizes.clone());
    let mut is_lost = false;
    loop {
        match records.next(file, damage)? {
            Step::Record { id, length } => {
                let bytes = records.record(length);
                let found = groups.iter_mut().find(|(group, _)| group.head.id == id);
                if let Some((_, tally)) = found {
                    tally.add(Record {
                        bytes,
                        marks: bytes,
                        index: (!is_lost).then_some(tally.records),
                    });
                }
            }
            Step::Lost => is_lost = true,
            Step::End => return Ok(()),
        }
    }
}

/// Returns the name of a group, or that of the group with its times.
fn label(catalog: &Catalog, group: &Group) -> String {
    match group.time {
        Time::Remote(master) if group.names.is_empty() => catalog.groups.get(master),
        _ => None,
    }
    .unwrap_or(group)
    .label()
}

/// How many channels have a name, and a name in groups of a name.
struct References<'a> {
    names: FxHashMap<&'a str, u32>,
    within: FxHashMap<(&'a str, &'a str), u32>,
}

impl<'a> References<'a> {
    fn of(catalog: &'a Catalog) -> Self {
        let mut names = FxHashMap::default();
        let mut within = FxHashMap::default();
        for group in &catalog.groups {
            for channel in &group.channels {
                *names.entry(&*channel.name).or_default() += 1;
                for (k, name) in group.names.iter().enumerate() {
                    if !group.names[..k].contains(name) {
                        *within.entry((&**name, &*channel.name)).or_default() += 1;
                    }
                }
            }
        }
        Self { names, within }
    }

    /// Returns the name of a group that tells a channel from those of the same name; `None` if there
    /// is no other one.
    fn reference(&self, group: &Group, channel: &Channel) -> Option<String> {
        let name = &*channel.name;
        if self.names.get(name) == Some(&1) {
            return None;
        }
        let label = group.label();
        let is_alone = self.within.get(&(&*label, name)) == Some(&1);
        Some(if is_alone { label } else { group.numbered() })
    }
}

/// The channels of a group, and what they had so far.
struct Tally<'a> {
    channels: Vec<&'a Channel>,
    seen: Vec<Seen>,
    records: u64,
}

impl<'a> Tally<'a> {
    fn of(group: &'a Group) -> Self {
        let is_read =
            |channel: &&Channel| channel.problem.is_none() && !matches!(group.time, Time::None(_));
        let channels: Vec<&Channel> = group.channels.iter().filter(is_read).collect();
        Self {
            seen: vec![Seen::NONE; channels.len()],
            channels,
            records: 0,
        }
    }

    fn add(&mut self, record: Record) {
        self.records += 1;
        for (channel, seen) in self.channels.iter().zip(&mut self.seen) {
            seen.add(channel, record);
        }
    }
}

impl Seen {
    const NONE: Self = Self {
        count: 0,
        min: f64::INFINITY,
        max: f64::NEG_INFINITY,
    };

    fn add(&mut self, channel: &Channel, record: Record) {
        let number = channel.raw(record).and_then(|raw| channel.convert(raw));
        if let Some(Converted::Number(number)) = number {
            self.count += 1;
            self.min = self.min.min(number);
            self.max = self.max.max(number);
        }
    }
}
