//! `roadgrade replay`: a recorded log on an interface.

use crate::error::{Error, Result};
use crate::live::replay::{Pace, Replay, Sent};
use crate::live::stop_flag;
use crate::source::candump::CandumpReader;
use crate::source::log_kind::{LogKind, kind_of};
use crate::source::log_time;
use crate::source::socketcan::{Sender, of_group};
use crate::terminal::print::print;
use crate::terminal::progress;
use crate::terminal::table::text_table;
use serde_json::json;
use std::path::PathBuf;
use std::time::Instant as Monotonic;

/// Frames between two moves of the progress bar.
const BAR_STEP: u64 = 256;

/// Arguments of `replay`.
#[derive(Debug, clap::Args)]
#[command(after_help = "\
Frames go out at the times that the log has, or so many times faster. All frames of the log are sent, whatever interfaces it names.

While the interface's queue is full (ENOBUFS) replay waits. A virtual interface has no such limit: with --speed max frames come faster than any listener reads them, and what does not fit into the listener's buffer is lost there; `roadgrade listen` counts such frames as lost.

--log-time sends the log's own time ahead of each change of it (PGN 65352, eight bytes, of the range for manufacturers), and asks the listener every hundred frames whether it has read them. `roadgrade listen --log-time` answers and takes the log's time for that of the frames: nothing is lost at any speed, and its cells are those that `roadgrade estimate` finds in the file, to the last digit. Replay waits ten seconds for the listener to appear. Without --log-time frames have the kernel's stamps: at speed 1 they differ from the log's by fractions of a millisecond, and so the cells by fractions of their sigma; at another speed an estimate from them is of a vehicle so many times faster, and of no use.

Examples:
  roadgrade replay --can vcan0 drive.log
  roadgrade replay --can vcan0 --speed 10 --log-time drive.log.gz
  roadgrade replay --can vcan0 --speed max --log-time drive.log")]
pub struct Args {
    /// CAN interface.
    #[arg(long = "can", value_name = "INTERFACE")]
    interface: String,
    /// Times faster than the log's own time, such as 1, 10 or 0.5; or max.
    #[arg(long, default_value = "1", value_parser = pace)]
    speed: Pace,
    /// Send the log's own time along, for `listen --log-time`.
    #[arg(long)]
    log_time: bool,
    /// Print the summary as JSON.
    #[arg(long)]
    json: bool,
    /// candump log (either layout, also .gz).
    log: PathBuf,
}

fn pace(text: &str) -> std::result::Result<Pace, String> {
    if text == "max" {
        return Ok(Pace::Max);
    }
    let is_speed = |factor: &f64| (1e-3..=1e6).contains(factor);
    let factor = text.parse().ok().filter(is_speed);
    factor
        .map(Pace::Times)
        .ok_or_else(|| "expected a number from 0.001 to 1000000, or max".to_owned())
}

/// Runs it.
pub fn run(args: &Args) -> Result<()> {
    if kind_of(&args.log)? == LogKind::SignalTable {
        let problem = "is a signal table; expected a candump log, frames of a bus";
        return Err(Error::content(&args.log, problem));
    }
    let mut log = CandumpReader::open(&args.log)?;
    let filters = if args.log_time {
        vec![of_group(log_time::PGN)]
    } else {
        Vec::new()
    };
    let sender = Sender::open(&args.interface, &filters)?;
    let stop = stop_flag()?;
    let bar = progress::bytes(log.file().bytes_total());
    let begun = Monotonic::now();
    let mut replay = Replay::new(&args.interface, sender, args.speed, args.log_time, &stop);
    let mut frames = 0_u64;
    while let Some(frame) = log.next_frame()? {
        if !replay.send(&frame)? {
            break;
        }
        frames += 1;
        if frames.is_multiple_of(BAR_STEP) {
            bar.set_position(log.file().bytes_read());
        }
    }
    let sent = replay.end()?;
    bar.finish_and_clear();
    print(&summary(args, &sent, begun.elapsed().as_secs_f64()))
}

fn summary(args: &Args, sent: &Sent, seconds: f64) -> String {
    let log_s = sent.span.map_or(0.0, |(first, last)| {
        last.since(first).micros() as f64 * 1e-6
    });
    let latest_ms = sent.latest.as_secs_f64() * 1e3;
    let rate = sent.frames as f64 / seconds.max(1e-6);
    if args.json {
        let summary = json!({
            "frames": sent.frames,
            "log_s": log_s,
            "duration_s": seconds,
            "frames_per_s": rate,
            "latest_ms": latest_ms,
        });
        return format!("{summary}\n");
    }
    let row = |name: &str, unit: &str, value: String| vec![name.to_owned(), unit.to_owned(), value];
    let mut rows = vec![
        row("frames sent", "", sent.frames.to_string()),
        row("of the log", "s", format!("{log_s:.1}")),
        row("sent in", "s", format!("{seconds:.1}")),
        row("rate", "frames/s", format!("{rate:.0}")),
    ];
    if args.speed != Pace::Max {
        rows.push(row("late at most", "ms", format!("{latest_ms:.2}")));
    }
    format!("{}\n", text_table(&["", "unit", "value"], &rows, 2))
}
