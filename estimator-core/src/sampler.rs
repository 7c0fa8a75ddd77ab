//! Readings of different rates, ages and sources become one sample a cell.
//!
//! The odometer moves from one speed reading to the next: between two of them speed is linear in
//! time and the force is the mean of what was read in between, so that the work done equals the
//! integral of the force whatever the rates. Each interval is then cut at the ends of cells.

use crate::cell::{CELL_LENGTH_M, Condition, Place};
use crate::counters::Counters;
use crate::signal::{Reading, Signal};
use crate::time::{Duration, Instant};
use crate::tuning::Tuning;
use crate::vehicle::{Driveline, Load, Traction, VehicleParameters, air_density};
use heapless::Deque;

/// Samples that may wait for the filter.
const QUEUE: usize = 32;
/// Longest time between two speed readings that is still bridged.
const LONGEST_INTERVAL: Duration = Duration::from_millis(2_500);
/// A torque older than this says nothing about the force now.
const TRACTION_STALE: Duration = Duration::from_millis(2_500);
/// A gear, a switch or a quality figure older than this is forgotten.
const STATE_STALE: Duration = Duration::from_millis(5_000);
/// A position this far behind is no longer extended along the road.
const POSITION_REACH_M: f32 = 200.0;
/// Pressure in the service brakes that is more than a sensor's offset, Pa.
const BRAKE_PRESSURE_PA: f32 = 20_000.0;
/// Fewest satellites that give an altitude.
const FEWEST_SATELLITES: f32 = 4.0;

/// Mean of the speed readings in a cell.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct SpeedMeasurement {
    /// Mean, m/s.
    pub mean_mps: f32,
    /// How far behind the cell's end it was taken, m.
    pub behind_m: f32,
    /// Number of readings.
    pub count: u8,
}

/// A GNSS altitude.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct AltitudeMeasurement {
    /// Altitude, m.
    pub altitude_m: f32,
    /// How far behind the cell's end it was taken, m; negative if beyond.
    pub behind_m: f32,
    /// Dilution of precision, at least 1.
    pub dilution: f32,
    /// The source is another one than before: its datum may differ by tens of metres.
    pub source_switched: bool,
}

/// What the filter sees of one cell.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Sample {
    /// Where and when the cell ends.
    pub place: Place,
    /// Cells driven since the last sample without one (a gap in the traffic), normally 0.
    pub gap_cells: u32,
    /// Time taken, s.
    pub duration_s: f32,
    /// Mean force and mass over the cell.
    pub load: Load,
    /// Speed readings in it.
    pub speed: Option<SpeedMeasurement>,
    /// GNSS altitude taken in it.
    pub altitude: Option<AltitudeMeasurement>,
}

/// A value and when it came.
#[derive(Clone, Copy, Debug)]
struct Timed {
    value: f32,
    time: Instant,
}

/// The newest value of a signal.
#[derive(Clone, Copy, Debug, Default)]
struct Latest(Option<Timed>);

impl Latest {
    fn set(&mut self, value: Option<f32>, time: Instant) {
        self.0 = value.map(|value| Timed { value, time });
    }

    fn within(&self, now: Instant, age: Duration) -> Option<f32> {
        self.0
            .filter(|timed| now.since(timed.time) <= age)
            .map(|timed| timed.value)
    }

    fn state(&self, now: Instant) -> Option<f32> {
        self.within(now, STATE_STALE)
    }

    fn is_on(&self, now: Instant) -> bool {
        self.state(now).is_some_and(|value| value > 0.5)
    }
}

/// The newest value of every signal that the sampler looks at again.
#[derive(Clone, Debug, Default)]
struct Board {
    torque_fraction: Latest,
    torque: Latest,
    friction: Latest,
    engine_speed: Latest,
    force: Latest,
    engaged: Latest,
    shifting: Latest,
    gear_ratio: Latest,
    gear: Latest,
    brake_switch: Latest,
    brake_pedal: Latest,
    brake_pressure: Latest,
    retarder: Latest,
    mass: Latest,
    ambient: Latest,
    pressure: Latest,
    method: Latest,
    satellites: Latest,
    hdop: Latest,
    vdop: Latest,
    wheel_speed: Latest,
}

