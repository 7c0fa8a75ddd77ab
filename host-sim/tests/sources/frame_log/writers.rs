//! Writers of the formats that the tests read: only what the tests need.

use embedded_can::{Frame, Id};
use flate2::Compression;
use flate2::write::ZlibEncoder;
use host_sim::source::can_frame::{CanFrame, TimedFrame};
use host_sim::source::candump_writer::write_frame;
use std::fmt::Write as _;
use std::io::Write as _;

/// Bytes of the header of a BLF file.
pub const BLF_HEADER_BYTES: usize = 144;

/// A format, by its name, and its writer.
pub type Format = (&'static str, fn(&[TimedFrame]) -> Vec<u8>);

/// All formats but candump.
pub const FORMATS: [Format; 14] = [
    ("asc hex", |frames| asc(frames, 16, false)),
    ("asc dec", |frames| asc(frames, 10, false)),
    ("asc relative", |frames| asc(frames, 16, true)),
    ("asc dec relative", |frames| asc(frames, 10, true)),
    ("trc 1.0", |frames| trc(frames, "1.0")),
    ("trc 1.1", |frames| trc(frames, "1.1")),
    ("trc 1.2", |frames| trc(frames, "1.2")),
    ("trc 1.3", |frames| trc(frames, "1.3")),
    ("trc 2.0", |frames| trc(frames, "2.0")),
    ("trc 2.1", |frames| trc(frames, "2.1")),
    ("blf without containers", |frames| {
        [blf_header(), blf_objects(frames)].concat()
    }),
    ("blf uncompressed", |frames| blf(&blf_objects(frames), 0)),
    ("blf zlib", |frames| blf(&blf_objects(frames), 2)),
    ("blf second header", |frames| {
        let objects: Vec<Vec<u8>> = frames.iter().map(blf_second_header).collect();
        blf(&objects.concat(), 2)
    }),
];

pub fn candump(frames: &[TimedFrame]) -> Vec<u8> {
    let mut text = Vec::new();
    for frame in frames {
        write_frame(&mut text, frame, "can0").expect("memory");
    }
    text
}

/// Returns the raw identifier, and whether it has 29 bits.
fn raw_id(frame: &CanFrame) -> (u32, bool) {
    match frame.id() {
        Id::Standard(id) => (id.as_raw().into(), false),
        Id::Extended(id) => (id.as_raw(), true),
    }
}

fn hex(data: &[u8]) -> String {
    let bytes: Vec<String> = data.iter().map(|byte| format!("{byte:02X}")).collect();
    bytes.join(" ")
}

pub fn asc_header(radix: u32, is_relative: bool) -> String {
    let base = if radix == 10 { "dec" } else { "hex" };
    let times = if is_relative { "relative" } else { "absolute" };
    format!(
        "date Sun Nov 22 10:00:00.000 am 2026\nbase {base}  timestamps {times}\n\
         internal events logged\n// version 9.0.0\nBegin Triggerblock Sun Nov 22 10:00:00.000 am \
         2026\n   0.000000 Start of measurement\n"
    )
}

fn asc(frames: &[TimedFrame], radix: u32, is_relative: bool) -> Vec<u8> {
    let mut text = asc_header(radix, is_relative);
    let mut last = 0;
    for TimedFrame { time, frame } in frames {
        let micros = time.micros() - if is_relative { last } else { 0 };
        last = time.micros();
        let (raw, is_extended) = raw_id(frame);
        let mark = if is_extended { "x" } else { "" };
        let id = if radix == 10 {
            format!("{raw}{mark}")
        } else {
            format!("{raw:X}{mark}")
        };
        let (seconds, micros) = (micros / 1_000_000, micros % 1_000_000);
        write!(text, "{seconds:4}.{micros:06} 1  {id:<15} Rx   ").expect("memory");
        if frame.is_remote_frame() {
            writeln!(text, "r {}", frame.dlc()).expect("memory");
            continue;
        }
        let data = if radix == 10 {
            let bytes: Vec<String> = frame.data().iter().map(u8::to_string).collect();
            bytes.join(" ")
        } else {
            hex(frame.data())
        };
        let dlc = frame.dlc();
        writeln!(
            text,
            "d {dlc} {data}  Length = 0 BitCount = 0 ID = {raw}{mark}"
        )
        .expect("memory");
    }
    (text + "End TriggerBlock\n").into_bytes()
}

pub fn trc_header(version: &str) -> String {
    let columns = match version {
        "2.0" => ";$COLUMNS=N,O,T,I,d,l,D\n",
        "2.1" => ";$COLUMNS=N,O,T,B,I,d,R,L,D\n",
        _ => "",
    };
    if version == "1.0" {
        return ";\n;   drive.trc\n;\n".to_owned();
    }
    format!(";$FILEVERSION={version}\n;$STARTTIME=46348.4166666667\n{columns};\n;   drive.trc\n;\n")
}

fn trc(frames: &[TimedFrame], version: &str) -> Vec<u8> {
    let mut text = trc_header(version);
    for (number, TimedFrame { time, frame }) in (1..).zip(frames) {
        let (raw, is_extended) = raw_id(frame);
        let id = if is_extended {
            format!("{raw:08X}")
        } else {
            format!("    {raw:04X}")
        };
        let (ms, micros) = (time.micros() / 1000, time.micros() % 1000);
        let dlc = frame.dlc();
        let is_remote = frame.is_remote_frame();
        let data = if is_remote && version.starts_with('1') {
            "RTR".to_owned()
        } else {
            hex(frame.data())
        };
        let kind = if is_remote { "RR" } else { "DT" };
        let tenths = micros / 100;
        let line = match version {
            "1.0" => format!("{number:6}) {ms:9} {id}  {dlc}  {data}"),
            "1.2" => format!("{number:6}) {ms:9}.{micros:03} 1  Rx    {id}  {dlc}  {data}"),
            "1.1" => format!("{number:6}) {ms:9}.{tenths}  Rx     {id}  {dlc}  {data}"),
            "1.3" => format!("{number:6}) {ms:9}.{tenths} 1  Rx    {id} -  {dlc}    {data}"),
            "2.0" => format!("{number:7} {ms:9}.{micros:03} {kind} {id} Rx  {dlc}  {data}"),
            _ => format!("{number:7} {ms:9}.{micros:03} {kind} 1  {id} Rx -  {dlc}    {data}"),
        };
        writeln!(text, "{line}").expect("memory");
    }
    text.into_bytes()
}

pub fn blf_header() -> Vec<u8> {
    let mut header = b"LOGG".to_vec();
    header.extend(144_u32.to_le_bytes());
    header.resize(BLF_HEADER_BYTES, 0);
    header
}

/// Returns an object with its padding.
pub fn blf_object(kind: u32, header: u16, content: &[u8]) -> Vec<u8> {
    let size = 16 + content.len() as u32;
    let version = if header > 32 { 2_u16 } else { 1 };
    let mut object = b"LOBJ".to_vec();
    object.extend(header.to_le_bytes());
    object.extend(version.to_le_bytes());
    object.extend(size.to_le_bytes());
    object.extend(kind.to_le_bytes());
    object.extend_from_slice(content);
    object.resize(object.len().next_multiple_of(4), 0);
    object
}

/// Returns channel, flags, length, identifier and data.
fn blf_message(frame: &CanFrame) -> Vec<u8> {
    let (raw, is_extended) = raw_id(frame);
    let mut message = vec![1, 0, if frame.is_remote_frame() { 0x80 } else { 0 }];
    message.push(frame.dlc() as u8);
    message.extend((raw | u32::from(is_extended) << 31).to_le_bytes());
    message.extend(frame.data());
    message.resize(16, 0);
    message
}

/// Returns the second part of the header: unit of time, and time.
pub fn blf_time(is_ticks: bool, micros: u64) -> Vec<u8> {
    let (unit, time) = if is_ticks {
        (1_u32, micros / 10)
    } else {
        (2, micros * 1000)
    };
    [&unit.to_le_bytes()[..], &[0; 4], &time.to_le_bytes()].concat()
}

/// Returns the frames as CAN_MESSAGE (in ticks of 10 µs) and CAN_MESSAGE2 (in ns), in turns.
pub fn blf_objects(frames: &[TimedFrame]) -> Vec<u8> {
    let objects = frames.iter().enumerate().map(|(k, timed)| {
        let is_old = k % 2 == 0;
        let mut content = blf_time(is_old, timed.time.micros());
        content.extend(blf_message(&timed.frame));
        if !is_old {
            // Frame length, bit count and two reserved fields.
            content.extend([0; 8]);
        }
        blf_object(if is_old { 1 } else { 86 }, 32, &content)
    });
    objects.flatten().collect()
}

fn blf_second_header(timed: &TimedFrame) -> Vec<u8> {
    let mut content = blf_time(false, timed.time.micros());
    content.extend([0; 8]);
    content.extend(blf_message(&timed.frame));
    blf_object(1, 40, &content)
}

pub fn blf_container(method: u16, declared: u32, content: &[u8]) -> Vec<u8> {
    let mut container = method.to_le_bytes().to_vec();
    container.extend([0; 6]);
    container.extend(declared.to_le_bytes());
    container.extend([0; 4]);
    container.extend_from_slice(content);
    blf_object(10, 16, &container)
}

/// Returns a file with these objects in containers whose borders are anywhere in an object.
pub fn blf(objects: &[u8], method: u16) -> Vec<u8> {
    let mut file = blf_header();
    for part in objects.chunks(50_021.min(objects.len() / 3 + 1)) {
        let packed = if method == 2 {
            zlib(part)
        } else {
            part.to_vec()
        };
        file.extend(blf_container(method, part.len() as u32, &packed));
    }
    file
}

pub fn zlib(content: &[u8]) -> Vec<u8> {
    let mut encoder = ZlibEncoder::new(Vec::new(), Compression::default());
    encoder.write_all(content).expect("memory");
    encoder.finish().expect("memory")
}
