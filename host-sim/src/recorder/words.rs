//! Samples, finished cells and rows as words, for the [spool](crate::spool).

use crate::run_file::RunRow;
use estimator_core::sampler::{
    AltitudeMeasurement, Circumstances, Continuity, Sample, SpeedMeasurement,
};
use estimator_core::vehicle::Load;
use estimator_core::{Cell, Condition, Instant, Maybe, Place, Uncertain};

/// Words of a sample.
pub const SAMPLE: usize = 25;
/// Words of what a row has of a finished cell.
pub const LOOKS: usize = 4;
/// Words of a row.
pub const ROW: usize = 32;

/// What was known of a cell's grade on the way, %.
#[derive(Clone, Copy, Debug)]
pub struct Looks {
    pub live: Uncertain,
    pub lagged: Uncertain,
}

impl From<&Cell> for Looks {
    fn from(cell: &Cell) -> Self {
        Self {
            live: cell.live_grade_percent,
            lagged: cell.lagged_grade_percent,
        }
    }
}

impl Looks {
    pub fn to_words(self) -> [u32; LOOKS] {
        let Self { live, lagged } = self;
        [live.value, live.sigma, lagged.value, lagged.sigma].map(f32::to_bits)
    }

    pub fn from_words(words: &[u32; LOOKS]) -> Self {
        let [live, live_sigma, lagged, lagged_sigma] = words.map(f32::from_bits);
        let uncertain = |value, sigma| Uncertain { value, sigma };
        Self {
            live: uncertain(live, live_sigma),
            lagged: uncertain(lagged, lagged_sigma),
        }
    }
}

/// One bit for each, the first the lowest.
fn bits<const N: usize>(flags: [bool; N]) -> u32 {
    let bit = |(k, flag)| u32::from(flag) << k;
    flags.into_iter().enumerate().map(bit).sum()
}

fn flags<const N: usize>(bits: u32) -> [bool; N] {
    std::array::from_fn(|k| bits >> k & 1 != 0)
}

pub fn sample_to_words(sample: &Sample) -> [u32; SAMPLE] {
    // Whole, so that a field that is added is not forgotten here.
    let Sample {
        place,
        gap_cells,
        length_m,
        duration_s,
        load,
        circumstances,
        speed,
        altitude,
        reopened,
    } = *sample;
    let Place {
        cell,
        time,
        position_e7,
        speed_mps,
        condition,
    } = place;
    let Condition {
        shifting,
        braking,
        no_traction,
        crawling,
    } = condition;
    let Load {
        traction_n,
        rotating_kg,
        mass_kg,
        air_density,
    } = load;
    let Circumstances {
        driven_s,
        yaw_rate_radps,
        course_deg,
        gnss_speed_mps,
        fan_percent,
        ambient_celsius,
        engaged,
    } = circumstances;
    let flags = bits([
        shifting,
        braking,
        no_traction,
        crawling,
        engaged,
        reopened,
        position_e7.is_some(),
        speed.is_some(),
        altitude.is_some(),
    ]);
    let (latitude, longitude) = position_e7.unwrap_or_default();
    let (mean_mps, speed_behind_m, count) = speed
        .map(|speed| {
            let SpeedMeasurement {
                mean_mps,
                behind_m,
                count,
            } = speed;
            (mean_mps, behind_m, count)
        })
        .unwrap_or_default();
    let (altitude_m, altitude_behind_m, dilution, continuity) = altitude
        .map(|fix| {
            let AltitudeMeasurement {
                altitude_m,
                behind_m,
                dilution,
                continuity,
            } = fix;
            (altitude_m, behind_m, dilution, continuity)
        })
        .unwrap_or_default();
    let maybe = |number: Maybe| number.get().unwrap_or(f32::NAN).to_bits();
    let micros = time.micros();
    [
        cell,
        micros as u32,
        (micros >> 32) as u32,
        flags | u32::from(count) << 16 | (continuity as u32) << 24,
        latitude as u32,
        longitude as u32,
        speed_mps.to_bits(),
        gap_cells,
        length_m.to_bits(),
        duration_s.to_bits(),
        traction_n.to_bits(),
        rotating_kg.to_bits(),
        mass_kg.to_bits(),
        air_density.to_bits(),
        driven_s.to_bits(),
        maybe(yaw_rate_radps),
        maybe(course_deg),
        maybe(gnss_speed_mps),
        maybe(fan_percent),
        maybe(ambient_celsius),
        mean_mps.to_bits(),
        speed_behind_m.to_bits(),
        altitude_m.to_bits(),
        altitude_behind_m.to_bits(),
        dilution.to_bits(),
    ]
}