/// Force over time since the last speed reading.
#[derive(Clone, Copy, Debug, Default)]
struct ForceIntegral {
    newton_seconds: f32,
    seconds: f32,
    last: Option<Timed>,
}

impl ForceIntegral {
    /// A new reading of the force: linear from the last one.
    fn reading(&mut self, force_n: f32, now: Instant) {
        let from = self.last.map_or(force_n, |last| last.value);
        self.extend(0.5 * (from + force_n), now);
        self.last = Some(Timed {
            value: force_n,
            time: now,
        });
    }

    /// The force changes at once (a gear, a clutch): what was, held until now, then the new one.
    fn step_to(&mut self, force_n: f32, now: Instant) {
        self.hold(now);
        self.last = Some(Timed {
            value: force_n,
            time: now,
        });
    }

    fn hold(&mut self, now: Instant) {
        if let Some(last) = self.last {
            self.extend(last.value, now);
            self.last = Some(Timed {
                value: last.value,
                time: now,
            });
        }
    }

    fn extend(&mut self, mean_n: f32, now: Instant) {
        if let Some(last) = self.last {
            let seconds = now.since(last.time).seconds();
            self.newton_seconds += mean_n * seconds;
            self.seconds += seconds;
        }
    }

    /// Mean force since the last call.
    fn take_mean(&mut self, now: Instant) -> f32 {
        self.hold(now);
        let mean = if self.seconds > 0.0 {
            self.newton_seconds / self.seconds
        } else {
            self.last.map_or(0.0, |last| last.value)
        };
        self.newton_seconds = 0.0;
        self.seconds = 0.0;
        mean
    }
}

/// The cell being driven.
#[derive(Clone, Copy, Debug, Default)]
struct OpenCell {
    length_m: f32,
    duration_s: f32,
    work_nm: f32,
    condition: Condition,
    speed_sum: f32,
    speed_place_sum: f32,
    speed_count: u8,
    gap_cells: u32,
}

/// A fix with its place, as metres from the start of the open cell.
#[derive(Clone, Copy, Debug)]
struct Fix {
    latitude_e7: i32,
    longitude_e7: i32,
    at_m: f32,
}

/// Collects readings and cuts the drive into samples.
#[derive(Clone, Debug)]
pub struct Sampler {
    board: Board,
    force: ForceIntegral,
    driveline: Driveline,
    shift_until: Instant,
    brake_until: Instant,
    started: Option<Instant>,
    last_speed: Option<Timed>,
    cell: u32,
    open: OpenCell,
    altitude: Option<(AltitudeMeasurement, f32)>,
    latitude_e7: Option<i32>,
    fix: Option<Fix>,
    earlier_fix: Option<Fix>,
    samples: Deque<Sample, QUEUE>,
}

impl Sampler {
    /// Nothing read yet.
    #[must_use]
    pub fn new() -> Self {
        Self {
            board: Board::default(),
            force: ForceIntegral::default(),
            driveline: Driveline::Unknown,
            shift_until: Instant::ZERO,
            brake_until: Instant::ZERO,
            started: None,
            last_speed: None,
            cell: 0,
            open: OpenCell::default(),
            altitude: None,
            latitude_e7: None,
            fix: None,
            earlier_fix: None,
            samples: Deque::new(),
        }
    }

    /// The next sample that is ready.
    pub fn next_sample(&mut self) -> Option<Sample> {
        self.samples.pop_front()
    }

