//! Effect of a wrong parameter on the pointwise grade (thesis section 4.1, figure 7).
//!
//! The truck drives steadily, so eq. 9 has no acceleration and no inertia. With f = F/(mg) the
//! force at the wheels over the weight, d the part of air drag in it, c the rolling resistance and
//! s the sine of the slope, f = s + c + d. The effect of each parameter on the estimated s is
//! derived by hand, and compared with the result of the filters' own code.

use super::definition::{Setting, Study, StudyOutcome};
use crate::comparison::{G, MeasuredDrive, MeasuredPoint, pointwise};
use crate::error::Result;
use crate::report::page::{Figure, Section, Table};
use crate::report::plot::{Mark, Plot, Series, colour, shaded_ranges};
use crate::simulator::driver::SET_SPEED_MPS;
use crate::simulator::truck::{Preset, Truck};
use estimator_core::vehicle::STANDARD_AIR_DENSITY;
use estimator_core::{Traction, VehicleParameters};
use plotters::style::RGBColor;

/// Factor of a wrong parameter.
pub const FACTOR: f64 = 1.2;
/// Largest grade on either side of level, %.
const STEEPEST_PERCENT: f64 = 6.0;
/// Distance between computed grades, %.
const STEP_PERCENT: f64 = 0.05;
/// Range of engine speeds under full load, rpm.
const ENGINE_RPM: (f64, f64) = (900.0, 1_900.0);
/// Grade on either side of level for the slope of the error, %. No truck brakes or loses speed on
/// it.
const NEAR_LEVEL_PERCENT: f64 = 0.1;

/// The study, for the list.
pub const STUDY: Study = Study {
    name: "sensitivity",
    about: "pointwise grade error against grade, one parameter wrong at a time (figure 7)",
    run,
};

/// A parameter that may be wrong.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Parameter {
    /// Mass.
    Mass,
    /// The whole drag term.
    Drag,
    /// Rolling resistance.
    Rolling,
    /// Reference torque; the bus reports a percentage of it.
    Torque,
    /// Wheel radius, in the torque's lever only. As in the thesis, speed is as measured.
    WheelRadius,
    /// Efficiency of the driveline.
    Driveline,
    /// Air speed, in the drag term only: wind.
    Wind,
}

impl Parameter {
    /// All parameters, in the thesis's order.
    pub const ALL: [Self; 7] = [
        Self::Mass,
        Self::Drag,
        Self::Rolling,
        Self::Torque,
        Self::WheelRadius,
        Self::Driveline,
        Self::Wind,
    ];

    const fn name(self) -> &'static str {
        match self {
            Self::Mass => "mass",
            Self::Drag => "drag",
            Self::Rolling => "rolling",
            Self::Torque => "torque",
            Self::WheelRadius => "wheel radius",
            Self::Driveline => "driveline",
            Self::Wind => "v (wind)",
        }
    }

    /// Returns the colour and mark. Torque and driveline have the same effect; their curves
    /// coincide.
    const fn drawn(self) -> (RGBColor, Mark) {
        match self {
            Self::Mass => (colour::BLUE, Mark::Line),
            Self::Drag => (colour::GREEN, Mark::Line),
            Self::Rolling => (colour::PURPLE, Mark::Line),
            Self::Torque => (colour::ORANGE, Mark::Line),
            Self::WheelRadius => (colour::GREY, Mark::Dashed),
            Self::Driveline => (colour::BLACK, Mark::Dashed),
            Self::Wind => (colour::GREEN, Mark::Dashed),
        }
    }
}

/// Working point of a truck on a grade.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct WorkingPoint {
    /// True grade, %.
    pub grade_percent: f64,
    /// Steady speed, m/s.
    pub speed_mps: f64,
    /// Gear.
    pub gear: usize,
    /// Force at the wheels that keeps the speed, N; negative if it decelerates the truck.
    pub force_n: f64,
    /// Whether the engine brake alone cannot keep the speed.
    pub braking: bool,
}

/// Effect of a wrong parameter near the level road.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct GradeErrorEffect {
    /// Change of the error with the true grade, %/%.
    pub slope: f64,
    /// Error on the level, %.
    pub offset_percent: f64,
}

/// Returns the sine of the slope of a grade in %.
fn sine(grade_percent: f64) -> f64 {
    grade_percent / grade_percent.hypot(100.0)
}

