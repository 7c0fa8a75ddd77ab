//! What the driveline passes: which gear, and whether its torque arrives at the wheels.

use super::latest::Latest;
use super::traction::STALE;
use crate::signal::Signal;
use crate::time::Instant;
use crate::tuning::Tuning;
use crate::vehicle::{Driveline, Gear, Powertrain, Traction, VehicleParameters};

/// Slip of the clutch that is more than a sensor's offset, %; and what is left to full slip when
/// it is open.
const SLIP_PERCENT: f32 = 5.0;
/// Part by which engine and gear may differ in speed when nothing slips: worn tyres, and values of
/// unlike age. The narrowest gearboxes step by 1.17.
const SPEED_TOLERANCE: f32 = 0.1;
/// The same at launch, where the engine comes near the gear's speed long before it has it.
const LAUNCH_TOLERANCE: f32 = 0.05;

/// Speed readings with which the engine must have agreed on the whole before a told gear is doubted
/// for turning otherwise, and how many count: where it never did, it is the parameters that are off,
/// and where it no longer does for long, the vehicle.
const AGREED_READINGS: u16 = 100;
const MOST_AGREED_READINGS: u16 = 1_000;

/// Net engine torque that something other than its own auxiliaries must take up, %.
const LOADED_PERCENT: f32 = 10.0;

/// Signals that tell the state of the driveline.
#[derive(Clone, Debug, Default)]
pub(super) struct DrivelineInput {
    engaged: Latest,
    shifting: Latest,
    clutch_slip: Latest,
    clutch_pedal: Latest,
    gear_ratio: Latest,
    /// The gear of that ratio, so that it is looked for once.
    gear_of_ratio: Option<Gear>,
    gear: Latest,
    engine_speed: Latest,
    /// Readings in which the engine turned with the gear, less those in which it did not.
    agreed: u16,
}

/// The driveline at a moment.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(super) struct Passage {
    /// What it passes.
    pub driveline: Driveline,
    /// A shift, or a clutch that slips or may be about to: what arrives at the wheels is not told.
    pub in_transit: bool,
    /// Whether the engine's speed has a say in it.
    pub asks_engine_speed: bool,
}

impl Passage {
    /// Of a driveline that nothing is known of.
    pub(super) const UNKNOWN: Self = Self {
        driveline: Driveline::Unknown,
        in_transit: false,
        asks_engine_speed: true,
    };
}

impl DrivelineInput {
    /// Takes a reading; true if it tells something else than the one before.
    pub(super) fn record(
        &mut self,
        vehicle: &VehicleParameters,
        now: Instant,
        signal: Signal,
        value: Option<f32>,
    ) -> bool {
        // A switch that is no longer told stays as it was; a gear is then one that nobody knows.
        let (latest, keeps) = match signal {
            Signal::DrivelineEngaged => (&mut self.engaged, true),
            Signal::ShiftInProcess => (&mut self.shifting, true),
            Signal::ClutchSlip => (&mut self.clutch_slip, true),
            Signal::ClutchSwitch => (&mut self.clutch_pedal, true),
            Signal::GearRatio => (&mut self.gear_ratio, false),
            Signal::CurrentGear => (&mut self.gear, false),
            Signal::EngineSpeed => (&mut self.engine_speed, false),
            _ => return false,
        };
        if keeps && value.is_none() {
            return false;
        }
        let changed = latest.state(now) != value;
        latest.set(value, now);
        if changed && signal == Signal::GearRatio {
            self.gear_of_ratio = match &vehicle.traction {
                Traction::Powertrain(powertrain) => {
                    value.and_then(|ratio| powertrain.gear_of_ratio(ratio))
                }
                Traction::Force => None,
            };
        }
        changed
    }

