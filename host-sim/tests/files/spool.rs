//! Spools: entries in memory and in a temporary file.

use host_sim::files::spool::{Spool, blocks};
use proptest::prelude::*;

type Entry = (u64, Option<f64>);
type Entries = Spool<Entry, 19>;

/// Returns an entry of the longest encoded length, or a short one.
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
    /// 30,000 entries exceed the size that stays in memory.
    #[test]
    fn entries_are_read_back_by_number_in_any_order_of_writing(
        pushed in 0..30_000_usize,
        stretch in 1..2_000_usize,
    ) {
        let mut spool = Entries::default();
        for number in 0..pushed {
            spool.push(&entry(number)).unwrap();
        }
        // Stretches after those, the last one first, as smoothing writes them.
        for begin in (0..3).rev().map(|k| pushed + k * stretch) {
            spool.put(begin, (begin..begin + stretch).map(entry)).unwrap();
        }
        let count = pushed + 3 * stretch;
        prop_assert_eq!(spool.count(), count);
        prop_assert_eq!(read(&mut spool), (0..count).map(entry).collect::<Vec<_>>());
    }
}

#[test]
fn an_entry_that_exceeds_its_slot_is_an_error_and_is_not_stored() {
    let mut spool = Spool::<Entry, 18>::default();
    assert!(spool.push(&entry(0)).is_err());
    spool.push(&entry(1)).unwrap();
    assert_eq!(spool.count(), 1);
    assert_eq!(spool.read(0..1).unwrap(), [entry(1)]);
}

#[test]
fn entries_that_were_not_stored_cannot_be_read() {
    let mut spool = Entries::default();
    spool.push(&entry(0)).unwrap();
    assert!(spool.read(0..2).is_err());
}
