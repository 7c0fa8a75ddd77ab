//! Damage costs itself: blocks of data, chains of groups and channels, circles.

use super::{error, group, plain, read, read_as, reals};
use estimator_core::Signal;
use host_sim::source::read_options::ReadOptions;
use test_kit::mdf::MdfBlocks;
use test_kit::mdf_signals::{MdfChannel, MdfGroup, MdfLayout, mdf_signals};

/// Where the links of a block begin, and the data of a channel.
const LINKS: usize = 24;

fn blocks(file: &[u8], id: &[u8]) -> Vec<usize> {
    memchr::memmem::find_iter(file, id).collect()
}

fn put(file: &mut [u8], at: usize, bytes: &[u8]) {
    file[at..at + bytes.len()].copy_from_slice(bytes);
}

fn drive() -> [MdfGroup; 2] {
    let speed: Vec<(f64, f64)> = (0..3000).map(|k| (f64::from(k) * 0.1, 20.0)).collect();
    let height: Vec<(f64, f64)> = (0..300).map(|k| (f64::from(k), 5.0)).collect();
    [
        reals("wheel_speed_mps", "m/s", &speed),
        reals("altitude_m", "m", &height),
    ]
}

#[test]
fn a_damaged_block_costs_itself() {
    for layout in [MdfLayout::Sorted, MdfLayout::Unsorted, MdfLayout::Columns] {
        let whole = mdf_signals(&drive(), MdfBlocks::Deflated, layout);
        let places = blocks(&whole, b"##DZ");
        let mut costs = Vec::new();
        for place in places {
            let mut file = whole.clone();
            // Within the packed bytes.
            put(&mut file, place + 60, &[0xff; 8]);
            let (found, report) = read(&file, "").unwrap();
            assert_eq!(report.damage.blocks, 1, "{layout:?}");
            costs.push(3300 - found.len());
            let strict = ReadOptions {
                strict: true,
                ..ReadOptions::default()
            };
            assert!(read_as(&file, "", &strict).is_err());
        }
        assert!(
            costs.iter().all(|cost| (90..2000).contains(cost)),
            "{layout:?} {costs:?}"
        );
    }
}

#[test]
fn a_damaged_channel_costs_those_behind_it() {
    let records = (0..50).map(|k| (f64::from(k), vec![20, 5]));
    let channels = vec![
        MdfChannel::of_type("wheel_speed_mps", 0, 8, 8),
        MdfChannel::of_type("altitude_m", 0, 9, 8),
    ];
    let whole = plain(&[group(channels, records)]);
    let found = |file: &[u8]| read(file, "").unwrap();
    assert_eq!(found(&whole).0.len(), 100);
    // Channels are written from the last to the first.
    let last = blocks(&whole, b"##CN")[0];
    let mut file = whole.clone();
    put(&mut file, last, b"#");
    put(&mut file, last + 2, b"XX");
    let (values, report) = found(&file);
    assert!(values.iter().all(|of| of.1 == Signal::WheelSpeed));
    assert_eq!((values.len(), report.damage.blocks), (50, 1));
    // A circle of channels ends.
    let mut file = whole.clone();
    let to_itself = (last as u64).to_le_bytes();
    put(&mut file, last + LINKS, &to_itself);
    let (values, report) = found(&file);
    assert_eq!((values.len(), report.damage.blocks), (100, 1));
    assert!(report.damage.first[0].contains("a circle of links"));
    // So does one of data groups.
    let mut file = whole.clone();
    let first = blocks(&whole, b"##DG")[0];
    put(&mut file, first + LINKS, &(first as u64).to_le_bytes());
    assert_eq!(found(&file).1.damage.blocks, 1);
}

#[test]
fn a_damaged_conversion_costs_its_channel() {
    let channel = MdfChannel::of_type("n", 0, 8, 8).converted(1, &[0.0, 1.0]);
    let speed = MdfChannel::of_type("wheel_speed_mps", 0, 8, 8);
    let records = (0..50).map(|k| (f64::from(k), vec![20]));
    let mut file = plain(&[group(vec![channel, speed], records)]);
    let place = blocks(&file, b"##CC")[0];
    put(&mut file, place, b"....");
    let (found, report) = read(&file, "").unwrap();
    assert_eq!(found.len(), 50);
    let told = "channels that are not read: n (which has a damaged conversion)";
    assert_eq!(report.notes, [told]);
    let message = error(&file, "[signals.gear_ratio]\nsignal = \"n\"\n");
    assert!(
        message.contains("signals.gear_ratio.signal is `n`, which has a damaged conversion"),
        "{message}"
    );
    // A circle of conversions ends.
    let whole = plain(&[group(
        vec![
            MdfChannel::of_type("wheel_speed_mps", 0, 8, 8),
            MdfChannel::of_type("n", 0, 8, 8).converted_by(test_kit::mdf_signals::MdfConversion {
                kind: 7,
                numbers: vec![255.0],
                references: vec![
                    test_kit::mdf_signals::MdfReference::Text("n/a"),
                    test_kit::mdf_signals::MdfReference::None,
                ],
                unit: "",
            }),
        ],
        (0..9).map(|k| (f64::from(k), vec![20])),
    )]);
    let mut file = whole.clone();
    let place = blocks(&whole, b"##CC")[0];
    let to_itself = (place as u64).to_le_bytes();
    put(&mut file, place + LINKS + 8 * 5, &to_itself);
    assert_eq!(read(&file, "").unwrap().0.len(), 9);
}

#[test]
fn a_file_that_is_cut_off_is_read_up_to_there() {
    let whole = plain(&drive()[..1]);
    let (found, report) = read(&whole[..whole.len() - 160], "").unwrap();
    assert_eq!(found.len(), 2990);
    assert!(report.damage.cut_off);
    let packed = mdf_signals(&drive()[..1], MdfBlocks::Deflated, MdfLayout::Sorted);
    for length in (200..packed.len()).step_by(97) {
        // Without its chains, a file has nothing; no length ends in a panic.
        let _ = read(&packed[..length], "");
    }
}

#[test]
fn times_that_run_backwards_are_damage() {
    let mut values: Vec<(f64, f64)> = (0..300).map(|k| (f64::from(k), 20.0)).collect();
    values[100].0 = 3.0;
    values[200].0 = f64::NAN;
    let (found, report) = read(&plain(&[reals("wheel_speed_mps", "", &values)]), "").unwrap();
    assert_eq!((found.len(), report.damage.lines), (298, 2));
    assert!(report.damage.first[0].contains("time runs backwards, from 99.000000 s to 3.000000 s"));
    assert!(report.damage.first[1].contains("a record without its time"));
}
