//! Writes the seeds of the fuzz targets that are not text:
//!
//! ```text
//! cargo run -p fuzz-targets --example seeds
//! ```
//!
//! The names of the seeds say what they are. Seeds of the text readers are written by hand.

use arbitrary::{Arbitrary, Unstructured};
use estimator_core::{Estimator, Signal, Tuning};
use flate2::write::ZlibEncoder;
use flate2::{Compression, GzBuilder};
use fuzz_targets::bus::{Event, EventBus};
use fuzz_targets::sessions::Packet;
use fuzz_targets::truck;
use host_sim::files::parquet::{ParquetColumn, stage};
use ruzstd::encoding::{CompressionLevel, compress_to_vec};
use std::io::Write;
use std::path::Path;
use std::{fs, io};
use test_kit::mdf::{MDF_FORMS, MdfFrame, mdf};
use test_kit::osm::{OsmNode, OsmWay, Packing, pbf};

type Events = Vec<Event>;

fn main() -> io::Result<()> {
    let corpus = Path::new(env!("CARGO_MANIFEST_DIR")).join("corpus");
    for (name, events) in of_estimator() {
        write(&corpus, "estimator", name, &encoded(&events))?;
    }
    for (name, events) in of_decode() {
        write(&corpus, "decode", name, &encoded(&events))?;
    }
    for (name, packets) in of_transport() {
        write(&corpus, "transport", name, &encoded_packets(&packets))?;
    }
    for (name, bytes) in of_persistent_state() {
        write(&corpus, "persistent_state", name, &bytes)?;
    }
    for (target, from, to) in [
        ("candump", "short_form", "gzip"),
        ("signal_table", "some_columns", "gzip"),
    ] {
        let text = fs::read(corpus.join(target).join(from))?;
        write(&corpus, target, to, &compressed(&text)?)?;
    }
    for (k, (blocks, data)) in MDF_FORMS.into_iter().enumerate() {
        let name = format!("form_{k}");
        write(&corpus, "mdf", &name, &mdf(&few_frames(), blocks, data))?;
    }
    for (name, method) in [("plain", 0), ("zlib", 2)] {
        write(&corpus, "blf", name, &blf(&few_frames(), method)?)?;
    }
    for (name, bytes) in packed(&fs::read(corpus.join("candump").join("short_form"))?)? {
        write(&corpus, "packed", name, &bytes)?;
    }
    let folder = tempfile::tempdir()?;
    let table = folder.path().join("table.parquet");
    write_table(&table);
    write(&corpus, "parquet_table", "some_columns", &fs::read(table)?)?;
    for (name, packing) in [("raw", Packing::Raw), ("zlib", Packing::Zlib)] {
        write(&corpus, "osm_pbf", name, &extract(packing))?;
    }
    Ok(())
}

/// Returns a bridge between two roads, with a tag on a node.
fn extract(packing: Packing) -> Vec<u8> {
    let node = |id: i64| -> OsmNode<'_> { (id, 474_000_000 + 10_000 * id, 85_000_000, &[]) };
    let mut nodes: Vec<OsmNode> = (1..=6).map(node).collect();
    nodes[2].3 = &[("highway", "crossing")];
    let ways: [OsmWay; 3] = [
        (
            1,
            vec![1, 2, 3],
            &[("highway", "primary"), ("oneway", "yes")],
        ),
        (
            2,
            vec![3, 4],
            &[("highway", "primary_link"), ("bridge", "yes")],
        ),
        (
            3,
            vec![4, 5, 6],
            &[("highway", "service"), ("junction", "roundabout")],
        ),
    ];
    pbf(&["OsmSchema-V0.6", "DenseNodes"], &nodes, &ways, packing)
}

fn write(corpus: &Path, target: &str, name: &str, bytes: &[u8]) -> io::Result<()> {
    let folder = corpus.join(target);
    fs::create_dir_all(&folder)?;
    fs::write(folder.join(name), bytes)
}

// --- logs ------------------------------------------------------------------------------------------

fn few_frames() -> Vec<MdfFrame> {
    let frame = |k: u64| MdfFrame {
        micros: 1000 * k,
        bus: 1,
        id: 0x0CF0_0400,
        is_extended: true,
        data: k.to_le_bytes().to_vec(),
    };
    (1..9).map(frame).collect()
}

