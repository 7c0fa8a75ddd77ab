//! `roadgrade replay`: sends a recorded log on an interface.

use super::log_options::FrameOptions;
use super::{log_files, log_notes};
use crate::error::{Error, Result};
use crate::live::replay::{Pace, Replay, Sent};
use crate::live::stop_flag;
use crate::source::log::Log;
use crate::source::log_time;
use crate::source::socketcan::{FrameSender, of_group};
use crate::terminal::print::print;
use crate::terminal::progress;
use crate::terminal::table::text_table;
use serde_json::json;
use std::path::PathBuf;
use std::time::Instant as Monotonic;

/// Frames between two updates of the progress bar.
const BAR_STEP: u64 = 256;

/// Arguments of `replay`.
#[derive(Debug, clap::Args)]
#[command(
    after_help = "Example:\n  roadgrade replay --can vcan0 drive.log",
    after_long_help = "\
Frames are sent at the times of the log, or faster by a factor. All frames of the log are sent, whatever interface it names for them; what two interfaces heard is sent once.

While the queue of the interface is full (ENOBUFS), replay waits. A virtual interface has no such limit. With --speed max its frames arrive faster than a listener can read them, and frames that do not fit into the buffer of the listener are lost. `roadgrade listen` counts them as lost.

--log-time sends the log's time stamp whenever it changes (PGN 65352, eight bytes, in the manufacturer range), and asks the listener for an acknowledgement every hundred frames. `roadgrade listen --log-time` acknowledges, and uses the log's time stamps. No frame is lost at any speed, and the cells equal those of `roadgrade estimate` to the last digit. Replay waits ten seconds for a listener. Without --log-time, frames have the kernel's time stamps. At speed 1 these differ from the log's by fractions of a millisecond, and the cells by fractions of their sigma. At any other speed an estimate from them is useless, because the time scale is wrong.

Examples:
  roadgrade replay --can vcan0 drive.log
  roadgrade replay --can vcan0 --speed 10 --log-time drive.log.gz
  roadgrade replay --can vcan0 --speed max --log-time drive.log"
)]
pub struct Args {
    /// CAN interface.
    #[arg(long = "can", value_name = "INTERFACE")]
    interface: String,
    /// Speed relative to the log, such as 1, 10 or 0.5; or max.
    #[arg(long, default_value = "1", value_parser = pace)]
    speed: Pace,
    /// Send the log's time stamps too, for `listen --log-time`.
    #[arg(long)]
    log_time: bool,
    #[command(flatten)]
    reading: FrameOptions,
    /// Print the summary as JSON.
    #[arg(long, hide_short_help = true)]
    json: bool,
    /// Log of frames: candump, ASC, TRC, BLF, MDF 4, pcap, BUSMASTER, CSV of SavvyCAN, python-can or CANedge,
    /// NMEA 2000 as text; plain, gzip or zstd.
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

/// Runs the command.
pub fn run(args: &Args) -> Result<()> {
    let options = args.reading.read_options();
    let path = &log_files::one(&args.log, &options)?;
    let mut log = match Log::open(path, &options)? {
        Log::Frames(log) => log,
        other => {
            let what = match other {
                Log::Signals(_) => "has decoded signals",
                _ => "is a signal table",
            };
            let problem = format!(
                "{what}; expected a candump log, or one in ASC, TRC, BLF or MDF with frames"
            );
            return Err(Error::content(path, problem));
        }
    };
    let filters = if args.log_time {
        vec![of_group(log_time::PGN)]
    } else {
        Vec::new()
    };
    let sender = FrameSender::open(&args.interface, &filters)?;
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
    log_notes::note_report(path, &log.report());
    print(&summary(args, &sent, begun.elapsed().as_secs_f64()))
}

fn summary(args: &Args, sent: &Sent, seconds: f64) -> String {
    let log_s = sent
        .span
        .map_or(0.0, |(first, last)| last.since(first).as_secs_f64());
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
        row("log duration", "s", format!("{log_s:.1}")),
        row("sent in", "s", format!("{seconds:.1}")),
        row("rate", "frames/s", format!("{rate:.0}")),
    ];
    if args.speed != Pace::Max {
        rows.push(row("maximum delay", "ms", format!("{latest_ms:.2}")));
    }
    format!("{}\n", text_table(&["", "unit", "value"], &rows, 2))
}
