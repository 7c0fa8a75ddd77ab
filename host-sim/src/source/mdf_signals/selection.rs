//! Which channels become signals of ours: those that a `SIGNALS.toml` names, and those that have the
//! name of one.

use super::catalog::{Catalog, Group, Time};
use super::channel::{Channel, Problem};
use crate::error::{Error, Result};
use crate::files::nearest::nearest_in_words;
use crate::source::own_signals::ChannelMapping;
use crate::source::own_signals::mapping_file::{Located, MappingEntry, MappingFile};
use crate::source::own_signals::units;
use crate::source::signal_range::unit;
use estimator_core::Signal;

/// Channels that are named in one note.
const FEW: usize = 5;

/// A channel that becomes a signal of ours.
#[derive(Clone, Debug)]
pub(super) struct Selected {
    pub signal: Signal,
    /// Its group's place in the catalogue.
    pub group: usize,
    pub channel: Channel,
    /// From the unit of the channel to ours.
    pub scale: f64,
    pub offset: f64,
    /// Raw numbers that mean "not available".
    pub invalid: Vec<i64>,
    /// Raw numbers with a value of their own.
    pub values: Vec<(i64, f64)>,
}

/// The selected channels, and what to tell of the others.
#[derive(Default)]
pub(super) struct Selection {
    /// In the order of [`Signal`].
    pub channels: Vec<Selected>,
    pub notes: Vec<String>,
}

/// A channel and its group's place.
pub(super) type Place<'a> = (usize, &'a Group, &'a Channel);

impl Selection {
    /// Selects channels.
    ///
    /// # Errors
    /// Names the line and the key of the mapping that does not fit the file.
    pub(super) fn of(
        catalog: &Catalog,
        mapping: Option<&ChannelMapping>,
        ignored: &[Signal],
    ) -> Result<Self> {
        let mut selection = Self::default();
        let mut unknown = Vec::new();
        let entries = mapping.map_or(&[][..], |mapping| &mapping.file().entries);
        if let Some(mapping) = mapping {
            for entry in entries {
                let selected = mapped(catalog, mapping.file(), entry)?;
                let has_unit = !unit(entry.signal).is_empty();
                let is_told = entry.scale.is_some() || entry.offset.is_some();
                if has_unit && !is_told && units::is_none(&selected.channel.unit) {
                    unknown.push(entry.source.value.clone());
                }
                selection.channels.push(selected);
            }
        }
        for signal in Signal::ALL.iter().copied() {
            if !entries.iter().any(|entry| entry.signal == signal) {
                selection.take_by_name(catalog, signal);
            }
        }
        selection.note("there is no unit, and ours is taken for it", &unknown);
        selection.note("channels that are not read", &unreadable(catalog));
        selection
            .channels
            .retain(|of| !ignored.contains(&of.signal));
        selection.channels.sort_by_key(|of| of.signal);
        Ok(selection)
    }

    /// Takes the channel that has the name of a signal, in a unit that fits.
    fn take_by_name(&mut self, catalog: &Catalog, signal: Signal) {
        let name = signal.column();
        let found = named(catalog, name, None);
        let [(group, of, channel)] = found[..] else {
            if found.len() > 1 {
                let problem = "is a channel of several groups; map it by --signals";
                self.notes.push(format!("{name} {problem}"));
            }
            return;
        };
        if problem_of(of, channel).is_some() {
            return;
        }
        if units::is_doubtful(&channel.unit, signal) {
            let unit = channel.unit.escape_debug();
            let problem = format!("{name} is a channel in `{unit}`; map it by --signals");
            self.notes.push(problem);
            return;
        }
        let (scale, offset) = units::conversion(&channel.unit, signal).unwrap_or((1.0, 0.0));
        self.channels.push(Selected {
            signal,
            group,
            channel: channel.clone(),
            scale,
            offset,
            invalid: Vec::new(),
            values: Vec::new(),
        });
    }

    fn note(&mut self, what: &str, names: &[String]) {
        let Some((first, rest)) = names.split_at_checked(names.len().min(FEW)) else {
            return;
        };
        let first = first.join(", ");
        match (names.len(), rest.len()) {
            (0, _) => {}
            (_, 0) => self.notes.push(format!("{what}: {first}")),
            (_, left) => self.notes.push(format!("{what}: {first} and {left} more")),
        }
    }
}

