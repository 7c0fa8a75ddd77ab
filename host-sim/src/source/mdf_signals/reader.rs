//! Rows of all groups in the order of time.

use super::catalog::{Catalog, Time};
use super::selection::{Selected, Selection};
use super::source::Source;
use super::stream::{Column, Stream};
use crate::error::{Error, Result};
use crate::files::utc::utc_text;
use crate::source::damage::DamageCheck;
use crate::source::frame_log::moved_to_zero;
use crate::source::log_file::LogFile;
use crate::source::log_report::LogReport;
use crate::source::mdf::mdf_file::MdfFile;
use crate::source::read_options::ReadOptions;
use crate::source::signal_table::SignalRow;
use estimator_core::{Instant, Reading, Signal};
use std::collections::{BTreeMap, BTreeSet};

/// Reader of the signals of an MDF file.
pub struct MdfSignals {
    pub(super) file: MdfFile,
    pub(super) catalog: Catalog,
    pub(super) damage: DamageCheck,
    pub(super) selection: Selection,
    streams: Vec<Stream>,
    is_started: bool,
    readings: Vec<Reading>,
    rows: u64,
    /// Time of the first row in the file, µs.
    first_us: Option<i64>,
    /// Signals that no record had so far.
    unseen: Vec<Signal>,
}

impl MdfSignals {
    /// Creates a reader of the channels that become ours.
    pub(super) fn new(
        file: MdfFile,
        catalog: Catalog,
        damage: DamageCheck,
        options: &ReadOptions,
    ) -> Result<Self> {
        let selection = Selection::of(&catalog, options.channels.as_deref(), &options.ignore)?;
        Ok(Self {
            streams: streams(&catalog, &selection),
            unseen: selection.channels.iter().map(|of| of.signal).collect(),
            file,
            catalog,
            damage,
            selection,
            is_started: false,
            readings: Vec::new(),
            rows: 0,
            first_us: None,
        })
    }

    /// Returns the signals that a channel becomes, in the order of [`Signal`].
    pub fn signals(&self) -> impl Iterator<Item = Signal> {
        self.selection.channels.iter().map(|of| of.signal)
    }

    /// Reads the next row: the values of all groups at one time; `None` at the end.
    ///
    /// # Errors
    /// Returns an error, with the file and what was expected, for one without a channel that becomes a
    /// signal, without records, or with too much damage.
    pub fn next_row(&mut self) -> Result<Option<SignalRow<'_>>> {
        if !self.is_started {
            self.start()?;
        }
        let times = self.streams.iter().filter_map(|stream| stream.micros);
        let Some(micros) = times.min() else {
            self.end()?;
            return Ok(None);
        };
        self.readings.clear();
        for stream in &mut self.streams {
            if stream.micros == Some(micros) {
                let (file, damage) = (&mut self.file, &mut self.damage);
                stream.read(file, damage, self.rows, &mut self.readings)?;
                stream.advance(file, damage, self.rows)?;
            }
        }
        self.readings.sort_by_key(|reading| reading.signal);
        if !self.unseen.is_empty() {
            let readings = &self.readings;
            self.unseen
                .retain(|signal| !readings.iter().any(|of| of.signal == *signal));
        }
        self.rows += 1;
        let first_us = *self.first_us.get_or_insert(micros);
        let time = micros.saturating_sub(first_us.min(0));
        Ok(Some(SignalRow {
            time: Instant::from_micros(u64::try_from(time).unwrap_or(0)),
            readings: &self.readings,
        }))
    }

    /// Reads the first record of each stream.
    fn start(&mut self) -> Result<()> {
        self.is_started = true;
        if self.streams.is_empty() {
            let problem = "no channel of this MDF file is one of ours; expected --signals SIGNALS.toml, \
                           which maps them (`roadgrade inspect` lists the channels and proposes one)";
            return Err(Error::content(self.file().path(), problem));
        }
        for stream in &mut self.streams {
            stream.advance(&mut self.file, &mut self.damage, 0)?;
        }
        Ok(())
    }

    /// Checks the whole file at its end.
    fn end(&mut self) -> Result<()> {
        let log = self.file.log();
        if log.is_cut_off() {
            self.damage.cut_off(log.cut_off_error())?;
        }
        for (problem, bytes) in log.packed_damage() {
            self.damage.packed(problem, bytes)?;
        }
        if self.rows > 0 {
            let lines = self.rows + self.damage.found().lines;
            return self.damage.end(lines, self.file.length());
        }
        let problem = "no record of the mapped channels; expected at least one";
        let empty = Error::content(log.path(), problem);
        Err(self.damage.take_first().unwrap_or(empty))
    }

    /// Returns what the reading told so far.
    #[must_use]
    pub fn report(&self) -> LogReport {
        let start_us = self.catalog.origin_us.zip(self.first_us);
        let start_us = start_us.and_then(|(origin, first)| origin.checked_add_signed(first));
        LogReport {
            damage: self.damage.found().clone(),
            start_utc: start_us.and_then(utc_text),
            mended: moved_to_zero(self.first_us).into_iter().collect(),
            notes: self.notes(),
            ..LogReport::default()
        }
    }

    fn notes(&self) -> Vec<String> {
        let mut notes = self.selection.notes.clone();
        if self.rows > 0 && !self.unseen.is_empty() {
            let names: Vec<&str> = self.unseen.iter().map(|signal| signal.column()).collect();
            notes.push(format!("no record has {}", names.join(", ")));
        }
        notes
    }

    /// Returns the file, for progress and messages.
    #[must_use]
    pub const fn file(&self) -> &LogFile {
        self.file.log()
    }
}

/// Returns a stream for each group that has the times of selected channels.
fn streams(catalog: &Catalog, selection: &Selection) -> Vec<Stream> {
    let mut by_group: BTreeMap<usize, Vec<Selected>> = BTreeMap::new();
    for selected in &selection.channels {
        let of_group = by_group.entry(selected.group).or_default();
        of_group.push(selected.clone());
    }
    let mut streams: BTreeMap<usize, Stream> = BTreeMap::new();
    let mut read = BTreeSet::new();
    for (place, channels) in by_group {
        let of = |place: usize| {
            let group = catalog.groups.get(place)?;
            let data = catalog.data_groups.get(group.data_group)?;
            Some((group, Source::new(data, group)))
        };
        let Some((group, source)) = of(place) else {
            continue;
        };
        let with_times = match group.time {
            Time::Remote(master) => master,
            _ => place,
        };
        let Some((times, time_source)) = of(with_times) else {
            continue;
        };
        let Time::Clock(clock) = times.time else {
            continue;
        };
        let stream = streams.entry(with_times).or_insert_with(|| Stream {
            times: Column {
                source: time_source,
                channels: Vec::new(),
            },
            clock,
            columns: Vec::new(),
            repeated: (!read.insert(times.data_group)).then(|| DamageCheck::new(false)),
            micros: None,
        });
        if with_times == place {
            stream.times.channels = channels;
        } else {
            stream.columns.push(Column { source, channels });
        }
    }
    streams.into_values().collect()
}
