//! The vehicle model and figure 7.

use estimator_core::{Traction, VehicleParameters};
use host_sim::comparison::{MeasuredDrive, MeasuredPoint, pointwise};
use host_sim::simulator::truck::{GRAVITY, Preset, Truck};
use host_sim::study::sensitivity::{Parameter, analytic, error_percent, numeric, working_point};

const AIR_DENSITY: f64 = 1.2;

/// Returns the residual of eq. 1-8: the acceleration that they give for an assumed one, less the
/// assumed one.
fn chained(
    vehicle: &VehicleParameters,
    gear: usize,
    torque_nm: f64,
    v: f64,
    alpha: f64,
    assumed: f64,
) -> f64 {
    let Traction::Powertrain(powertrain) = &vehicle.traction else {
        panic!("the presets have engines");
    };
    let m = f64::from(vehicle.mass_kg);
    let (r_w, j_w) = (
        f64::from(vehicle.wheel_radius_m),
        f64::from(vehicle.wheel_inertia_kgm2),
    );
    let (i_t, eta_t) = (
        f64::from(powertrain.gears[gear - 1].ratio),
        f64::from(powertrain.gears[gear - 1].efficiency),
    );
    let (i_f, eta_f) = (
        f64::from(powertrain.final_drive_ratio),
        f64::from(powertrain.final_drive_efficiency),
    );
    let theta = assumed / r_w * i_f * i_t;
    // (1) J_e θ'' = T_e - T_c, with the friction torque already subtracted.
    let t_c = torque_nm - f64::from(powertrain.engine_inertia_kgm2) * theta;
    // (2), (3) through gearbox and final drive.
    let t_f = i_t * eta_t * t_c;
    let t_w = i_f * eta_f * t_f;
    // (4)
    let f_a = t_w / r_w;
    // (5), (6), (7)
    let f_air = 0.5 * f64::from(vehicle.drag_area_m2) * AIR_DENSITY * v * v;
    let f_roll = m * GRAVITY * f64::from(vehicle.rolling_resistance);
    let f_grade = m * GRAVITY * alpha.sin();
    // (8)
    (f_a - f_air - f_roll - f_grade) / (m + j_w / (r_w * r_w)) - assumed
}

/// Returns the acceleration that solves eq. 1-8.
fn acceleration(
    vehicle: &VehicleParameters,
    gear: usize,
    torque_nm: f64,
    v: f64,
    alpha: f64,
) -> f64 {
    let (mut low, mut high) = (-50.0, 50.0);
    for _ in 0..200 {
        let middle = 0.5 * (low + high);
        if chained(vehicle, gear, torque_nm, v, alpha, middle) > 0.0 {
            low = middle;
        } else {
            high = middle;
        }
    }
    0.5 * (low + high)
}

/// The forces and speeds include climbing, engine braking, and low gears in which the engine's
/// inertia exceeds that of the truck.
#[test]
fn equation_9_is_equations_1_to_8_chained() {
    for preset in [Preset::A, Preset::B] {
        let vehicle = preset.parameters();
        let truck = Truck::new(&vehicle).unwrap();
        for gear in [1, 4, 8, 12] {
            for torque_nm in [-200.0, 0.0, 700.0, 1_600.0] {
                for v in [1.5, 8.0, 22.0] {
                    for grade_percent in [-6.0, 0.0, 2.5] {
                        let alpha = f64::atan(0.01 * grade_percent);
                        let point = MeasuredPoint {
                            distance_m: 0.0,
                            speed_mps: v,
                            traction_n: torque_nm * truck.force_per_torque(gear),
                            rotating_kg: truck.accelerated_kg(gear) - truck.mass_kg,
                            air_density: AIR_DENSITY,
                            altitude_m: None,
                            shifting: false,
                            braking: false,
                        };
                        let drive = MeasuredDrive {
                            mass_kg: truck.mass_kg,
                            drag_area_m2: vehicle.drag_area_m2.into(),
                            rolling_resistance: vehicle.rolling_resistance.into(),
                            points: Vec::new(),
                        };
                        let dv_dt = acceleration(&vehicle, gear, torque_nm, v, alpha);
                        let found = pointwise::at(&drive, &point, dv_dt);
                        assert!(
                            // The core's standard gravity is in single precision.
                            (found - grade_percent).abs() < 1e-5,
                            "{preset:?}, gear {gear}, {torque_nm} Nm, {v} m/s, {dv_dt} m/s²: \
                             {found} % for {grade_percent} %"
                        );
                    }
                }
            }
        }
    }
}

#[test]
fn each_slope_and_offset_is_that_of_the_analytic_derivative() {
    for preset in [Preset::A, Preset::B] {
        let vehicle = preset.parameters();
        for parameter in Parameter::ALL {
            let found = numeric(&vehicle, parameter).unwrap();
            let by_hand = analytic(&vehicle, parameter);
            assert!(
                // The value by hand uses sines, the computed one tangents: they differ by 1.5 s².
                (found.slope - by_hand.slope).abs() < 1e-4,
                "{preset:?}, {parameter:?}: {found:?}, by hand {by_hand:?}"
            );
            assert!(
                (found.offset_percent - by_hand.offset_percent).abs() < 5e-5,
                "{preset:?}, {parameter:?}: {found:?}, by hand {by_hand:?}"
            );
        }
    }
}

#[test]
fn the_statements_of_the_thesis_on_figure_7_hold() {
    let level = |preset: Preset, parameter| analytic(&preset.parameters(), parameter);
    for preset in [Preset::A, Preset::B] {
        let vehicle = preset.parameters();
        let truck = Truck::new(&vehicle).unwrap();
        let at = working_point(&truck, 2.0).unwrap();
        let error = |parameter| error_percent(&vehicle, &at, parameter).unwrap().abs();
        for small in [Parameter::Drag, Parameter::Rolling, Parameter::Wind] {
            assert!(
                error(Parameter::Torque) > error(small),
                "{preset:?}, {small:?}"
            );
            assert!(level(preset, small).slope.abs() < level(preset, Parameter::Mass).slope.abs());
        }
    }
    // "In the lighter vehicle, the effect of wind is significant."
    let wind = |preset| level(preset, Parameter::Wind).offset_percent;
    assert!(wind(Preset::B) < 2.5 * wind(Preset::A) && wind(Preset::A) < 0.0);
}

#[test]
fn the_truck_keeps_its_speed_where_it_can() {
    let truck = Truck::new(&Preset::A.parameters()).unwrap();
    let at = |grade| working_point(&truck, grade).unwrap();
    assert!((at(0.0).speed_mps * 3.6 - 80.0).abs() < 1e-9);
    assert!(!at(0.0).braking);
    assert!((at(-6.0).speed_mps * 3.6 - 80.0).abs() < 1e-9);
    assert!(at(-6.0).braking);
    // 310 hp for 39 t: about 30 km/h on 6 %, as 228 kW / (39 t g (6 % + 0.65 %)) says.
    let climbing = at(6.0);
    assert!((7.0..10.0).contains(&climbing.speed_mps), "{climbing:?}");
    assert!(climbing.gear < truck.top_gear());
    assert!(at(3.0).speed_mps > climbing.speed_mps);
    assert_eq!(working_point(&truck, 95.0), None);
}