    /// Takes one reading. `source_switched` tells that it comes from another sender than the
    /// signal did before.
    pub fn record(
        &mut self,
        vehicle: &VehicleParameters,
        tuning: &Tuning,
        now: Instant,
        reading: Reading,
        source_switched: bool,
        counters: &mut Counters,
    ) {
        self.started.get_or_insert(now);
        let value = reading.value.real();
        let board = &mut self.board;
        match reading.signal {
            Signal::EngineTorqueFraction => board.torque_fraction.set(value, now),
            Signal::FrictionTorque => board.friction.set(value, now),
            Signal::EngineSpeed => board.engine_speed.set(value, now),
            Signal::EngineTorque => {
                board.torque.set(value, now);
                self.torque_changed(vehicle, now, counters);
            }
            Signal::TractionForce => {
                board.force.set(value, now);
                if let Some(force_n) = value {
                    self.force.reading(force_n, now);
                    counters.tractions_used = counters.tractions_used.saturating_add(1);
                }
            }
            Signal::DrivelineEngaged => {
                let was_open = board.engaged.0.is_some_and(|last| last.value < 0.5);
                board.engaged.set(value, now);
                if value.is_some_and(|engaged| (engaged < 0.5) != was_open) {
                    self.shift_until = self.shift_until.max(now + tuning.shift_hold);
                    self.driveline_changed(vehicle, now);
                }
            }
            Signal::ShiftInProcess => {
                board.shifting.set(value, now);
                if board.shifting.is_on(now) {
                    self.shift_until = now + tuning.shift_hold;
                }
            }
            Signal::GearRatio => {
                board.gear_ratio.set(value, now);
                self.driveline_changed(vehicle, now);
            }
            Signal::CurrentGear => {
                board.gear.set(value, now);
                self.driveline_changed(vehicle, now);
            }
            Signal::BrakeSwitch => board.brake_switch.set(value, now),
            Signal::BrakePedal => board.brake_pedal.set(value, now),
            Signal::BrakePressure => board.brake_pressure.set(value, now),
            Signal::RetarderTorque => board.retarder.set(value, now),
            Signal::Mass => board.mass.set(value, now),
            Signal::AmbientTemperature => board.ambient.set(value, now),
            Signal::AirPressure => board.pressure.set(value, now),
            Signal::FixMethod => board.method.set(value, now),
            Signal::Satellites => board.satellites.set(value, now),
            Signal::Hdop => board.hdop.set(value, now),
            Signal::Vdop => board.vdop.set(value, now),
            Signal::Latitude => self.latitude_e7 = reading.value.degrees_e7(),
            Signal::Longitude => self.position(tuning, now, reading.value.degrees_e7()),
            Signal::Altitude => self.altitude(tuning, now, value, source_switched, counters),
            Signal::WheelSpeed => {
                board.wheel_speed.set(value, now);
                self.speed(vehicle, tuning, now, value, counters);
            }
            Signal::FrontAxleSpeed => {
                // Stands in where the wheel-based speed is missing.
                if board.wheel_speed.within(now, LONGEST_INTERVAL).is_none() {
                    self.speed(vehicle, tuning, now, value, counters);
                }
            }
            Signal::EngineTorqueMode
            | Signal::ParasiticTorque
            | Signal::ClutchSlip
            | Signal::ClutchSwitch
            | Signal::OutputShaftSpeed
            | Signal::SelectedGear
            | Signal::ParkingBrake
            | Signal::Passengers
            | Signal::Fan
            | Signal::YawRate
            | Signal::Course
            | Signal::GnssSpeed => {}
        }
    }

    fn torque_changed(
        &mut self,
        vehicle: &VehicleParameters,
        now: Instant,
        counters: &mut Counters,
    ) {
        let Traction::Powertrain(powertrain) = &vehicle.traction else {
            return;
        };
        if self.board.gear_ratio.state(now).is_none() && self.board.gear.state(now).is_none() {
            self.driveline = self.driveline_of_speeds(powertrain, vehicle.wheel_radius_m, now);
        }
        if let Some(net) = self.net_torque_percent(now) {
            self.force
                .reading(vehicle.traction_n(self.driveline, net), now);
            if self.driveline != Driveline::Unknown {
                counters.tractions_used = counters.tractions_used.saturating_add(1);
            }
        }
    }