/// Returns steady driving at 80 km/h where possible. Uphill the speed is the highest under full
/// load, in the best gear; downhill, engine and brakes hold the speed. Returns `None` if the truck
/// cannot climb the grade.
#[must_use]
pub fn working_point(truck: &Truck, grade_percent: f64) -> Option<WorkingPoint> {
    /// Step of the tried speeds, m/s.
    const STEP_MPS: f64 = 0.01;
    let speeds =
        (0..(SET_SPEED_MPS / STEP_MPS) as usize).map(|step| SET_SPEED_MPS - step as f64 * STEP_MPS);
    speeds.into_iter().find_map(|speed_mps| {
        let force_n = truck.resistance_n(speed_mps, STANDARD_AIR_DENSITY.into())
            + truck.mass_kg * G * sine(grade_percent);
        // The highest possible gear, which saves fuel.
        let gear = (1..=truck.top_gear()).rev().find(|&gear| {
            let rpm = truck.engine_rpm(gear, speed_mps);
            (ENGINE_RPM.0..=ENGINE_RPM.1).contains(&rpm)
                && truck.full_load_nm(rpm) * truck.force_per_torque(gear) >= force_n
        })?;
        let friction_nm = truck.friction_nm(truck.engine_rpm(gear, speed_mps));
        Some(WorkingPoint {
            grade_percent,
            speed_mps,
            gear,
            force_n,
            braking: force_n < -friction_nm * truck.force_per_torque(gear),
        })
    })
}

