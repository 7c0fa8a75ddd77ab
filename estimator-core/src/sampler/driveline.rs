//! What the driveline passes: which gear, and whether its torque arrives at the wheels.

use super::latest::Latest;
use super::traction::STALE;
use crate::signal::Signal;
use crate::time::Instant;
use crate::tuning::Tuning;
use crate::vehicle::{Driveline, Powertrain, Traction, VehicleParameters};

/// Slip of the clutch that is more than a sensor's offset, %; and what is left to full slip when
/// it is open.
const SLIP_PERCENT: f32 = 5.0;
/// Part by which engine and gear may differ in speed when nothing slips: worn tyres, and values of
/// unlike age. The narrowest gearboxes step by 1.17.
const SPEED_TOLERANCE: f32 = 0.1;
/// The same at launch, where the engine comes near the gear's speed long before it has it.
const LAUNCH_TOLERANCE: f32 = 0.05;

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
    gear: Latest,
    engine_speed: Latest,
}

/// The driveline at a moment.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(super) struct Passage {
    /// What it passes.
    pub driveline: Driveline,
    /// A shift, or a clutch that slips or may be about to: what arrives at the wheels is not told.
    pub in_transit: bool,
}

impl DrivelineInput {
    /// Takes a reading.
    pub(super) fn record(&mut self, now: Instant, signal: Signal, value: Option<f32>) {
        match signal {
            Signal::DrivelineEngaged => self.engaged.keep(value, now),
            Signal::ShiftInProcess => self.shifting.keep(value, now),
            Signal::ClutchSlip => self.clutch_slip.keep(value, now),
            Signal::ClutchSwitch => self.clutch_pedal.keep(value, now),
            // A gear that is no longer told is one that nobody knows.
            Signal::GearRatio => self.gear_ratio.set(value, now),
            Signal::CurrentGear => self.gear.set(value, now),
            Signal::EngineSpeed => self.engine_speed.set(value, now),
            _ => {}
        }
    }

    /// The driveline now, at a speed.
    pub(super) fn passage(
        &self,
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
            };
        }
        Passage {
            driveline: self.closed(powertrain, vehicle, tuning, now, speed_mps),
            in_transit: shifting || slips,
        }
    }

    /// The gear of a driveline that nothing tells to be open.
    fn closed(
        &self,
        powertrain: &Powertrain,
        vehicle: &VehicleParameters,
        tuning: &Tuning,
        now: Instant,
        speed_mps: Option<f32>,
    ) -> Driveline {
        let launches = speed_mps.is_none_or(|mps| mps < tuning.coast_mps);
        let clutch_told = self.is_clutch_told(now);
        let engine_rpm = self.engine_speed.within(now, STALE);
        let ratio = self.gear_ratio.state(now);
        let number = self.gear.state(now);
        let told = ratio
            .and_then(|ratio| powertrain.gear_of_ratio(ratio))
            .or_else(|| number.and_then(|number| powertrain.gear(number as i32)));
        let gear = match (told, engine_rpm, speed_mps) {
            (None, Some(rpm), Some(mps)) if ratio.is_none() && number.is_none() => {
                powertrain.gear_of_speeds(rpm, mps, vehicle.believed_radius_m())
            }
            // A gear is told whether it is in or not: where nothing else tells, and at launch,
            // the engine must turn with it.
            (Some(gear), Some(rpm), Some(mps)) if launches || !clutch_told => {
                let tolerance = if launches {
                    LAUNCH_TOLERANCE
                } else {
                    SPEED_TOLERANCE
                };
                let turned_rpm = powertrain.engine_rpm(gear, mps, vehicle.believed_radius_m());
                ((rpm - turned_rpm).abs() <= tolerance * turned_rpm).then_some(gear)
            }
            (told, ..) => told,
        };
        gear.map_or(Driveline::Unknown, Driveline::Engaged)
    }

    /// Whether anything tells of shifts or of the clutch.
    fn is_clutch_told(&self, now: Instant) -> bool {
        [&self.engaged, &self.shifting, &self.clutch_slip]
            .into_iter()
            .any(|signal| signal.state(now).is_some())
    }
}
