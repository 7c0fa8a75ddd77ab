//! Samples and cells, serialized and deserialized with serde.

use estimator_core::sample::{
    AltitudeContinuity, AltitudeMeasurement, EffectInputs, ForceInputs, InertialMeasurement,
    Sample, SlopeMeasurement, SlopeSensor, SpeedMeasurement,
};
use estimator_core::{Cell, CellEnd, Condition, Disagreement, Instant, Maybe, Uncertain};
use proptest::prelude::*;

fn cell_end() -> impl Strategy<Value = CellEnd> {
    let position = proptest::option::of((any::<i32>(), any::<i32>()));
    let flags = any::<[bool; 4]>();
    (any::<u32>(), any::<u64>(), position, -1e6..1e6_f32, flags).prop_map(
        |(cell, micros, position_e7, speed_mps, flags)| {
            let [shifting, braking, no_traction, crawling] = flags;
            CellEnd {
                cell,
                time: Instant::from_micros(micros),
                position_e7,
                speed_mps,
                condition: Condition {
                    shifting,
                    braking,
                    no_traction,
                    crawling,
                },
            }
        },
    )
}

fn maybe() -> impl Strategy<Value = Maybe> {
    proptest::option::of(-1e6..1e6_f32).prop_map(Maybe::from)
}

fn sample() -> impl Strategy<Value = Sample> {
    let speed = (-1e6..1e6_f32, any::<u8>()).prop_map(|(mean_mps, count)| SpeedMeasurement {
        mean_mps,
        behind_m: mean_mps / 3.0,
        count,
        resolution_mps: mean_mps / 5.0,
    });
    let continuity = prop_oneof![
        Just(AltitudeContinuity::Followed),
        Just(AltitudeContinuity::Switched)
    ];
    let altitude =
        (-1e6..1e6_f32, continuity).prop_map(|(altitude_m, continuity)| AltitudeMeasurement {
            altitude_m,
            behind_m: altitude_m / 7.0,
            dilution: 1.25,
            continuity,
        });
    let inertial =
        (-1e3..1e3_f32, any::<u8>()).prop_map(|(acceleration_mps2, count)| InertialMeasurement {
            acceleration_mps2,
            count,
            resolution_mps2: acceleration_mps2 / 3.0,
        });
    let measured = (
        proptest::option::of(speed),
        proptest::option::of(altitude),
        proptest::option::of(inertial),
    );
    let rest = (-1e6..1e6_f32, [maybe(), maybe()], any::<bool>());
    (cell_end(), any::<u32>(), measured, rest).prop_map(
        |(
            end,
            gap_cells,
            (speed, altitude, inertial),
            (number, [yaw_rate_radps, course_deg], flag),
        )| {
            Sample {
                end,
                gap_cells,
                length_m: 2.5,
                duration_s: number / 11.0,
                forces: ForceInputs {
                    traction_n: number,
                    rotating_kg: number / 13.0,
                    mass_kg: number / 17.0,
                    air_density: 1.2,
                },
                effect_inputs: EffectInputs {
                    driven_s: number / 19.0,
                    yaw_rate_radps,
                    course_deg,
                    engaged: flag,
                    ..EffectInputs::default()
                },
                speed,
                altitude,
                inertial,
                slope: flag.then_some(SlopeMeasurement {
                    slope_percent: number / 23.0,
                    sensor: SlopeSensor::Pitch,
                }),
                after_load_change: !flag,
                after_stop: flag,
                mass_is_reported: flag,
                torque_rest: Default::default(),
                retarder_n: 0.0,
                service_braking: false,
                traction_late_s: number,
                disagreement: Disagreement {
                    climb: flag,
                    gear: !flag,
                    ..Disagreement::default()
                },
                disagreeing_cells: number.abs() as u16,
            }
        },
    )
}

proptest! {
    /// JSON has no NaN, so an unknown value must not become one.
    #[test]
    fn a_sample_comes_back_as_it_was(sample in sample()) {
        let text = serde_json::to_string(&sample).unwrap();
        prop_assert_eq!(serde_json::from_str::<Sample>(&text).unwrap(), sample);
    }

    #[test]
    fn a_cell_comes_back_as_it_was(end in cell_end(), number in -1e6..1e6_f32, known in any::<bool>()) {
        let uncertain = |value| Uncertain { value, sigma: number.abs() };
        let cell = Cell {
            end,
            live_grade_percent: uncertain(number),
            lagged_grade_percent: uncertain(number / 3.0),
            altitude_m: known.then(|| uncertain(number / 7.0)),
            live_consistent: known,
            lagged_consistent: !known,
        };
        let text = serde_json::to_string(&cell).unwrap();
        prop_assert_eq!(serde_json::from_str::<Cell>(&text).unwrap(), cell);
    }
}

#[test]
fn unknown_values_are_null() {
    assert_eq!(serde_json::to_string(&Maybe::NONE).unwrap(), "null");
    assert_eq!(serde_json::from_str::<Maybe>("null").unwrap(), Maybe::NONE);
    assert_eq!(serde_json::to_string(&Maybe::some(1.5)).unwrap(), "1.5");
}
