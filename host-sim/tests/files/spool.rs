//! Entries put by, in memory and beyond it.

use host_sim::files::spool::{Spool, blocks};
use proptest::prelude::*;

type Entry = (u64, Option<f64>);
type Entries = Spool<Entry, 19>;

/// As long as it can be encoded, or short.
fn entry(number: usize) -> Entry {
    let number = number as u64;
    if number.is_multiple_of(3) {
        (u64::MAX - number, Some(number as f64))
    } else {
        (number, None)
    }
}

fn read(spool: &mut Entries) -> Vec<Entry> {
    let mut entries = Vec::new();
    for block in blocks(0..spool.count()) {
        entries.extend(spool.read(block).unwrap());
    }
    entries
}

proptest! {
    #![proptest_config(ProptestConfig::with_cases(16))]
    /// 30,000 of them are over the size that stays in memory.
    #[test]
    fn entries_come_back_by_number_whatever_way_they_went_in(
        pushed in 0..30_000_usize,
        stretch in 1..2_000_usize,
    ) {
        let mut spool = Entries::default();
        for number in 0..pushed {
            spool.push(&entry(number)).unwrap();
        }
        // Stretches behind those, the last one first, as smoothing hands them out.
        for begin in (0..3).rev().map(|k| pushed + k * stretch) {
            spool.put(begin, (begin..begin + stretch).map(entry)).unwrap();
        }
        let count = pushed + 3 * stretch;
        prop_assert_eq!(spool.count(), count);
        prop_assert_eq!(read(&mut spool), (0..count).map(entry).collect::<Vec<_>>());
    }
}

#[test]
fn an_entry_that_does_not_fit_its_slot_is_an_error_and_takes_no_place() {
    let mut spool = Spool::<Entry, 18>::default();
    assert!(spool.push(&entry(0)).is_err());
    spool.push(&entry(1)).unwrap();
    assert_eq!(spool.count(), 1);
    assert_eq!(spool.read(0..1).unwrap(), [entry(1)]);
}

#[test]
fn what_was_not_put_by_cannot_be_read() {
    let mut spool = Entries::default();
    spool.push(&entry(0)).unwrap();
    assert!(spool.read(0..2).is_err());
}
