//! What the program says of a file with signals: channels, a proposal, and options that do not fit.

use super::{plain, reals};
use std::path::Path;
use test_kit::command::{folder, program};
use test_kit::mdf::{MdfBlocks, MdfData, MdfFrame, mdf};

fn run(folder: &Path, arguments: &[&str]) -> (i32, String, String) {
    let output = program()
        .current_dir(folder)
        .args(arguments)
        .output()
        .unwrap();
    let text = |bytes| String::from_utf8(bytes).unwrap();
    (
        output.status.code().unwrap(),
        text(output.stdout),
        text(output.stderr),
    )
}

fn written() -> tempfile::TempDir {
    let folder = folder();
    let mut speed = reals("VehV_v", "km/h", &[(0.0, 36.0), (0.1, 72.0)]);
    speed.name = "10 ms";
    let file = plain(&[
        speed,
        reals("nmot", "1/min", &[(0.0, 900.0)]),
        reals("nmot", "1/min", &[(0.0, 901.0)]),
        reals("VehicleSpeed", "km/h", &[(0.0, 36.0)]),
        reals("altitude_m", "m", &[(0.0, 400.0)]),
    ]);
    std::fs::write(folder.path().join("a.mf4"), file).unwrap();
    folder
}

#[test]
fn inspect_lists_the_channels_and_proposes_a_mapping() {
    let folder = written();
    let (code, text, _) = run(folder.path(), &["inspect", "a.mf4"]);
    assert_eq!(code, 0);
    for words in [
        "a.mf4: ASAM MDF 4 signals, 1 rows",
        "| 10 ms   | VehV_v       | km/h  |     2 |  36.000 |  72.000 |",
        "| group 2 | nmot ",
        "| group 5 | altitude_m   | m     |     1 | 400.000 | 400.000 | altitude_m |",
        "[signals.wheel_speed_mps]\nsignal = \"VehicleSpeed\"\n",
        "[signals.engine_speed_rpm]\nmessage = \"group 2\"\nsignal = \"nmot\"\nscale = 1.0\n",
    ] {
        assert!(text.contains(words), "{words}\n{text}");
    }
    assert!(
        !text.contains("[signals.altitude_m]"),
        "it is taken already"
    );
    let (_, json, _) = run(folder.path(), &["inspect", "--json", "a.mf4"]);
    let json: serde_json::Value = serde_json::from_str(&json).unwrap();
    assert_eq!(json["kind"], "ASAM MDF 4 signals");
    assert_eq!(json["channels"][0]["channel"], "VehV_v");
    assert_eq!(json["channels"][0]["max"], 72.0);
    assert_eq!(json["channels"][4]["signal"], "altitude_m");
    // The proposal can be used as it is.
    let toml = json["mapping"]["signals_toml"].as_str().unwrap();
    std::fs::write(folder.path().join("p.toml"), toml).unwrap();
    let mapped = ["inspect", "--json", "--signals", "p.toml", "a.mf4"];
    let (_, json, _) = run(folder.path(), &mapped);
    let json: serde_json::Value = serde_json::from_str(&json).unwrap();
    let speed = json["signals"].as_array().unwrap().iter();
    let mut speed = speed.filter(|of| of["signal"] == "wheel_speed_mps");
    assert_eq!(speed.next().unwrap()["max"], 10.0);
    assert!(json.get("mapping").is_none());
}