/// Returns the channels that should be numbers and are not read, each with why.
fn unreadable(catalog: &Catalog) -> Vec<String> {
    let channels = catalog.groups.iter().flat_map(|group| &group.channels);
    let told = channels.filter_map(|channel| match &channel.problem {
        Some(Problem::Unreadable(why)) => Some(format!("{} (which {why})", channel.name)),
        _ => None,
    });
    told.collect()
}

/// Returns the channels with a name, whole or without its device, of one group or of all.
pub(super) fn named<'a>(catalog: &'a Catalog, name: &str, group: Option<&str>) -> Vec<Place<'a>> {
    let matching = |is_named: fn(&Channel, &str) -> bool| {
        let groups = catalog.groups.iter().enumerate();
        let groups = groups.filter(|(_, of)| group.is_none_or(|group| of.is_named(group)));
        let channels = groups.flat_map(|(at, of)| of.channels.iter().map(move |c| (at, of, c)));
        channels
            .filter(|(_, _, channel)| is_named(channel, name))
            .collect::<Vec<_>>()
    };
    let whole = matching(Channel::is_named);
    if whole.is_empty() {
        return matching(Channel::is_named_without_device);
    }
    whole
}

/// Returns why a channel gives no signal.
fn problem_of<'a>(group: &'a Group, channel: &'a Channel) -> Option<String> {
    match (&channel.problem, &group.time) {
        (Some(problem), _) => Some(format!("which {}", problem.words())),
        (None, Time::None(why)) => Some(why.clone()),
        _ => None,
    }
}

/// Finds the channel that an entry names.
fn mapped(catalog: &Catalog, file: &MappingFile, entry: &MappingEntry) -> Result<Selected> {
    let source = &entry.source;
    let error = |of: &Located<String>, key: &str, problem: &str, expected: String| -> Error {
        let (name, value) = (entry.signal.column(), of.value.escape_debug());
        file.error(
            of.line,
            format!("signals.{name}.{key} is `{value}`{problem}"),
            expected,
        )
    };
    let message = entry.message.as_ref();
    if let Some(message) = message
        && !catalog.groups.iter().any(|of| of.is_named(&message.value))
    {
        let mut labels: Vec<String> = catalog.groups.iter().map(Group::label).collect();
        labels.dedup();
        let alike = nearest_in_words(&message.value, labels.iter().map(String::as_str));
        return Err(error(
            message,
            "message",
            "",
            format!("a group such as {alike}"),
        ));
    }
    let group = message.map(|message| &*message.value);
    let found = named(catalog, &source.value, group);
    let (at, of, channel) = match &found[..] {
        [one] => *one,
        [] => {
            let groups = catalog.groups.iter();
            let groups = groups.filter(|of| group.is_none_or(|group| of.is_named(group)));
            let channels = groups.flat_map(|of| &of.channels).map(|c| &*c.name);
            let alike = nearest_in_words(&source.value, channels);
            let of = group.map(|group| format!(" of group {}", group.escape_debug()));
            let expected = format!("a channel{}, such as {alike}", of.unwrap_or_default());
            return Err(error(source, "signal", "", expected));
        }
        several => {
            // Groups of the same name are told by their numbers.
            let mut labels: Vec<String> = several.iter().map(|(_, of, _)| of.label()).collect();
            labels.sort();
            labels.dedup();
            let is_told = labels.len() == several.len();
            let names = several.iter().take(FEW).map(|(_, of, _)| {
                let name = if is_told { of.label() } else { of.numbered() };
                format!("`{name}`")
            });
            let names = names.collect::<Vec<_>>().join(", ");
            let expected = format!("message with the name of one, such as {names}");
            let problem = ", a channel of several groups";
            return Err(error(source, "signal", problem, expected));
        }
    };
    if let Some(problem) = problem_of(of, channel) {
        let expected = "a channel of numbers with a time".to_owned();
        return Err(error(source, "signal", &format!(", {problem}"), expected));
    }
    let (scale, offset) = units::conversion_of(file, entry, &channel.name, &channel.unit)?;
    Ok(Selected {
        signal: entry.signal,
        group: at,
        channel: channel.clone(),
        scale,
        offset,
        invalid: entry.invalid.clone(),
        values: entry.values.clone(),
    })
}
