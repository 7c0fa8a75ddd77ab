//! The channels of a log with decoded signals: their table, and a mapping to start from.

use super::census::Census;
use super::dbc_census::DbcSignalCount;
use super::proposal::{Proposal, propose};
use super::text::{align_right, figure, finish, grouped, line, table};
use crate::source::mdf_signals::ChannelCount;
use estimator_core::Signal;

/// Returns the table of the channels; nothing for a log without any.
#[must_use]
pub fn channels_text(channels: &[ChannelCount]) -> String {
    let mut out = String::new();
    if channels.is_empty() {
        return out;
    }
    line(&mut out, "\nChannels");
    let mut table = table(&["group", "channel", "unit", "count", "min", "max", "becomes"]);
    align_right(&mut table, &[3, 4, 5]);
    for channel in channels {
        table.add_row([
            channel.group.clone(),
            channel.channel.clone(),
            channel.unit.clone(),
            grouped(channel.count),
            figure(&channel.channel, channel.min),
            figure(&channel.channel, channel.max),
            channel.signal.unwrap_or_default().to_owned(),
        ]);
    }
    finish(&mut out, &table);
    out
}

/// Proposes channels for the signals of ours that the log does not have yet.
#[must_use]
pub fn propose_channels(census: &Census) -> Vec<Proposal> {
    let is_free = |channel: &&ChannelCount| {
        channel.signal.is_none() && Signal::from_column(&channel.channel).is_none()
    };
    let free = census.channels.iter().filter(is_free);
    let found: Vec<DbcSignalCount> = free
        .map(|channel| DbcSignalCount {
            message: channel.reference.clone().unwrap_or_default(),
            identifier: String::new(),
            signal: channel.channel.clone(),
            unit: channel.unit.clone(),
            count: channel.count,
            min: channel.min,
            max: channel.max,
            usual: None,
        })
        .collect();
    propose(&found, census)
}