    fn net_torque_percent(&self, now: Instant) -> Option<f32> {
        let torque = self.board.torque.within(now, TRACTION_STALE)?;
        let fraction = self.board.torque_fraction.within(now, TRACTION_STALE);
        let friction = self.board.friction.state(now);
        Some(torque + fraction.unwrap_or(0.0) - friction.unwrap_or(0.0))
    }

    fn driveline_of_speeds(
        &self,
        powertrain: &crate::vehicle::Powertrain,
        wheel_radius_m: f32,
        now: Instant,
    ) -> Driveline {
        match (
            self.board.engine_speed.within(now, TRACTION_STALE),
            self.last_speed,
        ) {
            (Some(rpm), Some(speed)) => powertrain
                .gear_of_speeds(rpm, speed.value, wheel_radius_m)
                .map_or(Driveline::Unknown, Driveline::Engaged),
            _ => Driveline::Unknown,
        }
    }

    fn driveline_changed(&mut self, vehicle: &VehicleParameters, now: Instant) {
        let Traction::Powertrain(powertrain) = &vehicle.traction else {
            return;
        };
        let open = self.board.engaged.state(now).is_some_and(|e| e < 0.5);
        let number = self.board.gear.state(now);
        let driveline = if open || number.is_some_and(|n| n.abs() < 0.5) {
            Driveline::Open
        } else {
            let by_ratio = self
                .board
                .gear_ratio
                .state(now)
                .and_then(|ratio| powertrain.gear_of_ratio(ratio));
            let by_number = number.and_then(|n| powertrain.gear(n as i32));
            by_ratio
                .or(by_number)
                .map_or(Driveline::Unknown, Driveline::Engaged)
        };
        if driveline != self.driveline {
            self.driveline = driveline;
            if let Some(net) = self.net_torque_percent(now) {
                self.force.step_to(vehicle.traction_n(driveline, net), now);
            }
        }
    }

    fn condition(
        &mut self,
        vehicle: &VehicleParameters,
        tuning: &Tuning,
        now: Instant,
    ) -> Condition {
        let board = &self.board;
        if board.shifting.is_on(now) {
            self.shift_until = now + tuning.shift_hold;
        }
        let braking = board.brake_switch.is_on(now)
            || board
                .brake_pedal
                .state(now)
                .is_some_and(|pedal| pedal > 0.5)
            || board
                .brake_pressure
                .state(now)
                .is_some_and(|pa| pa > BRAKE_PRESSURE_PA)
            || board
                .retarder
                .state(now)
                .is_some_and(|torque| torque < -0.5);
        if braking {
            self.brake_until = now + tuning.brake_hold;
        }
        let traction_known = match vehicle.traction {
            Traction::Force => board.force.within(now, TRACTION_STALE).is_some(),
            Traction::Powertrain(_) => match self.driveline {
                Driveline::Open => true,
                Driveline::Engaged(_) => board.torque.within(now, TRACTION_STALE).is_some(),
                Driveline::Unknown => false,
            },
        };
        Condition {
            shifting: now < self.shift_until,
            braking: now < self.brake_until,
            no_traction: !traction_known,
            crawling: self.last_speed.is_none_or(|s| s.value < tuning.crawl_mps),
        }
    }

    fn position(&mut self, tuning: &Tuning, now: Instant, longitude_e7: Option<i32>) {
        let (Some(latitude_e7), Some(longitude_e7)) = (self.latitude_e7.take(), longitude_e7)
        else {
            return;
        };
        if latitude_e7.unsigned_abs() > 900_000_000 || longitude_e7.unsigned_abs() > 1_800_000_000 {
            return;
        }
        let fix = Fix {
            latitude_e7,
            longitude_e7,
            at_m: self.odometer_m(now) - self.lag_m(tuning),
        };
        // Two fixes close together give no direction.
        if self
            .fix
            .is_none_or(|last| fix.at_m - last.at_m > 0.5 * CELL_LENGTH_M)
        {
            self.earlier_fix = self.fix;
        }
        self.fix = Some(fix);
    }

