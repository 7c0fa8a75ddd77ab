//! Units of air temperature, air pressure, yaw rate and reported mass.

use super::distribution::Distribution;
use super::warning::Warning;
use estimator_core::VehicleParameters;

/// Least number of readings that are judged.
const READINGS: u32 = 10;
/// Temperature of air that is not measured anywhere, °C: the highest is 57.
const HOT_CELSIUS: f64 = 65.0;
/// Beyond this, it is no temperature in degrees Fahrenheit either.
const KELVIN: f64 = 180.0;
/// Pressures of air on roads, Pa: those of 6,000 m and of the highest ever measured, with margins.
const AIR_PA: (f64, f64) = (40_000.0, 120_000.0);
/// Sideways acceleration at which a heavy vehicle falls over or slides, m/s².
const SIDEWAYS_MPS2: f64 = 10.0;
/// Least speed at which a yaw rate is judged, m/s.
const DRIVING_MPS: f64 = 5.0;
/// Smallest mass of a vehicle, kg.
const LEAST_KG: f64 = 500.0;
/// Largest factor between the masses of one vehicle, empty and loaded.
const LOADS: f64 = 5.0;

/// Collects temperature, pressure, yaw rate and mass.
#[derive(Clone, Debug, Default)]
pub(super) struct Surroundings {
    celsius: Distribution,
    air_pa: Distribution,
    yaw_rates: u32,
    impossible_yaw_rates: u32,
    mass_kg: Distribution,
}

impl Surroundings {
    /// Takes an outside temperature, °C.
    pub(super) fn temperature(&mut self, celsius: f64) {
        self.celsius.add(celsius);
    }

    /// Takes an air pressure, Pa.
    pub(super) fn air_pressure(&mut self, pa: f64) {
        self.air_pa.add(pa);
    }

    /// Takes a yaw rate, rad/s, at a speed in m/s.
    pub(super) fn yaw_rate(&mut self, radps: f64, mps: f64) {
        if mps > DRIVING_MPS {
            self.yaw_rates = self.yaw_rates.saturating_add(1);
            self.impossible_yaw_rates += u32::from((radps * mps).abs() > SIDEWAYS_MPS2);
        }
    }

    /// Takes a reported mass, kg.
    pub(super) fn mass(&mut self, kg: f64) {
        self.mass_kg.add(kg);
    }

    /// Returns what is not plausible.
    pub(super) fn judge(&self, vehicle: &VehicleParameters, found: &mut Vec<Warning>) {
        let hot = self.celsius.median_of(READINGS);
        if let Some(celsius) = hot.filter(|celsius| *celsius > HOT_CELSIUS) {
            let unit = if celsius > KELVIN { "K" } else { "°F" };
            found.push(Warning::minor(
                "temperature_unit",
                format!(
                    "the outside temperature is {celsius:.0} °C (median): it looks like {unit}"
                ),
                "give the outside temperature in °C (column ambient_celsius)",
            ));
        }
        let (low, high) = AIR_PA;
        let wrong = self.air_pa.median_of(READINGS);
        if let Some(pa) = wrong.filter(|pa| !(low..high).contains(pa)) {
            found.push(Warning::minor(
                "air_pressure_unit",
                format!("the air pressure is {pa:.1} Pa (median), which no road has"),
                "give the air pressure in Pa (column air_pressure_pa): multiply hPa by 100",
            ));
        }
        if self.yaw_rates >= 10 * READINGS && self.impossible_yaw_rates > self.yaw_rates / 20 {
            found.push(Warning::minor(
                "yaw_rate_unit",
                "the vehicle would fall over at this yaw rate: it looks like °/s".to_owned(),
                "give the yaw rate in rad/s (column yaw_rate_radps): divide °/s by 57.29578",
            ));
        }
        found.extend(self.mass_unit(f64::from(vehicle.mass_kg)));
    }

    fn mass_unit(&self, file_kg: f64) -> Option<Warning> {
        let kg = self.mass_kg.median_of(1)?;
        let looks = if kg < LEAST_KG {
            "it looks like tonnes"
        } else if (kg / file_kg).ln().abs() > LOADS.ln() {
            "one of both is wrong"
        } else {
            return None;
        };
        Some(Warning::minor(
            "mass_unit",
            format!(
                "the reported mass is {kg:.0} kg, that of the vehicle file {file_kg:.0} kg: {looks}"
            ),
            "give the mass of the combination in kg (CVW, SPN 1760; column mass_kg); it is not used \
             as it is",
        ))
    }
}