#[test]
fn options_that_do_not_fit_say_what_to_do() {
    let folder = written();
    let write = |name: &str, bytes: &[u8]| std::fs::write(folder.path().join(name), bytes).unwrap();
    write(
        "s.toml",
        b"[signals.wheel_speed_mps]\nsignal = \"VehV_v\"\nmessage = 1\n",
    );
    write("t.csv", b"time_s,wheel_speed_mps\n0,1\n");
    write("c.log", b"(1.000000) can0 0CF00400#0102030405060708\n");
    write(
        "d.dbc",
        b"BO_ 1 M: 8 X\n SG_ VehV_v : 0|8@1+ (1,0) [0|0] \"\" X\n",
    );
    let refused = |options: &[&str], code: i32, words: &str| {
        let (found, _, told) = run(folder.path(), &[&["inspect"], options].concat());
        assert_eq!(found, code, "{told}");
        assert!(told.contains(words), "{words}\n{told}");
    };
    refused(
        &["--signals", "s.toml", "c.log"],
        2,
        "--signals without --dbc: c.log is a candump log, whose messages a .dbc file describes; give \
         --dbc FILE.dbc, too",
    );
    refused(
        &["--signals", "s.toml", "t.csv"],
        2,
        "t.csv is a signal table",
    );
    refused(
        &["--dbc", "d.dbc", "--signals", "s.toml", "a.mf4"],
        1,
        "a.mf4: has signals and no frames of a bus",
    );
    write(
        "m.toml",
        b"[signals.wheel_speed_mps]\nsignal = \"VehV_v\"\n",
    );
    refused(
        &["--dbc", "d.dbc", "--signals", "m.toml", "c.log"],
        1,
        "m.toml:1: signals.wheel_speed_mps.message is missing",
    );
}

#[test]
fn frames_go_first_unless_channels_are_mapped() {
    let folder = written();
    let frame = |k: u64| MdfFrame {
        micros: 1000 * k,
        bus: 1,
        id: 0x18FE_F100,
        is_extended: true,
        data: vec![0xff, 0, 72, 0xff, 0xff, 0xff, 0xff, 0xff],
    };
    let frames: Vec<MdfFrame> = (0..10).map(frame).collect();
    // The chain of data groups of a file of frames goes on in one of signals behind it.
    let mut both = mdf(&frames, MdfBlocks::Plain, MdfData::InRecord);
    let group = memchr::memmem::find(&both, b"##DG").unwrap();
    let signals = std::fs::read(folder.path().join("a.mf4")).unwrap();
    both.resize(both.len().next_multiple_of(8), 0);
    let base = both.len() as u64;
    let first = u64::from_le_bytes(signals[64 + 24..64 + 32].try_into().unwrap());
    both[group + 24..group + 32].copy_from_slice(&(base + first).to_le_bytes());
    both.extend(moved(signals, base));
    std::fs::write(folder.path().join("both.mf4"), both).unwrap();
    let (_, text, told) = run(folder.path(), &["inspect", "both.mf4"]);
    assert!(
        text.starts_with("both.mf4: ASAM MDF 4 log, 10 frames"),
        "{text}"
    );
    let words = "both.mf4: 5 channels of signals are not read beside the frames; --signals without \
                 --dbc reads them";
    assert!(told.contains(words), "{told}");
    let toml = "[signals.wheel_speed_mps]\nsignal = \"VehV_v\"\n";
    std::fs::write(folder.path().join("m.toml"), toml).unwrap();
    let (_, text, _) = run(
        folder.path(),
        &["inspect", "--signals", "m.toml", "both.mf4"],
    );
    assert!(
        text.starts_with("both.mf4: ASAM MDF 4 signals, 2 rows"),
        "{text}"
    );
}

/// Returns the blocks of a file with their links moved.
fn moved(mut file: Vec<u8>, by: u64) -> Vec<u8> {
    let word = |file: &[u8], at: usize| u64::from_le_bytes(file[at..at + 8].try_into().unwrap());
    let mut at = 64;
    while at + 24 <= file.len() {
        let (length, links) = (word(&file, at + 8), word(&file, at + 16));
        for link in 0..links as usize {
            let place = at + 24 + 8 * link;
            let to = word(&file, place);
            if to != 0 {
                file[place..place + 8].copy_from_slice(&(to + by).to_le_bytes());
            }
        }
        at += (length as usize).next_multiple_of(8);
    }
    file
}