    fn altitude(
        &mut self,
        tuning: &Tuning,
        now: Instant,
        value: Option<f32>,
        source_switched: bool,
        counters: &mut Counters,
    ) {
        let Some(altitude_m) = value.filter(|z| (-1_000.0..10_000.0).contains(z)) else {
            return;
        };
        let board = &self.board;
        let no_fix = board.method.state(now).is_some_and(|method| method < 0.5);
        let too_few = board
            .satellites
            .state(now)
            .is_some_and(|n| n < FEWEST_SATELLITES);
        if no_fix || too_few {
            counters.poor_fixes = counters.poor_fixes.saturating_add(1);
            return;
        }
        let dilution = board
            .vdop
            .state(now)
            .or(board.hdop.state(now))
            .unwrap_or(1.0);
        let measurement = AltitudeMeasurement {
            altitude_m,
            behind_m: 0.0,
            dilution: dilution.clamp(1.0, 50.0),
            source_switched,
        };
        let at_m = self.odometer_m(now) - self.lag_m(tuning);
        self.altitude = Some((measurement, at_m));
    }

    /// Way since the start of the open cell, m, as far as it can be told now.
    fn odometer_m(&self, now: Instant) -> f32 {
        self.open.length_m
            + self.last_speed.map_or(0.0, |last| {
                let ahead = now.since(last.time);
                if ahead < LONGEST_INTERVAL {
                    last.value * ahead.seconds()
                } else {
                    0.0
                }
            })
    }

    fn lag_m(&self, tuning: &Tuning) -> f32 {
        self.last_speed
            .map_or(0.0, |last| last.value * tuning.gnss_latency.seconds())
    }

    fn speed(
        &mut self,
        vehicle: &VehicleParameters,
        tuning: &Tuning,
        now: Instant,
        value: Option<f32>,
        counters: &mut Counters,
    ) {
        let Some(speed_mps) = value.filter(|v| (0.0..=70.0).contains(v)) else {
            return;
        };
        counters.speeds_used = counters.speeds_used.saturating_add(1);
        let reading = Timed {
            value: speed_mps,
            time: now,
        };
        let last = self.last_speed.replace(reading).unwrap_or(Timed {
            // The odometer counts from the first frame, not from the first speed.
            value: speed_mps,
            time: self.started.unwrap_or(now).max(now - LONGEST_INTERVAL),
        });
        let interval = now.since(last.time);
        let mean_force_n = self.force.take_mean(now);
        let condition = self.condition(vehicle, tuning, now);
        if interval > LONGEST_INTERVAL {
            self.gap(0.5 * (last.value + speed_mps) * interval.seconds());
            counters.gaps = counters.gaps.saturating_add(1);
        } else {
            self.drive(vehicle, last, reading, mean_force_n, condition, counters);
        }
        self.open.speed_sum += speed_mps;
        self.open.speed_place_sum += self.open.length_m;
        self.open.speed_count = self.open.speed_count.saturating_add(1);
    }

    /// Nothing is known of the way just driven but its rough length.
    fn gap(&mut self, way_m: f32) {
        let cells = (way_m / CELL_LENGTH_M).clamp(0.0, 4e9) as u32;
        self.cell = self.cell.saturating_add(cells);
        self.open = OpenCell {
            gap_cells: self.open.gap_cells.saturating_add(cells.max(1)),
            ..OpenCell::default()
        };
        self.altitude = None;
        self.fix = None;
        self.earlier_fix = None;
    }

