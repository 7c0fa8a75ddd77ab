//! The persistent state: what one drive leaves for the next, and its form in non-volatile memory.
//!
//! It holds the slow states with their covariance, and the noise of the sensors. Everything else is
//! found again within seconds. Wind is not kept: it is another one the next day.
//! [`crate::filter::prior`] decides how much of the persistent state the next drive starts with.
//!
//! The stored form has [`PersistentState::LEN`] bytes. Numbers are little endian, `f32` as in
//! IEEE 754:
//!
//! | offset | type | content |
//! |---|---|---|
//! | 0 | 4 bytes | `72 67 6b 1a`: "rgk" and a control byte |
//! | 4 | u32 | version of this table, 2 |
//! | 8 | u32 | fingerprint of the vehicle parameters: CRC-32 over them |
//! | 12 | f32 | mass of the model, kg |
//! | 16 | f32 | bias, % |
//! | 20 | f32 | its variance, %² |
//! | 24 | f32 | scale less one |
//! | 28 | f32 | its variance |
//! | 32 | f32 | covariance of the two, % |
//! | 36 | f32 | white noise of a wheel speed, 1 sigma, m/s |
//! | 40 | f32 | white noise of a GNSS altitude, 1 sigma, m |
//! | 44 | f32 | slow error of GNSS altitude, 1 sigma, m |
//! | 48 | f32 | offset of the accelerometer, m/s² |
//! | 52 | f32 | its variance, (m/s²)² |
//! | 56 | f32 | its gain, 1 |
//! | 60 | f32 | variance of the gain |
//! | 64 | f32 | noise of one of its readings, 1 sigma, m/s² |
//! | 68 | 5 f32 | the same of the pitch sensor, with % for m/s² and %/(m/s²) for the gain |
//! | 88 | u32 | CRC-32 (ISO-HDLC, as in zip and Ethernet) over the bytes before |
//!
//! The five numbers of a sensor that the vehicle lacks, or that the drive does not trust, are zero.
//!
//! On an ECU, write the bytes when the ignition goes off, into the older of two slots: an interrupted
//! write leaves the other slot intact. When the ignition comes on, read both slots and start with one
//! that is valid.
//!
//! ```
//! # use estimator_core::{Estimator, PersistentState, PersistentStateError, Traction, Tuning, VehicleParameters};
//! # let vehicle = VehicleParameters {
//! #     mass_kg: 19_000.0,
//! #     drag_area_m2: 5.2,
//! #     rolling_resistance: 0.008,
//! #     wheel_radius_m: 0.48,
//! #     wheel_inertia_kgm2: 60.0,
//! #     traction: Traction::Force,
//! # };
//! # let slot = [0xff; PersistentState::LEN];
//! # let mut written = None;
//! let restored = PersistentState::from_bytes(&slot)
//!     .and_then(|state| Estimator::<f32>::restore(vehicle.clone(), Tuning::default(), &state));
//! let estimator = match restored {
//!     Ok(estimator) => estimator,
//!     Err(_) => Estimator::new(vehicle, Tuning::default())?, // empty, damaged, or of another vehicle
//! };
//! // ... a drive later:
//! if let Some(state) = estimator.persistent_state() {
//!     written = Some(state.to_bytes());
//! }
//! # assert!(written.is_none());
//! # Ok::<(), estimator_core::ParameterError>(())
//! ```

use crate::cell::Uncertain;
use crate::filter::{
    BodySensor, BodySensors, ModelMass, SensorNoiseRatios, SlowStates, learned_sigma,
    variance_ratio,
};
use crate::model::Model;
use crate::scalar::Scalar;
use crate::tuning::{MeasurementNoise, Prior};
use crate::vehicle::{ParameterError, Traction};
use crc::{CRC_32_ISO_HDLC, Crc, NoTable};