    /// The driveline now, at a speed.
    pub(super) fn passage(
        &mut self,
        vehicle: &VehicleParameters,
        tuning: &Tuning,
        now: Instant,
        speed_mps: Option<f32>,
        net_torque_percent: Option<f32>,
    ) -> Passage {
        let shifting = self.shifting.is_on(now);
        let Traction::Powertrain(powertrain) = &vehicle.traction else {
            return Passage {
                driveline: Driveline::Unknown,
                in_transit: shifting,
                asks_engine_speed: false,
            };
        };
        let engaged = self.engaged.state(now).map(|engaged| engaged > 0.5);
        let pedal = self.clutch_pedal.is_on(now);
        let slip_percent = self.clutch_slip.state(now).unwrap_or(0.0);
        let slips = slip_percent > SLIP_PERCENT;
        let neutral = self.gear.state(now).is_some_and(|gear| gear.abs() < 0.5);
        // Without a word on the driveline itself, a shift counts as open for as long as it takes.
        let open = engaged.map_or(shifting || slips, |engaged| !engaged) || neutral || pedal;
        if open {
            // At launch the clutch is not closed either, and passes all the torque. An engine
            // that nothing loads would run away.
            let coasts = speed_mps.is_some_and(|mps| mps >= tuning.coast_mps)
                && net_torque_percent.is_none_or(|percent| percent < LOADED_PERCENT);
            let half_open = slips && slip_percent < 100.0 - SLIP_PERCENT;
            return Passage {
                driveline: Driveline::Open,
                in_transit: shifting || pedal || half_open || !coasts,
                asks_engine_speed: false,
            };
        }
        let (driveline, asks_engine_speed) =
            self.closed(powertrain, vehicle, tuning, now, speed_mps);
        Passage {
            driveline,
            in_transit: shifting || slips,
            asks_engine_speed,
        }
    }

    /// What a closed driveline turns like at its wheels by what the engine does: revolutions a
    /// minute over the ratio of the gear.
    pub(super) fn turns(&self, now: Instant, driveline: Driveline) -> Option<f32> {
        match driveline {
            Driveline::Engaged(gear) => {
                let rpm = self.engine_speed.within(now, STALE)?;
                Some(rpm / gear.ratio)
            }
            Driveline::Open | Driveline::Unknown => None,
        }
    }

    /// The gear of a driveline that nothing tells to be open, and whether that hangs on the speed of
    /// the engine.
    fn closed(
        &mut self,
        powertrain: &Powertrain,
        vehicle: &VehicleParameters,
        tuning: &Tuning,
        now: Instant,
        speed_mps: Option<f32>,
    ) -> (Driveline, bool) {
        let launches = speed_mps.is_none_or(|mps| mps < tuning.coast_mps);
        let clutch_told = self.is_clutch_told(now);
        let engine_rpm = self.engine_speed.within(now, STALE);
        let ratio = self.gear_ratio.state(now);
        let number = self.gear.state(now);
        let told = ratio
            .and(self.gear_of_ratio)
            .or_else(|| number.and_then(|number| powertrain.gear(number as i32)));
        let is_told = ratio.is_some() || number.is_some();
        let in_doubt = launches || !clutch_told;
        let gear = match (told, engine_rpm, speed_mps) {
            (None, Some(rpm), Some(mps)) if !is_told => {
                powertrain.gear_of_speeds(rpm, mps, vehicle.believed_radius_m())
            }
            // A gear is told whether it is in or not: where nothing else tells, and at launch, the
            // engine must turn with it. So it must where it did so far: else the gear is wrong.
            (Some(gear), Some(rpm), Some(mps)) => {
                let tolerance = if launches {
                    LAUNCH_TOLERANCE
                } else {
                    SPEED_TOLERANCE
                };
                let turned_rpm = powertrain.engine_rpm(gear, mps, vehicle.believed_radius_m());
                let turns = (rpm - turned_rpm).abs() <= tolerance * turned_rpm;
                if !in_doubt {
                    self.agreed = if turns {
                        MOST_AGREED_READINGS.min(self.agreed + 1)
                    } else {
                        self.agreed.saturating_sub(1)
                    };
                }
                let must_turn = in_doubt || self.agreed >= AGREED_READINGS;
                (turns || !must_turn).then_some(gear)
            }
            (told, ..) => told,
        };
        let driveline = gear.map_or(Driveline::Unknown, Driveline::Engaged);
        (driveline, in_doubt || !is_told)
    }

    /// Whether anything tells of shifts or of the clutch.
    fn is_clutch_told(&self, now: Instant) -> bool {
        [&self.engaged, &self.shifting, &self.clutch_slip]
            .into_iter()
            .any(|signal| signal.state(now).is_some())
    }
}