    /// Moves the odometer over one interval and closes the cells in it.
    fn drive(
        &mut self,
        vehicle: &VehicleParameters,
        from: Timed,
        to: Timed,
        force_n: f32,
        condition: Condition,
        counters: &mut Counters,
    ) {
        let seconds = to.time.since(from.time).seconds();
        let way_m = 0.5 * (from.value + to.value) * seconds;
        let mut left_m = way_m;
        // At most 70 m/s for LONGEST_INTERVAL: 70 cells.
        while left_m > 0.0 {
            let room_m = CELL_LENGTH_M - self.open.length_m;
            let piece_m = left_m.min(room_m);
            let part = piece_m / way_m;
            self.open.work_nm += force_n * piece_m;
            self.open.duration_s += seconds * part;
            self.open.condition = self.open.condition.or(condition);
            left_m -= piece_m;
            if piece_m < room_m {
                self.open.length_m += piece_m;
                break;
            }
            let done = 1.0 - left_m / way_m;
            let speed_mps = from.value + done * (to.value - from.value);
            let micros = to.time.since(from.time).micros() as f32 * done;
            let time = from.time + Duration::from_micros(micros as u64);
            self.close_cell(vehicle, time, speed_mps, counters);
        }
    }

    fn close_cell(
        &mut self,
        vehicle: &VehicleParameters,
        time: Instant,
        speed_mps: f32,
        counters: &mut Counters,
    ) {
        let open = core::mem::take(&mut self.open);
        self.cell = self.cell.saturating_add(1);
        let count = f32::from(open.speed_count);
        let sample = Sample {
            place: Place {
                cell: self.cell,
                time,
                position_e7: self.position_at(CELL_LENGTH_M),
                speed_mps,
                condition: open.condition,
            },
            gap_cells: open.gap_cells,
            duration_s: open.duration_s,
            load: Load {
                traction_n: open.work_nm / CELL_LENGTH_M,
                rotating_kg: vehicle.rotating_kg(self.driveline),
                mass_kg: self.mass_kg(vehicle),
                air_density: air_density(
                    self.board.pressure.0.map(|p| p.value),
                    self.board.ambient.0.map(|t| t.value),
                ),
            },
            speed: (open.speed_count > 0).then(|| SpeedMeasurement {
                mean_mps: open.speed_sum / count,
                behind_m: CELL_LENGTH_M - open.speed_place_sum / count,
                count: open.speed_count,
            }),
            altitude: self.altitude_before(CELL_LENGTH_M),
        };
        for fix in [&mut self.fix, &mut self.earlier_fix].into_iter().flatten() {
            fix.at_m -= CELL_LENGTH_M;
        }
        if self.samples.push_back(sample).is_err() {
            counters.samples_lost = counters.samples_lost.saturating_add(1);
        }
    }

    /// The mass last told, if a vehicle like this one can have it, else the parameter.
    fn mass_kg(&self, vehicle: &VehicleParameters) -> f32 {
        self.board
            .mass
            .0
            .map(|mass| mass.value)
            .filter(|mass| (0.2 * vehicle.mass_kg..5.0 * vehicle.mass_kg).contains(mass))
            .unwrap_or(vehicle.mass_kg)
    }

    /// The waiting altitude, if it was taken before `end_m`; else it waits for the next cell.
    fn altitude_before(&mut self, end_m: f32) -> Option<AltitudeMeasurement> {
        let (mut measurement, at_m) = self.altitude?;
        if at_m > end_m {
            self.altitude = Some((measurement, at_m - end_m));
            return None;
        }
        self.altitude = None;
        measurement.behind_m = end_m - at_m;
        Some(measurement)
    }

    /// The position at `at_m` from the start of the open cell, on the line through the last two
    /// fixes.
    fn position_at(&self, at_m: f32) -> Option<(i32, i32)> {
        let fix = self.fix?;
        let beyond_m = at_m - fix.at_m;
        if beyond_m > POSITION_REACH_M {
            return None;
        }
        let Some(earlier) = self.earlier_fix else {
            return Some((fix.latitude_e7, fix.longitude_e7));
        };
        let ratio = beyond_m / (fix.at_m - earlier.at_m);
        let extend = |now: i32, before: i32| {
            let step = now.wrapping_sub(before) as f32 * ratio;
            now.saturating_add(step as i32)
        };
        Some((
            extend(fix.latitude_e7, earlier.latitude_e7),
            extend(fix.longitude_e7, earlier.longitude_e7),
        ))
    }
}

impl Default for Sampler {
    fn default() -> Self {
        Self::new()
    }
}
