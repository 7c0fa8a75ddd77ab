//! A memory that is full, and the wear of its sectors.

use super::flash::{Memory, TestFlash};
use super::tracks::{Drive, Road, driven, known};
use estimator_core::roadmap::memory::Sector;

#[test]
fn the_least_useful_road_makes_room() {
    let (often, rarely) = (Road::new(1, 2_000), Road::new(2, 2_000));
    let mut flash = TestFlash::blank(12);
    for seed in 0..6 {
        flash = driven(flash, Drive::over(often, seed)).0;
    }
    flash = driven(flash, Drive::over(rarely, 7)).0;
    // New roads fill it up.
    for number in 3..15 {
        flash = driven(flash, Drive::over(Road::new(number, 2_000), 10)).0;
    }
    let cells = known(&flash.open());
    let of = |number: i32| cells.range((number, 0)..(number + 1, 0)).count();
    assert!(of(1) > 1_900, "{} cells of the road driven often", of(1));
    assert!(of(2) < 1_000, "{} cells of the road driven once", of(2));
    assert!(of(14) > 1_900, "{} cells of the newest road", of(14));
}

#[test]
fn all_sectors_are_written_alike() {
    let mut flash = TestFlash::blank(16);
    // Roads that fill two thirds are driven once, one of them again and again.
    for number in 1..6 {
        flash = driven(flash, Drive::over(Road::new(number, 3_000), 1)).0;
    }
    for seed in 0..150 {
        flash = driven(flash, Drive::over(Road::new(1, 3_000), seed)).0;
    }
    let memory = flash.open();
    let erases: Vec<u32> = memory.erases().collect();
    let (least, most) = (erases.iter().min(), erases.iter().max());
    let (least, most) = (*least.expect("sectors"), *most.expect("sectors"));
    let mean = erases.iter().sum::<u32>() / 16;
    assert!(mean > 30, "{erases:?}");
    assert!(most < 2 * mean && least * 2 > mean, "{erases:?}");
    assert!(known(&memory).len() > 14_000);
}

#[test]
fn the_ram_is_what_the_documentation_says() {
    // 27 kB, the flash memory of the test and the list of its sectors apart.
    let own = size_of::<Memory>() - size_of::<TestFlash>() - size_of::<Vec<Sector>>();
    assert!((20_000..=27_648).contains(&own), "{own} bytes");
    assert_eq!(size_of::<Sector>(), 24);
}

#[test]
fn a_road_is_found_among_many_sectors() {
    // More than a call goes over.
    let road = Road::new(1, 1_500);
    for sectors in [100, 140, 500] {
        let (flash, _) = driven(TestFlash::blank(sectors), Drive::over(road, 1));
        let mut memory = flash.open();
        let again = Drive::over(road, 2).with(&mut memory);
        assert!(again.errors.len() > 1_300, "{sectors}");
    }
}