/// First bytes of the stored form.
const MAGIC: u32 = u32::from_le_bytes(*b"rgk\x1a");
/// Version of the layout and of the meaning of its numbers.
const VERSION: u32 = 2;
/// Without a table: the data are short and flash is scarce.
const CHECKSUM: Crc<u32, NoTable> = Crc::<u32, NoTable>::new(&CRC_32_ISO_HDLC);

/// Number of 32-bit words.
const WORDS: usize = PersistentState::LEN / 4;
/// What is stored of a sensor that is not known.
const NO_SENSOR: BodySensor = BodySensor {
    offset: 0.0,
    offset_variance: 0.0,
    gain: 0.0,
    gain_variance: 0.0,
    noise_sigma: 0.0,
};
/// Number of bytes that the checksum covers.
const CHECKED: usize = PersistentState::LEN - 4;

/// Ranges of the values that a drive can leave. A correct checksum does not replace them.
mod possible {
    use core::ops::RangeInclusive;
    /// Mass, kg.
    pub const MASS: RangeInclusive<f32> = 100.0..=1e6;
    /// Bias, %.
    pub const BIAS: RangeInclusive<f32> = -50.0..=50.0;
    /// Scale error, 1.
    pub const SCALE: RangeInclusive<f32> = -0.9..=9.0;
    /// Variances of bias, %², and scale, 1.
    pub const VARIANCE: RangeInclusive<f32> = 1e-12..=1e4;
    /// Offset and gain of a sensor on the body, m/s² or %.
    pub const ERROR: RangeInclusive<f32> = -50.0..=50.0;
    /// Sigmas of the sensors, m/s, m, m/s² or %.
    pub const SIGMA: RangeInclusive<f32> = 1e-6..=1e4;
    /// Square of the correlation. Rounding may leave it slightly above one.
    pub const CORRELATION: RangeInclusive<f32> = 0.0..=1.001;
}

/// What one drive leaves for the next: the slow states and the noise of the sensors.
#[derive(Clone, Copy, Debug, PartialEq)]
#[cfg_attr(feature = "defmt", derive(defmt::Format))]
pub struct PersistentState {
    fingerprint: u32,
    slow: SlowStates,
    sensors: SensorSigmas,
    body: BodySensors,
}

/// Noise of the sensors as sigmas with units: the tuning may differ in the next release.
#[derive(Clone, Copy, Debug, PartialEq)]
#[cfg_attr(feature = "defmt", derive(defmt::Format))]
struct SensorSigmas {
    speed_mps: f32,
    altitude_m: f32,
    gnss_error_m: f32,
}

/// Why stored data are not used.
#[derive(Clone, Copy, Debug, PartialEq)]
#[cfg_attr(feature = "defmt", derive(defmt::Format))]
pub enum PersistentStateError {
    /// They have this many bytes, not [`PersistentState::LEN`].
    Length(usize),
    /// They do not start with the magic number: something else, or never written.
    Magic,
    /// Another release wrote them, with this version of the layout.
    Version(u32),
    /// They are damaged.
    Checksum,
    /// They hold a value that no drive can leave.
    Value,
    /// They belong to another vehicle, or to other parameters.
    Vehicle,
    /// The model has a parameter that no vehicle can have.
    Parameter(ParameterError),
}

impl core::fmt::Display for PersistentStateError {
    fn fmt(&self, f: &mut core::fmt::Formatter<'_>) -> core::fmt::Result {
        match self {
            Self::Length(length) => write!(f, "{length} bytes: expected {}", PersistentState::LEN),
            Self::Magic => f.write_str("not a persistent state"),
            Self::Version(version) => write!(f, "version {version}: expected {VERSION}"),
            Self::Checksum => f.write_str("damaged: the checksum does not match"),
            Self::Value => f.write_str("holds a value that no drive can leave"),
            Self::Vehicle => f.write_str("belongs to another vehicle, or to other parameters"),
            Self::Parameter(error) => error.fmt(f),
        }
    }
}