/// Returns the error of the pointwise grade (%) at a working point with one parameter at [`FACTOR`]
/// times its true value. Brake force counts as torque, as if a retarder reported it.
#[must_use]
pub fn error_percent(
    vehicle: &VehicleParameters,
    at: &WorkingPoint,
    parameter: Parameter,
) -> Option<f64> {
    let torque_nm = at.force_n / Truck::new(vehicle)?.force_per_torque(at.gear);
    let vehicle = assumed_vehicle(vehicle, parameter);
    let truck = Truck::new(&vehicle)?;
    let (mut torque_nm, mut air_density) = (torque_nm, f64::from(STANDARD_AIR_DENSITY));
    match parameter {
        Parameter::Torque => torque_nm *= FACTOR,
        // Drag depends on the square of air speed; other terms do not change.
        Parameter::Wind => air_density *= FACTOR * FACTOR,
        _ => {}
    }
    let point = MeasuredPoint {
        distance_m: 0.0,
        speed_mps: at.speed_mps,
        traction_n: torque_nm * truck.force_per_torque(at.gear),
        rotating_kg: truck.accelerated_kg(at.gear) - truck.mass_kg,
        air_density,
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
    Some(pointwise::at(&drive, &point, 0.0) - at.grade_percent)
}

/// Returns the vehicle with one parameter wrong.
fn assumed_vehicle(vehicle: &VehicleParameters, parameter: Parameter) -> VehicleParameters {
    let factor = FACTOR as f32;
    let mut assumed = vehicle.clone();
    match parameter {
        Parameter::Mass => assumed.mass_kg *= factor,
        Parameter::Drag => assumed.drag_area_m2 *= factor,
        Parameter::Rolling => assumed.rolling_resistance *= factor,
        Parameter::WheelRadius => assumed.wheel_radius_m *= factor,
        Parameter::Driveline => {
            if let Traction::Powertrain(powertrain) = &mut assumed.traction {
                powertrain.final_drive_efficiency *= factor;
            }
        }
        Parameter::Torque | Parameter::Wind => {}
    }
    assumed
}

/// Returns the slope and offset near the level road, from the filters' own code.
#[must_use]
pub fn numeric(vehicle: &VehicleParameters, parameter: Parameter) -> Option<GradeErrorEffect> {
    let truck = Truck::new(vehicle)?;
    let error = |grade| error_percent(vehicle, &working_point(&truck, grade)?, parameter);
    let (down, up) = (error(-NEAR_LEVEL_PERCENT)?, error(NEAR_LEVEL_PERCENT)?);
    Some(GradeErrorEffect {
        slope: (up - down) / (2.0 * NEAR_LEVEL_PERCENT),
        offset_percent: error(0.0)?,
    })
}

/// Returns the same derived by hand: the estimate of s with the parameter at k times its value,
/// less s, and its derivative in s.
#[must_use]
pub fn analytic(vehicle: &VehicleParameters, parameter: Parameter) -> GradeErrorEffect {
    let k = FACTOR;
    let c = f64::from(vehicle.rolling_resistance);
    let air_n = 0.5
        * f64::from(vehicle.drag_area_m2)
        * f64::from(STANDARD_AIR_DENSITY)
        * SET_SPEED_MPS.powi(2);
    let d = air_n / (f64::from(vehicle.mass_kg) * G);
    let (slope, offset) = match parameter {
        // (s + c) / k - c - s
        Parameter::Mass => (1.0 / k - 1.0, (1.0 / k - 1.0) * c),
        // d - k d
        Parameter::Drag => (0.0, (1.0 - k) * d),
        // c - k c
        Parameter::Rolling => (0.0, (1.0 - k) * c),
        // k (s + c + d) - c - d - s
        Parameter::Torque | Parameter::Driveline => (k - 1.0, (k - 1.0) * (c + d)),
        // (s + c + d) / k - c - d - s
        Parameter::WheelRadius => (1.0 / k - 1.0, (1.0 / k - 1.0) * (c + d)),
        // d - k² d
        Parameter::Wind => (0.0, (1.0 - k * k) * d),
    };
    GradeErrorEffect {
        slope,
        offset_percent: 100.0 * offset,
    }
}

fn run(_: &Setting) -> Result<StudyOutcome> {
    let vehicles = [Preset::A, Preset::B];
    Ok(StudyOutcome::Done(Section {
        heading: "Sensitivity of the pointwise grade (section 4.1, figure 7)".to_owned(),
        words: vec![
            "One parameter at a time is assumed at 120 % of its true value. The trucks hold 80 \
             km/h where possible. Uphill, full load in the best gear sets the speed; downhill, \
             engine and brakes together hold it, and their force counts as torque. The thesis \
             draws the lines and prints no numbers. Its statements can be verified here: mass and \
             torque have the largest effect and differ by a shift and a scale only, and wind \
             matters for the light truck (20 % is 4.4 m/s; the thesis: roughly 5 m/s)."
                .to_owned(),
            "Drag area, rolling resistance and engine of the trucks are not in the thesis. Common \
             values are used; offsets depend on them, slopes do not."
                .to_owned(),
        ],
        tables: vec![effects(&vehicles)],
        figures: vehicles.into_iter().filter_map(figure).collect(),
        ..Section::default()
    }))
}

fn figure(preset: Preset) -> Option<Figure> {
    let vehicle = preset.parameters();
    let truck = Truck::new(&vehicle)?;
    let steps = (STEEPEST_PERCENT / STEP_PERCENT).round() as i32;
    let points: Vec<WorkingPoint> = (-steps..=steps)
        .filter_map(|step| working_point(&truck, f64::from(step) * STEP_PERCENT))
        .collect();
    let mut plot = Plot::new("true grade (%)", "grade error (% grade)");
    plot.height = 380;
    let held = |at: &WorkingPoint| at.speed_mps >= SET_SPEED_MPS && !at.braking;
    plot.shaded = shaded_ranges(points.iter().map(|at| (at.grade_percent, !held(at))));
    for parameter in Parameter::ALL {
        let (colour, mark) = parameter.drawn();
        let errors = points
            .iter()
            .filter_map(|at| Some((at.grade_percent, error_percent(&vehicle, at, parameter)?)));
        plot = plot.with(Series::line(parameter.name(), colour, errors).drawn(mark));
    }
    let slowest = points
        .iter()
        .map(|at| at.speed_mps)
        .fold(f64::INFINITY, f64::min);
    let mut caption = format!(
        "Figure 7, vehicle {} ({:.0} t): error of the pointwise grade with one parameter at 120 %.",
        preset.name(),
        truck.mass_kg * 1e-3
    );
    if let Some(at) = points.iter().rfind(|at| at.braking) {
        let grade = at.grade_percent;
        caption +=
            &format!(" Grey: below {grade:.1} % the engine alone cannot hold the truck back.");
    }
    if let Some(at) = points.iter().find(|at| at.speed_mps < SET_SPEED_MPS) {
        caption += &format!(
            " From {:.1} % on it cannot keep 80 km/h (at {STEEPEST_PERCENT} %: {:.0} km/h).",
            at.grade_percent,
            slowest * 3.6
        );
    }
    let name = format!("sensitivity_{}", preset.name());
    Some(Figure::new(name, &plot, caption))
}

fn effects(presets: &[Preset]) -> Table {
    let header = [
        "vehicle",
        "parameter",
        "slope %/%",
        "by hand",
        "error on the level %",
        "by hand",
    ];
    let caption = "Slope of each line of figure 7 and its offset on the level road, computed by \
                   the filters' own code and by hand from eq. 9.";
    let rows = presets.iter().flat_map(|preset| {
        let vehicle = preset.parameters();
        Parameter::ALL.into_iter().filter_map(move |parameter| {
            let (found, by_hand) = (numeric(&vehicle, parameter)?, analytic(&vehicle, parameter));
            Some(vec![
                preset.name().to_owned(),
                parameter.name().to_owned(),
                format!("{:+.4}", found.slope),
                format!("{:+.4}", by_hand.slope),
                format!("{:+.4}", found.offset_percent),
                format!("{:+.4}", by_hand.offset_percent),
            ])
        })
    });
    Table::new("sensitivity", caption, &header).with_rows(rows)
}
