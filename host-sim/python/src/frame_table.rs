//! The frames of a log as a table.

use crate::convert::with_report;
use arrow_array::builder::{
    BinaryBuilder, BooleanBuilder, Float64Builder, UInt8Builder, UInt32Builder,
};
use arrow_array::{ArrayRef, RecordBatch};
use embedded_can::{Frame, Id};
use estimator_core::signal::Pgn;
use host_sim::error::{Error, Result};
use host_sim::source::can_frame::TimedFrame;
use host_sim::source::input::Pace;
use host_sim::source::log::Log;
use host_sim::source::read_options::ReadOptions;
use std::path::Path;
use std::sync::Arc;

/// Reads all frames of a log.
///
/// # Errors
/// Returns the error of the log, and an error for a signal table.
pub fn read(path: &Path, options: &ReadOptions) -> Result<RecordBatch> {
    let mut log = Log::open(path, options)?;
    let Log::Frames(reader) = &mut log else {
        let problem = "has signals and no frames; expected the log of a bus";
        return Err(Error::content(path, problem));
    };
    let mut columns = Columns::default();
    let mut pace = Pace::default();
    while let Some(frame) = reader.next_frame()? {
        columns.push(&frame);
        if pace.is_due() {
            options.stop.check()?;
        }
    }
    Ok(with_report(columns.finish(), &log.report()))
}

#[derive(Default)]
struct Columns {
    time_s: Float64Builder,
    id: UInt32Builder,
    extended: BooleanBuilder,
    remote: BooleanBuilder,
    pgn: UInt32Builder,
    source: UInt8Builder,
    data: BinaryBuilder,
}

impl Columns {
    fn push(&mut self, TimedFrame { time, frame }: &TimedFrame) {
        let (id, group) = match frame.id() {
            Id::Standard(id) => (id.as_raw().into(), None),
            Id::Extended(id) => (id.as_raw(), Some(Pgn::from_raw(id.as_raw()))),
        };
        self.time_s.append_value(time.micros() as f64 / 1e6);
        self.id.append_value(id);
        self.extended.append_value(frame.is_extended());
        self.remote.append_value(frame.is_remote_frame());
        self.pgn.append_option(group.map(|group| group.number));
        self.source.append_option(group.map(|group| group.source));
        self.data.append_value(frame.data());
    }

    fn finish(mut self) -> RecordBatch {
        let columns: [(&str, ArrayRef, bool); 7] = [
            ("time_s", Arc::new(self.time_s.finish()), false),
            ("id", Arc::new(self.id.finish()), false),
            ("extended", Arc::new(self.extended.finish()), false),
            ("remote", Arc::new(self.remote.finish()), false),
            ("pgn", Arc::new(self.pgn.finish()), true),
            ("source", Arc::new(self.source.finish()), true),
            ("data", Arc::new(self.data.finish()), false),
        ];
        RecordBatch::try_from_iter_with_nullable(columns).expect("columns have the same length")
    }
}