impl core::error::Error for PersistentStateError {}

impl From<ParameterError> for PersistentStateError {
    fn from(error: ParameterError) -> Self {
        Self::Parameter(error)
    }
}

impl PersistentState {
    /// Length of the stored form, bytes.
    pub const LEN: usize = 92;

    /// Creates what a drive leaves; `None` if a value could not be read back.
    pub(crate) fn new(
        fingerprint: u32,
        tuning: &MeasurementNoise,
        slow: SlowStates,
        noise: &SensorNoiseRatios,
        body: BodySensors,
    ) -> Option<Self> {
        let state = Self {
            fingerprint,
            slow,
            sensors: SensorSigmas {
                speed_mps: learned_sigma(noise.speed, tuning.speed_sigma_mps),
                altitude_m: learned_sigma(noise.altitude, tuning.altitude_sigma_m),
                gnss_error_m: learned_sigma(noise.gnss_error, tuning.gnss_error_sigma_m),
            },
            body: BodySensors {
                accelerometer: body.accelerometer.filter(is_possible_sensor),
                pitch: body.pitch.filter(is_possible_sensor),
            },
        };
        state.is_possible().then_some(state)
    }

    /// Returns the slow states of the vehicle.
    #[must_use]
    pub const fn slow_states(&self) -> &SlowStates {
        &self.slow
    }

    /// Returns what is known of the sensors on the body.
    #[must_use]
    pub const fn body_sensors(&self) -> &BodySensors {
        &self.body
    }

    /// Returns the gross mass that the drive ended with, kg, as its scale says. The model must be
    /// that of the drive ([`Self::check_model`]). A mass that was reported at the time has no part
    /// in it: the next drive is told it again.
    #[must_use]
    pub fn mass_kg(&self, model: &Model, tuning: &Prior) -> Uncertain {
        let scale = Uncertain {
            value: 1.0 + self.slow.scale_error,
            sigma: Scalar::sqrt(self.slow.scale_variance),
        };
        ModelMass::parameter(model, tuning, self.slow.mass_kg).gross_kg(scale)
    }

    /// Returns the noise of the sensors, relative to what this tuning assumes.
    #[must_use]
    pub fn noise(&self, tuning: &MeasurementNoise) -> SensorNoiseRatios {
        SensorNoiseRatios {
            speed: variance_ratio(self.sensors.speed_mps, tuning.speed_sigma_mps),
            altitude: variance_ratio(self.sensors.altitude_m, tuning.altitude_sigma_m),
            gnss_error: variance_ratio(self.sensors.gnss_error_m, tuning.gnss_error_sigma_m),
        }
    }

    /// Checks that it was learned with this model.
    ///
    /// # Errors
    /// [`PersistentStateError::Vehicle`] if not.
    pub fn check_model(&self, model: &Model) -> Result<(), PersistentStateError> {
        if self.fingerprint == fingerprint(model) {
            Ok(())
        } else {
            Err(PersistentStateError::Vehicle)
        }
    }

    /// Returns the stored form.
    #[must_use]
    pub fn to_bytes(&self) -> [u8; Self::LEN] {
        let Self {
            fingerprint,
            slow,
            sensors,
            body,
        } = self;
        let accelerometer = body.accelerometer.unwrap_or(NO_SENSOR);
        let pitch = body.pitch.unwrap_or(NO_SENSOR);
        let bits = f32::to_bits;
        let words: [u32; WORDS - 1] = [
            MAGIC,
            VERSION,
            *fingerprint,
            bits(slow.mass_kg),
            bits(slow.bias_percent),
            bits(slow.bias_variance),
            bits(slow.scale_error),
            bits(slow.scale_variance),
            bits(slow.covariance),
            bits(sensors.speed_mps),
            bits(sensors.altitude_m),
            bits(sensors.gnss_error_m),
            bits(accelerometer.offset),
            bits(accelerometer.offset_variance),
            bits(accelerometer.gain),
            bits(accelerometer.gain_variance),
            bits(accelerometer.noise_sigma),
            bits(pitch.offset),
            bits(pitch.offset_variance),
            bits(pitch.gain),
            bits(pitch.gain_variance),
            bits(pitch.noise_sigma),
        ];
        let mut bytes = [0; Self::LEN];
        for (place, word) in bytes.chunks_exact_mut(4).zip(words) {
            place.copy_from_slice(&word.to_le_bytes());
        }
        let (content, checksum) = bytes.split_at_mut(CHECKED);
        checksum.copy_from_slice(&Checksum::of(content).to_le_bytes());
        bytes
    }