/// Returns a log in gzip and in Zstandard, in one and two members, with and without damage.
fn packed(text: &[u8]) -> io::Result<[(&'static str, Vec<u8>); 4]> {
    let gzip = compressed(text)?;
    let zstd = compress_to_vec(text, CompressionLevel::Fastest);
    let damaged = |member: &[u8]| {
        let mut member = member.to_vec();
        let middle = member.len() / 2;
        member[middle..].fill(0xff);
        member
    };
    Ok([
        ("gzip_members", [&gzip[..], &gzip].concat()),
        ("gzip_damaged", [&damaged(&gzip)[..], &gzip].concat()),
        ("zstd_frames", [&zstd[..], &zstd].concat()),
        ("zstd_damaged", [&damaged(&zstd)[..], &zstd].concat()),
    ])
}

/// Writes a signal table.
fn write_table(path: &Path) {
    let numbers = |scale: f64| (0..20).map(move |k| scale * f64::from(k));
    let columns = vec![
        ParquetColumn::numbers("time_s", numbers(0.1)),
        ParquetColumn::optional("wheel_speed_mps", numbers(0.3).map(Some)),
        ParquetColumn::whole("gear", (0..20).map(|k| k / 4)),
        ParquetColumn::numbers("altitude_m", numbers(-2.0)),
        ParquetColumn::text("driver", Some("x"), 20),
    ];
    let staged = stage(path, columns, &[]).expect("a table");
    staged.commit().expect("a table");
}

/// Returns a BLF file with one container, plain (0) or zlib (2).
fn blf(frames: &[MdfFrame], method: u16) -> io::Result<Vec<u8>> {
    let object = |header: u16, kind: u32, body: &[u8]| {
        let length = 16 + body.len() as u32;
        let mut bytes = b"LOBJ".to_vec();
        bytes.extend([header.to_le_bytes(), 1_u16.to_le_bytes()].concat());
        bytes.extend([length.to_le_bytes(), kind.to_le_bytes()].concat());
        bytes.extend(body);
        bytes
    };
    let mut objects = Vec::new();
    for frame in frames {
        let mut body = [2, 0, 0, 0, 0, 0, 0, 0].to_vec();
        body.extend((1000 * frame.micros).to_le_bytes());
        body.extend([1, 0, 0, frame.data.len() as u8]);
        body.extend((frame.id | 1 << 31).to_le_bytes());
        body.extend(&frame.data);
        objects.extend(object(32, 1, &body));
    }
    let declared = objects.len() as u32;
    if method == 2 {
        let mut encoder = ZlibEncoder::new(Vec::new(), Compression::default());
        encoder.write_all(&objects)?;
        objects = encoder.finish()?;
    }
    let mut content = [method, 0, 0, 0].map(u16::to_le_bytes).concat();
    content.extend([declared.to_le_bytes(), [0; 4]].concat());
    content.extend(objects);
    let mut file = b"LOGG".to_vec();
    file.extend(144_u32.to_le_bytes());
    file.resize(144, 0);
    file.extend(object(16, 10, &content));
    Ok(file)
}

// --- traffic ---------------------------------------------------------------------------------------

/// Returns traffic that brings the filter into states in which a fault can do harm.
fn of_estimator() -> Vec<(&'static str, Events)> {
    vec![
        ("a_drive", vec![drive(2_000), drive(2_200), drive(2_100)]),
        (
            "a_drive_without_gnss",
            vec![without_gnss(2_000), without_gnss(2_100)],
        ),
        (
            "a_steep_climb",
            vec![drive(1_500), climb(150, 90), climb(150, 90)],
        ),
        ("brakes_and_shifts", brakes_and_shifts()),
        (
            "stop_and_go",
            vec![drive(800), drive(0), drive(900), drive(3), drive(1_000)],
        ),
        (
            "gnss_jumps_and_comes_back",
            vec![
                drive(2_000),
                climb(5_000, 40),
                climb(-5_000, 40),
                drive(2_000),
            ],
        ),
        (
            "time_goes_back",
            vec![drive(2_000), wait(-30_000), drive(2_000)],
        ),
        (
            "an_hour_of_silence",
            vec![drive(2_000), wait(3_600_000), drive(2_000)],
        ),
        ("signals_that_are_no_numbers", no_numbers()),
        ("two_sources_of_one_message", two_sources()),
    ]
}

/// Returns known and unknown frames.
fn of_decode() -> Vec<(&'static str, Events)> {
    vec![
        ("a_drive", vec![drive(2_000)]),
        ("every_message_of_zeros", every_message(0x00)),
        ("every_message_not_available", every_message(0xff)),
        ("every_message_in_error", every_message(0xfe)),
        ("every_signal_largest", every_signal(f32::MAX)),
        ("every_signal_least", every_signal(f32::MIN)),
        ("fast_packets_out_of_order", parts(&[0, 2, 1, 3, 5, 4, 6])),
        (
            "fast_packets_without_their_first",
            parts(&[1, 2, 3, 4, 5, 6]),
        ),
        ("fast_packets_twice", parts(&[0, 0, 1, 1, 2, 2, 3, 3])),
        (
            "frames_cut_short",
            (0..9).map(|n| frame(0x0CF0_0400, n)).collect(),
        ),
        ("frames_that_have_no_data", no_data()),
    ]
}

fn drive(speed_cmps: u16) -> Event {
    Event::Drive {
        seconds: 40,
        speed_cmps,
        torque_percent: 35,
        gear: 2,
        climb_cmps: 20,
        braking: false,
        shifting: false,
        gnss: true,
    }
}

fn climb(climb_cmps: i16, torque_percent: i8) -> Event {
    Event::Drive {
        seconds: 20,
        speed_cmps: 1_500,
        torque_percent,
        gear: 1,
        climb_cmps,
        braking: false,
        shifting: false,
        gnss: true,
    }
}

fn without_gnss(speed_cmps: u16) -> Event {
    Event::Drive {
        seconds: 40,
        speed_cmps,
        torque_percent: 35,
        gear: 2,
        climb_cmps: 0,
        braking: false,
        shifting: false,
        gnss: false,
    }
}

fn brakes_and_shifts() -> Events {
    let short = |gear: i8, braking: bool, shifting: bool| Event::Drive {
        seconds: 3,
        speed_cmps: 1_400,
        torque_percent: if braking || shifting { 0 } else { 60 },
        gear,
        climb_cmps: -30,
        braking,
        shifting,
        gnss: true,
    };
    vec![
        drive(1_500),
        short(1, false, true),
        short(2, false, false),
        short(2, true, false),
        short(2, true, true),
        short(-1, false, false),
        drive(1_400),
    ]
}

fn wait(millis: i32) -> Event {
    Event::Wait { millis }
}

fn no_numbers() -> Events {
    let values = [
        f32::NAN,
        f32::INFINITY,
        f32::NEG_INFINITY,
        -0.0,
        f32::MIN_POSITIVE,
    ];
    let mut events = vec![drive(2_000)];
    for value in values {
        events.extend(every_signal(value));
    }
    events.push(drive(2_000));
    events
}

fn every_signal(value: f32) -> Events {
    let all = 0..Signal::ALL.len();
    all.map(|which| Event::Signal {
        which: which as u8,
        value,
        source: 0,
    })
    .collect()
}

fn two_sources() -> Events {
    let mut events = vec![drive(2_000)];
    for turn in 0..40 {
        events.push(Event::Message {
            which: turn / 2,
            source: 33 * (turn % 2),
            sequence: turn % 8,
            data: [turn; 16],
        });
    }
    events.push(drive(2_000));
    events
}

fn every_message(byte: u8) -> Events {
    let all = 0..estimator_core::signal::messages().count();
    all.map(|which| Event::Message {
        which: which as u8,
        source: 0,
        sequence: 0,
        data: [byte; 16],
    })
    .collect()
}

/// Returns frames of fast packets of every message, in the order of these counters.
fn parts(counters: &[u8]) -> Events {
    let all = 0..estimator_core::signal::messages().count();
    all.flat_map(|which| {
        counters.iter().map(move |counter| Event::Part {
            which: which as u8,
            source: 1,
            head: 0x40 | counter,
            length: 8,
            data: [43, 1, 2, 3, 4, 5, 6],
        })
    })
    .collect()
}

fn frame(id: u32, length: u8) -> Event {
    Event::Frame {
        id,
        extended: true,
        remote: false,
        length,
        data: [1, 2, 3, 4, 5, 6, 7, 8],
    }
}

fn no_data() -> Events {
    let kinds = [(false, false), (false, true), (true, false), (true, true)];
    kinds
        .into_iter()
        .map(|(extended, remote)| Event::Frame {
            id: 0x0CF0_0400,
            extended,
            remote,
            length: 0,
            data: [0; 8],
        })
        .collect()
}

// --- sessions --------------------------------------------------------------------------------------

/// Returns sessions of the engine, and of others beside it.
fn of_transport() -> Vec<(&'static str, Vec<Packet>)> {
    let engine = session(0, true, 3);
    let others: Vec<Packet> = [
        session(1, true, 3),
        session(2, true, 9),
        session(4, false, 0),
    ]
    .concat();
    let mixed = engine.iter().zip(&others).flat_map(|(a, b)| [*a, *b]);
    vec![
        ("a_broadcast", engine.clone()),
        ("a_session_to_one", session(4, false, 0)),
        ("another_group", session(0, true, 15)),
        ("sessions_of_two", mixed.collect()),
        ("a_packet_is_missing", [&engine[..3], &engine[4..]].concat()),
        (
            "every_packet_twice",
            engine.iter().flat_map(|of| [*of, *of]).collect(),
        ),
        (
            "two_in_a_row",
            [engine.clone(), session(0, true, 9)].concat(),
        ),
    ]
}

/// Returns a session of 39 bytes. `number` chooses control byte and group.
fn session(source: u8, to_all: bool, number: u8) -> Vec<Packet> {
    let announcement = Packet {
        source,
        to_all,
        wait_ms: 60,
        is_data: false,
        number,
        length: 39,
        more_packets: 0,
        size: 8,
        data: [0; 7],
    };
    let parts = (1..=6).map(|number| Packet {
        is_data: true,
        number,
        data: [number, source, 2, 3, 4, 5, 6],
        ..announcement
    });
    [announcement].into_iter().chain(parts).collect()
}

/// Returns the bytes of which `arbitrary` makes these packets.
///
/// # Panics
/// Panics if `arbitrary` makes other packets of them.
fn encoded_packets(packets: &[Packet]) -> Vec<u8> {
    let mut bytes = Vec::new();
    for packet in packets {
        // Another packet follows.
        bytes.extend([1, packet.source, u8::from(packet.to_all)]);
        bytes.extend(packet.wait_ms.to_le_bytes());
        bytes.extend([u8::from(packet.is_data), packet.number]);
        bytes.extend(packet.length.to_le_bytes());
        bytes.extend([packet.more_packets, packet.size]);
        bytes.extend(packet.data);
    }
    let decoded = Vec::<Packet>::arbitrary_take_rest(Unstructured::new(&bytes)).expect("packets");
    assert_eq!(format!("{decoded:?}"), format!("{packets:?}"));
    bytes
}

// --- traffic as the bytes of `arbitrary` ---------------------------------------------------------

const KINDS: u64 = 6;

/// Returns the bytes of which `arbitrary` makes these events.
///
/// # Panics
/// Panics if `arbitrary` makes other events of them.
fn encoded(events: &[Event]) -> Vec<u8> {
    let mut bytes = Vec::new();
    for event in events {
        // Another event follows.
        bytes.push(1);
        encode(event, &mut bytes);
    }
    let decoded = Events::arbitrary_take_rest(Unstructured::new(&bytes)).expect("events");
    assert_eq!(format!("{decoded:?}"), format!("{events:?}"));
    bytes
}

fn encode(event: &Event, bytes: &mut Vec<u8>) {
    let mut kind = |kind: u64| {
        // The least number that `arbitrary` maps to this kind.
        let number = (kind << 32).div_ceil(KINDS) as u32;
        bytes.extend(number.to_le_bytes());
    };
    match *event {
        Event::Frame {
            id,
            extended,
            remote,
            length,
            data,
        } => {
            kind(0);
            bytes.extend(id.to_le_bytes());
            bytes.extend([u8::from(extended), u8::from(remote), length]);
            bytes.extend(data);
        }
        Event::Message {
            which,
            source,
            sequence,
            data,
        } => {
            kind(1);
            bytes.extend([which, source, sequence]);
            bytes.extend(data);
        }
        Event::Part {
            which,
            source,
            head,
            length,
            data,
        } => {
            kind(2);
            bytes.extend([which, source, head, length]);
            bytes.extend(data);
        }
        Event::Drive {
            seconds,
            speed_cmps,
            torque_percent,
            gear,
            climb_cmps,
            braking,
            shifting,
            gnss,
        } => {
            kind(3);
            bytes.push(seconds);
            bytes.extend(speed_cmps.to_le_bytes());
            bytes.extend(torque_percent.to_le_bytes());
            bytes.extend(gear.to_le_bytes());
            bytes.extend(climb_cmps.to_le_bytes());
            bytes.extend([braking, shifting, gnss].map(u8::from));
        }
        Event::Signal {
            which,
            value,
            source,
        } => {
            kind(4);
            bytes.push(which);
            bytes.extend(value.to_bits().to_le_bytes());
            bytes.push(source);
        }
        Event::Wait { millis } => {
            kind(5);
            bytes.extend(millis.to_le_bytes());
        }
    }
}

// --- persistent states ---------------------------------------------------------------------------

/// First byte of a seed: whether the target corrects the checksum.
const AS_IT_IS: u8 = 0;
const CORRECTED: u8 = 1;

fn of_persistent_state() -> Vec<(&'static str, Vec<u8>)> {
    let whole = left_by_a_drive();
    let seed = |corrects: u8, bytes: &[u8]| [&[corrects], bytes].concat();
    let with = |offset: usize, word: [u8; 4]| {
        let mut bytes = whole.clone();
        bytes[offset..offset + 4].copy_from_slice(&word);
        seed(CORRECTED, &bytes)
    };
    let mut damaged = whole.clone();
    damaged[20] ^= 0x10;
    vec![
        ("after_a_drive", seed(AS_IT_IS, &whole)),
        ("never_written", seed(AS_IT_IS, &vec![0xff; whole.len()])),
        ("cut_short", seed(AS_IT_IS, &whole[..whole.len() - 1])),
        (
            "a_byte_too_long",
            seed(AS_IT_IS, &[&whole[..], &[0]].concat()),
        ),
        ("damaged", seed(AS_IT_IS, &damaged)),
        ("of_something_else", with(0, *b"ELF\0")),
        ("of_a_later_version", with(4, 3_u32.to_le_bytes())),
        ("of_another_vehicle", with(8, [1, 2, 3, 4])),
        ("bias_not_a_number", with(16, f32::NAN.to_le_bytes())),
        ("variance_below_zero", with(20, (-1.0_f32).to_le_bytes())),
        ("correlation_above_one", with(32, 10.0_f32.to_le_bytes())),
        ("accelerometer", seed(CORRECTED, &of_accelerometer(&whole))),
        (
            "accelerometer_of_minus_zeros",
            with(48, (-0.0_f32).to_le_bytes()),
        ),
    ]
}

fn left_by_a_drive() -> Vec<u8> {
    let mut estimator = Estimator::<f32>::new(truck(), Tuning::default()).expect("a truck");
    let mut bus = EventBus::default();
    for _ in 0..10 {
        bus.play(&drive(2_000), &mut |timed| {
            estimator.on_frame(timed.time, &timed.frame);
            while estimator.step().is_some() {
                while estimator.next_cell().is_some() {}
            }
        });
    }
    estimator
        .persistent_state()
        .expect("a drive")
        .to_bytes()
        .to_vec()
}

/// Returns the state of a vehicle with an accelerometer.
fn of_accelerometer(whole: &[u8]) -> Vec<u8> {
    let mut bytes = whole.to_vec();
    let numbers = [0.1_f32, 4e-4, 0.05, 9e-4, 0.2];
    for (place, number) in bytes[48..].chunks_exact_mut(4).zip(numbers) {
        place.copy_from_slice(&number.to_le_bytes());
    }
    bytes
}

/// Compresses text to the same bytes each time: without time, name and system.
fn compressed(text: &[u8]) -> io::Result<Vec<u8>> {
    let mut encoder = GzBuilder::new().write(Vec::new(), Compression::best());
    encoder.write_all(text)?;
    encoder.finish()
}