pub fn sample_from_words(words: &[u32; SAMPLE]) -> Sample {
    let number = |k: usize| f32::from_bits(words[k]);
    let maybe = |k: usize| Maybe::some(number(k));
    let [
        shifting,
        braking,
        no_traction,
        crawling,
        engaged,
        reopened,
        has_position,
        has_speed,
        has_altitude,
    ] = flags(words[3]);
    Sample {
        place: Place {
            cell: words[0],
            time: Instant::from_micros(u64::from(words[2]) << 32 | u64::from(words[1])),
            position_e7: has_position.then_some((words[4] as i32, words[5] as i32)),
            speed_mps: number(6),
            condition: Condition {
                shifting,
                braking,
                no_traction,
                crawling,
            },
        },
        gap_cells: words[7],
        length_m: number(8),
        duration_s: number(9),
        load: Load {
            traction_n: number(10),
            rotating_kg: number(11),
            mass_kg: number(12),
            air_density: number(13),
        },
        circumstances: Circumstances {
            driven_s: number(14),
            yaw_rate_radps: maybe(15),
            course_deg: maybe(16),
            gnss_speed_mps: maybe(17),
            fan_percent: maybe(18),
            ambient_celsius: maybe(19),
            engaged,
        },
        speed: has_speed.then(|| SpeedMeasurement {
            mean_mps: number(20),
            behind_m: number(21),
            count: (words[3] >> 16) as u8,
        }),
        altitude: has_altitude.then(|| AltitudeMeasurement {
            altitude_m: number(22),
            behind_m: number(23),
            dilution: number(24),
            continuity: match words[3] >> 24 {
                0 => Continuity::Followed,
                1 => Continuity::Drifted,
                _ => Continuity::Switched,
            },
        }),
        reopened,
    }
}

pub fn row_to_words(row: &RunRow) -> [u32; ROW] {
    let RunRow {
        time_s,
        distance_m,
        latitude_deg,
        longitude_deg,
        altitude_m,
        altitude_sigma_m,
        grade_percent,
        grade_sigma_percent,
        lagged_grade_percent,
        lagged_grade_sigma_percent,
        live_grade_percent,
        live_grade_sigma_percent,
        speed_mps,
        bias_percent,
        scale,
        valid,
    } = *row;
    let optional = [latitude_deg, longitude_deg, altitude_m, altitude_sigma_m];
    let has = bits(optional.map(|value| value.is_some()));
    let [latitude, longitude, altitude, altitude_sigma] = optional.map(Option::unwrap_or_default);
    let mut words = [0; ROW];
    let numbers = [
        time_s,
        distance_m,
        latitude,
        longitude,
        altitude,
        altitude_sigma,
        grade_percent,
        grade_sigma_percent,
        lagged_grade_percent,
        lagged_grade_sigma_percent,
        live_grade_percent,
        live_grade_sigma_percent,
        speed_mps,
        bias_percent,
        scale,
    ];
    for (pair, number) in words.chunks_exact_mut(2).zip(numbers) {
        let bits = number.to_bits();
        pair.copy_from_slice(&[bits as u32, (bits >> 32) as u32]);
    }
    words[30] = has;
    words[31] = valid.into();
    words
}

pub fn row_from_words(words: &[u32; ROW]) -> RunRow {
    let number =
        |k: usize| f64::from_bits(u64::from(words[2 * k + 1]) << 32 | u64::from(words[2 * k]));
    let has: [bool; 4] = flags(words[30]);
    let optional = |k: usize| has[k].then(|| number(2 + k));
    RunRow {
        time_s: number(0),
        distance_m: number(1),
        latitude_deg: optional(0),
        longitude_deg: optional(1),
        altitude_m: optional(2),
        altitude_sigma_m: optional(3),
        grade_percent: number(6),
        grade_sigma_percent: number(7),
        lagged_grade_percent: number(8),
        lagged_grade_sigma_percent: number(9),
        live_grade_percent: number(10),
        live_grade_sigma_percent: number(11),
        speed_mps: number(12),
        bias_percent: number(13),
        scale: number(14),
        valid: words[31] as u8,
    }
}