    /// Reads the stored form. [`Self::check_model`] tests whether it belongs to a model.
    ///
    /// # Errors
    /// The reason why the data are not a complete, undamaged state of this version.
    pub fn from_bytes(bytes: &[u8]) -> Result<Self, PersistentStateError> {
        let (words, rest) = bytes.as_chunks();
        let word = |bytes: &[u8; 4]| u32::from_le_bytes(*bytes);
        // Another version may have another length, which is checked later.
        if words.first().map(word).is_some_and(|magic| magic != MAGIC) {
            return Err(PersistentStateError::Magic);
        }
        if let Some(version) = words.get(1).map(word).filter(|found| *found != VERSION) {
            return Err(PersistentStateError::Version(version));
        }
        let (Ok(words), []) = (<&[[u8; 4]; WORDS]>::try_from(words), rest) else {
            return Err(PersistentStateError::Length(bytes.len()));
        };
        let &[
            _,
            _,
            fingerprint,
            mass_kg,
            bias_percent,
            bias_variance,
            scale_error,
            scale_variance,
            covariance,
            speed_mps,
            altitude_m,
            gnss_error_m,
            offset,
            offset_variance,
            gain,
            gain_variance,
            noise_sigma,
            ref pitch @ ..,
            checksum,
        ] = words;
        let accelerometer = [offset, offset_variance, gain, gain_variance, noise_sigma];
        let checked = bytes.get(..CHECKED).unwrap_or_default();
        if Checksum::of(checked) != word(&checksum) {
            return Err(PersistentStateError::Checksum);
        }
        let number = f32::from_le_bytes;
        let state = Self {
            fingerprint: word(&fingerprint),
            slow: SlowStates {
                mass_kg: number(mass_kg),
                bias_percent: number(bias_percent),
                bias_variance: number(bias_variance),
                scale_error: number(scale_error),
                scale_variance: number(scale_variance),
                covariance: number(covariance),
            },
            sensors: SensorSigmas {
                speed_mps: number(speed_mps),
                altitude_m: number(altitude_m),
                gnss_error_m: number(gnss_error_m),
            },
            body: BodySensors {
                accelerometer: body_sensor(&accelerometer),
                pitch: body_sensor(pitch),
            },
        };
        if state.is_possible() {
            Ok(state)
        } else {
            Err(PersistentStateError::Value)
        }
    }

    /// Returns whether a drive can leave it. Ranges do not contain NaN.
    #[inline(never)] // Rare, and called from two places.
    fn is_possible(&self) -> bool {
        let Self {
            slow,
            sensors,
            body,
            ..
        } = self;
        let correlation =
            slow.covariance * slow.covariance / (slow.bias_variance * slow.scale_variance);
        possible::MASS.contains(&slow.mass_kg)
            && possible::BIAS.contains(&slow.bias_percent)
            && possible::VARIANCE.contains(&slow.bias_variance)
            && possible::SCALE.contains(&slow.scale_error)
            && possible::VARIANCE.contains(&slow.scale_variance)
            && possible::CORRELATION.contains(&correlation)
            && possible::SIGMA.contains(&sensors.speed_mps)
            && possible::SIGMA.contains(&sensors.altitude_m)
            && possible::SIGMA.contains(&sensors.gnss_error_m)
            && body.accelerometer.as_ref().is_none_or(is_possible_sensor)
            && body.pitch.as_ref().is_none_or(is_possible_sensor)
    }
}

