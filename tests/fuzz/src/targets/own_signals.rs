//! Own signals: a `.dbc` file and a `SIGNALS.toml` that decode any frame, or an error that names the
//! file. The input has both files and the bytes of frames, divided by a byte 0x1f.

use crate::as_file;
use embedded_can::{ExtendedId, Frame, Id, StandardId};
use estimator_core::signal::own_message::FrameMatch;
use host_sim::inspect::census::Census;
use host_sim::inspect::dbc_census::DbcCounter;
use host_sim::inspect::proposal::{propose, to_toml};
use host_sim::source::can_frame::CanFrame;
use host_sim::source::own_signals::OwnSignals;
use host_sim::source::own_signals::dbc::Dbc;
use std::path::Path;

/// What divides the parts: no text has it.
const DIVIDER: u8 = 0x1f;

/// Checks an input.
pub fn own_signals(bytes: &[u8]) {
    let mut parts = bytes.splitn(3, |byte| *byte == DIVIDER);
    let mut part = || parts.next().unwrap_or_default();
    let (dbc, toml, payload) = (part(), part(), part());
    as_file(".dbc", dbc, |dbc| {
        as_file(".toml", toml, |toml| check(dbc, toml, payload));
    });
}

fn check(dbc_path: &Path, toml_path: &Path, payload: &[u8]) {
    match OwnSignals::read(dbc_path, toml_path) {
        Ok(own) => own
            .frames()
            .for_each(|frames| decode(&own, frames, payload)),
        Err(error) => {
            let words = error.to_string();
            let is_named = |path: &Path| words.contains(&path.display().to_string());
            assert!(is_named(dbc_path) || is_named(toml_path), "{words}");
        }
    }
    let Ok(dbc) = Dbc::read(dbc_path) else {
        return;
    };
    let mut counter = DbcCounter::new(&dbc);
    for message in dbc.messages() {
        for payload in payload.chunks(8) {
            if let Some(frame) = frame(message.frames, payload) {
                counter.add(&frame);
            }
        }
    }
    // What is proposed is a mapping that can be read.
    let toml = to_toml(&propose(&counter.finish(), &Census::default()));
    assert!(toml::from_str::<toml::Table>(&toml).is_ok(), "{toml}");
}

fn decode(own: &OwnSignals, frames: FrameMatch, payload: &[u8]) {
    for payload in payload.chunks(8) {
        if let Some(frame) = frame(frames, payload) {
            own.decode(&frame, |reading| {
                assert!(
                    reading.value.real().is_none_or(f32::is_finite),
                    "{reading:?}"
                );
            });
        }
    }
}

fn frame(frames: FrameMatch, payload: &[u8]) -> Option<CanFrame> {
    let id = match frames {
        FrameMatch::Standard(id) => Id::from(StandardId::new(id)?),
        FrameMatch::Extended(id) => Id::from(ExtendedId::new(id)?),
        FrameMatch::Group(pgn) => Id::from(ExtendedId::new(pgn << 8)?),
    };
    CanFrame::new(id, payload)
}
