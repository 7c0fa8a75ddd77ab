//! A curvy, hilly drive of a vehicle that may differ from its model.

use estimator_core::{
    Estimate, Estimator, Instant, Model, Reading, Signal, Step, Traction, Tuning, Value,
    VehicleParameters,
};

/// The true state of the vehicle at a moment.
#[derive(Clone, Copy)]
pub struct VehicleMoment {
    pub seconds: f32,
    pub speed_mps: f32,
    pub driven_m: f32,
    /// Positive to the left.
    pub yaw_rate_radps: f32,
    pub course_deg: f32,
    pub fan_percent: f32,
    /// Traction force that the base model needs for this motion, N.
    pub force_n: f32,
}

/// A difference from the vehicle of the base model.
#[derive(Clone, Copy)]
pub struct PlantedDifference {
    /// Returns the reported traction, instead of the force that the base model needs, N.
    pub reported_n: fn(&VehicleMoment) -> f32,
    /// Ratio of the true speed to the reported speed.
    pub true_over_reported: f32,
}

/// No difference.
pub const PLAIN: PlantedDifference = PlantedDifference {
    reported_n: |moment| moment.force_n,
    true_over_reported: 1.0,
};

/// Air temperature that is reported, °C.
pub const AMBIENT_CELSIUS: f32 = 5.0;
const STEP_S: f32 = 0.1;
const LATITUDE_DEG: f64 = 58.0;
const M_PER_DEG: f64 = 111_132.0;

/// Drives for `seconds` and returns the estimates of all cells. A vehicle with an engine reports
/// torque, in a gear of ratio one and for the wheels of `truth`.
pub fn drive(
    assumed: &Model,
    truth: &VehicleParameters,
    planted: PlantedDifference,
    seconds: f32,
) -> Vec<Estimate> {
    let mut estimator = Estimator::<f32>::new(assumed.clone(), Tuning::default()).unwrap();
    let mut estimates = Vec::new();
    let mut driven_m = 0.0_f32;
    let mut north_m = 0.0_f64;
    let mut course_deg = 20.0_f32;
    for tick in 0..(seconds / STEP_S) as u32 {
        let time_s = tick as f32 * STEP_S;
        let speed_mps = 18.0 + 4.0 * (0.02 * time_s).sin();
        let gain_mps2 = 4.0 * 0.02 * (0.02 * time_s).cos();
        let yaw_rate_radps = 0.06 * (0.05 * time_s).sin();
        let slope = 0.02 * (driven_m / 190.0).sin();
        let altitude_m = 200.0 + 0.02 * 190.0 * (1.0 - (driven_m / 190.0).cos());
        let rotating_kg = truth.wheel_inertia_kgm2 / truth.wheel_radius_m.powi(2);
        let resistance_n = 0.5 * 1.2 * truth.drag_area_m2 * speed_mps * speed_mps
            + truth.mass_kg * 9.806_65 * (truth.rolling_resistance + slope);
        let moment = VehicleMoment {
            seconds: time_s,
            speed_mps,
            driven_m,
            yaw_rate_radps,
            course_deg,
            fan_percent: if (time_s / 60.0) as u32 % 2 == 1 {
                90.0
            } else {
                0.0
            },
            force_n: resistance_n + (truth.mass_kg + rotating_kg) * gain_mps2,
        };
        let now = Instant::from_micros(u64::from(tick) * 100_000);
        let mut put = |signal, value| {
            estimator.on_reading(now, Reading { signal, value });
        };
        let real = Value::Real;
        put(Signal::AmbientTemperature, real(AMBIENT_CELSIUS));
        put(Signal::Fan, real(moment.fan_percent));
        put(Signal::YawRate, real(yaw_rate_radps));
        put(Signal::Course, real(course_deg));
        match &truth.traction {
            Traction::Force => put(Signal::TractionForce, real((planted.reported_n)(&moment))),
            Traction::Powertrain(_) => report_torque(truth, &moment, planted, &mut put),
        }
        if tick % 10 == 1 {
            let e7 = |deg: f64| Value::DegreesE7((deg * 1e7) as i32);
            put(Signal::Latitude, e7(LATITUDE_DEG + north_m / M_PER_DEG));
            put(Signal::Longitude, e7(15.0));
            put(Signal::Altitude, real(altitude_m));
        }
        put(
            Signal::WheelSpeed,
            real(speed_mps / planted.true_over_reported),
        );
        while let Some(step) = estimator.step() {
            if step == Step::Moved {
                estimates.push(estimator.live().unwrap().estimate);
            }
            while estimator.next_cell().is_some() {}
        }
        driven_m += speed_mps * STEP_S + 0.5 * gain_mps2 * STEP_S * STEP_S;
        north_m += f64::from(speed_mps * STEP_S);
        course_deg = (course_deg - yaw_rate_radps.to_degrees() * STEP_S).rem_euclid(360.0);
    }
    estimates
}

/// Latitude at the start, and degrees of latitude for each 1,000 m. The reported position always
/// moves north.
pub const START_LATITUDE_DEG: f32 = 58.0;
pub const DEG_PER_KM: f32 = 1_000.0 / 111_132.0;

/// Reports the torque in the direct gear, with an engaged driveline.
fn report_torque(
    truth: &VehicleParameters,
    moment: &VehicleMoment,
    planted: PlantedDifference,
    put: &mut impl FnMut(Signal, Value),
) {
    let Traction::Powertrain(powertrain) = &truth.traction else {
        unreachable!("it has an engine");
    };
    let gear = powertrain.gears[10];
    let passes = gear.efficiency * powertrain.final_drive_efficiency;
    let turns = gear.ratio * powertrain.final_drive_ratio;
    let at_wheels_nm = (planted.reported_n)(moment) * truth.wheel_radius_m;
    let torque_nm = at_wheels_nm / (turns * passes);
    put(Signal::DrivelineEngaged, Value::Real(1.0));
    put(Signal::CurrentGear, Value::Real(11.0));
    let percent = 100.0 * torque_nm / powertrain.reference_torque_nm;
    put(Signal::EngineTorque, Value::Real(percent));
}