/// Returns whether a drive can leave a sensor.
#[inline(never)] // As above.
fn is_possible_sensor(sensor: &BodySensor) -> bool {
    possible::ERROR.contains(&sensor.offset)
        && possible::VARIANCE.contains(&sensor.offset_variance)
        && possible::ERROR.contains(&sensor.gain)
        && possible::VARIANCE.contains(&sensor.gain_variance)
        && possible::SIGMA.contains(&sensor.noise_sigma)
}

/// Returns the sensor of such words; `None` if all of their bits are zero.
#[inline(never)] // Called twice: flash is scarce.
fn body_sensor(words: &[[u8; 4]; 5]) -> Option<BodySensor> {
    let &[offset, offset_variance, gain, gain_variance, noise_sigma] = words;
    let is_known = words.iter().any(|word| *word != [0; 4]);
    let number = f32::from_le_bytes;
    is_known.then(|| BodySensor {
        offset: number(offset),
        offset_variance: number(offset_variance),
        gain: number(gain),
        gain_variance: number(gain_variance),
        noise_sigma: number(noise_sigma),
    })
}

/// Returns a fingerprint that differs between vehicles and between edits of one: CRC-32 over all
/// parameters in a fixed order, effects with their names.
pub(crate) fn fingerprint(model: &Model) -> u32 {
    let vehicle = &model.vehicle;
    let mut sum = Checksum::NEW;
    let mut add = |number: f32| sum.add(&number.to_le_bytes());
    add(vehicle.mass_kg);
    add(vehicle.drag_area_m2);
    add(vehicle.rolling_resistance);
    add(vehicle.wheel_radius_m);
    add(vehicle.wheel_inertia_kgm2);
    // A measured force adds nothing, a powertrain adds at least one gear.
    if let Traction::Powertrain(powertrain) = &vehicle.traction {
        add(powertrain.engine_inertia_kgm2);
        add(powertrain.reference_torque_nm);
        add(powertrain.final_drive_ratio);
        add(powertrain.final_drive_efficiency);
        for gear in &powertrain.gears {
            add(gear.ratio);
            add(gear.efficiency);
        }
    }
    for adopted in model.effects.iter() {
        let amount = [
            ("amount", adopted.amount),
            ("amount_sigma", adopted.amount_sigma),
        ];
        sum.add(adopted.effect.name.as_bytes());
        for (key, value) in amount.into_iter().chain(adopted.given_parameters()) {
            sum.add(key.as_bytes());
            sum.add(&value.to_le_bytes());
        }
    }
    sum.finish()
}

/// A CRC-32 over bytes in several parts.
///
/// It holds the register alone, not the library's digest: the algorithm is a constant then, and the
/// code for other algorithms falls away.
struct Checksum(u32);

impl Checksum {
    /// Of no bytes.
    const NEW: Self = Self(u32::MAX);

    fn of(bytes: &[u8]) -> u32 {
        let mut sum = Self::NEW;
        sum.add(bytes);
        sum.finish()
    }

    #[inline(never)] // Called from a dozen places.
    fn add(&mut self, bytes: &[u8]) {
        bytes.iter().for_each(|byte| self.add_byte(*byte));
    }

    #[inline(never)] // A loop over bits, of which one copy is enough.
    fn add_byte(&mut self, byte: u8) {
        // The library begins with the register's bits in reverse, and ends with their complement.
        let mut digest = CHECKSUM.digest_with_initial(self.0.reverse_bits());
        digest.update(&[byte]);
        self.0 = !digest.finalize();
    }

    const fn finish(self) -> u32 {
        !self.0
    }
}
