//! What is kept from one drive to the next, and its form in an ECU's non-volatile memory.
//!
//! Kept are the slow states with how sure they are, and how noisy the sensors were; the rest is
//! found anew within seconds. Wind is not kept: it is another one the next day. How much is
//! believed of them where the next drive begins is told in [`crate::filter::prior`].
//!
//! The blob has [`Kept::LEN`] bytes, numbers little endian, `f32` as in IEEE 754:
//!
//! | offset | type | content |
//! |---|---|---|
//! | 0 | 4 bytes | `72 67 6b 1a`: "rgk" and a byte that no text has |
//! | 4 | u32 | version of this table, 1 |
//! | 8 | u32 | fingerprint of the vehicle parameters: CRC-32 over them |
//! | 12 | f32 | mass that the model took, kg |
//! | 16 | f32 | bias, % |
//! | 20 | f32 | its variance, %² |
//! | 24 | f32 | scale less one |
//! | 28 | f32 | its variance |
//! | 32 | f32 | covariance of the two, % |
//! | 36 | f32 | white noise of a wheel speed, 1 sigma, m/s |
//! | 40 | f32 | white noise of a GNSS altitude, 1 sigma, m |
//! | 44 | f32 | slow error of GNSS altitude, 1 sigma, m |
//! | 48 | u32 | CRC-32 (ISO-HDLC: that of zip and Ethernet) over the bytes before |
//!
//! On an ECU: write the bytes when the ignition goes off, into the older of two slots, so that a
//! write that is cut short leaves the other; when it comes on, read both and begin with what passes.
//!
//! ```
//! # use estimator_core::{Estimator, Kept, KeptError, Traction, Tuning, VehicleParameters};
//! # let vehicle = VehicleParameters {
//! #     mass_kg: 19_000.0,
//! #     drag_area_m2: 5.2,
//! #     rolling_resistance: 0.008,
//! #     wheel_radius_m: 0.48,
//! #     wheel_inertia_kgm2: 60.0,
//! #     traction: Traction::Force,
//! #     effects: Default::default(),
//! # };
//! # let slot = [0xff; Kept::LEN];
//! # let mut written = None;
//! let begun = Kept::from_bytes(&slot)
//!     .and_then(|kept| Estimator::<f32>::with_kept(vehicle.clone(), Tuning::default(), &kept));
//! let estimator = match begun {
//!     Ok(estimator) => estimator,
//!     Err(_) => Estimator::new(vehicle, Tuning::default())?, // nothing there, or not to be used
//! };
//! // ... a drive later:
//! if let Some(kept) = estimator.kept() {
//!     written = Some(kept.to_bytes());
//! }
//! # assert!(written.is_none());
//! # Ok::<(), estimator_core::ParameterError>(())
//! ```

use crate::filter::{SensorNoise, SlowStates};
use crate::scalar::Scalar;
use crate::tuning::Tuning;
use crate::vehicle::{ParameterError, Traction, VehicleParameters};
use crc::{CRC_32_ISO_HDLC, Crc, Digest, NoTable};

/// First bytes of a blob.
const MAGIC: u32 = u32::from_le_bytes(*b"rgk\x1a");
/// Version of the layout and of what its numbers mean.
const VERSION: u32 = 1;
/// Without a table: a blob is short and flash is dear.
const CHECKSUM: Crc<u32, NoTable> = Crc::<u32, NoTable>::new(&CRC_32_ISO_HDLC);

/// Bytes that the checksum covers.
const CHECKED: usize = Kept::LEN - 4;

/// What no drive leaves is beyond these, though a checksum be right.
mod possible {
    use core::ops::RangeInclusive;
    /// kg.
    pub const MASS: RangeInclusive<f32> = 100.0..=1e6;
    /// %.
    pub const BIAS: RangeInclusive<f32> = -50.0..=50.0;
    /// Less one.
    pub const SCALE: RangeInclusive<f32> = -0.9..=9.0;
    /// Of bias, % squared, and of scale: neither more nor less sure than numbers can tell.
    pub const VARIANCE: RangeInclusive<f32> = 1e-12..=1e4;
    /// Of the sensors, m/s or m.
    pub const SIGMA: RangeInclusive<f32> = 1e-6..=1e4;
    /// Square of the correlation; rounding may leave it a little above one.
    pub const CORRELATION: RangeInclusive<f32> = 0.0..=1.001;
}

/// What one drive leaves for the next.
#[derive(Clone, Copy, Debug, PartialEq)]
#[cfg_attr(feature = "defmt", derive(defmt::Format))]
pub struct Kept {
    fingerprint: u32,
    slow: SlowStates,
    sensors: SensorSigmas,
}

/// Noise as 1 sigma in units: a tuning may change from one release to the next.
#[derive(Clone, Copy, Debug, PartialEq)]
#[cfg_attr(feature = "defmt", derive(defmt::Format))]
struct SensorSigmas {
    speed_mps: f32,
    altitude_m: f32,
    gnss_error_m: f32,
}

/// Why a blob is not used.
#[derive(Clone, Copy, Debug, PartialEq)]
#[cfg_attr(feature = "defmt", derive(defmt::Format))]
pub enum KeptError {
    /// It has this many bytes, not [`Kept::LEN`].
    Length(usize),
    /// It does not begin as a blob does: something else, or never written.
    Magic,
    /// Another release wrote it, with this version of the layout.
    Version(u32),
    /// It was damaged.
    Checksum,
    /// It holds a number that no drive can have left.
    Value,
    /// It was learned on another vehicle, or with other parameters.
    Vehicle,
    /// The vehicle it is for has a parameter that no vehicle can have.
    Parameter(ParameterError),
}

impl core::fmt::Display for KeptError {
    fn fmt(&self, f: &mut core::fmt::Formatter<'_>) -> core::fmt::Result {
        match self {
            Self::Length(length) => write!(f, "{length} bytes: expected {}", Kept::LEN),
            Self::Magic => f.write_str("not what a drive keeps for the next one"),
            Self::Version(version) => write!(f, "version {version}: expected {VERSION}"),
            Self::Checksum => f.write_str("damaged: the checksum is not that of its content"),
            Self::Value => f.write_str("holds a number that no drive can have left"),
            Self::Vehicle => f.write_str("learned on another vehicle, or with other parameters"),
            Self::Parameter(error) => error.fmt(f),
        }
    }
}

impl core::error::Error for KeptError {}

impl From<ParameterError> for KeptError {
    fn from(error: ParameterError) -> Self {
        Self::Parameter(error)
    }
}

impl Kept {
    /// Length of the blob, bytes.
    pub const LEN: usize = 52;

    /// What a drive leaves; `None` if one of its numbers is none that could be read back.
    pub(crate) fn new(
        vehicle: &VehicleParameters,
        tuning: &Tuning,
        slow: SlowStates,
        noise: &SensorNoise,
    ) -> Option<Self> {
        let learned = |ratio: f32, sigma: f32| Scalar::sqrt(ratio) * sigma;
        let kept = Self {
            fingerprint: fingerprint(vehicle),
            slow,
            sensors: SensorSigmas {
                speed_mps: learned(noise.speed, tuning.speed_sigma_mps),
                altitude_m: learned(noise.altitude, tuning.altitude_sigma_m),
                gnss_error_m: learned(noise.gnss_error, tuning.gnss_error_sigma_m),
            },
        };
        kept.is_possible().then_some(kept)
    }

    /// What is known of the vehicle.
    #[must_use]
    pub const fn slow_states(&self) -> &SlowStates {
        &self.slow
    }

    /// How noisy the sensors were, by what this tuning believes.
    #[must_use]
    pub fn noise(&self, tuning: &Tuning) -> SensorNoise {
        let ratio = |learned: f32, believed: f32| (learned / believed) * (learned / believed);
        SensorNoise {
            speed: ratio(self.sensors.speed_mps, tuning.speed_sigma_mps),
            altitude: ratio(self.sensors.altitude_m, tuning.altitude_sigma_m),
            gnss_error: ratio(self.sensors.gnss_error_m, tuning.gnss_error_sigma_m),
        }
    }

    /// Whether it was learned with these parameters.
    ///
    /// # Errors
    /// [`KeptError::Vehicle`] if not.
    pub fn check_vehicle(&self, vehicle: &VehicleParameters) -> Result<(), KeptError> {
        if self.fingerprint == fingerprint(vehicle) {
            Ok(())
        } else {
            Err(KeptError::Vehicle)
        }
    }

    /// As a blob.
    #[must_use]
    pub fn to_bytes(&self) -> [u8; Self::LEN] {
        let SlowStates {
            mass_kg,
            bias_percent,
            bias_variance,
            scale_error,
            scale_variance,
            covariance,
        } = self.slow;
        let SensorSigmas {
            speed_mps,
            altitude_m,
            gnss_error_m,
        } = self.sensors;
        let numbers = [
            mass_kg,
            bias_percent,
            bias_variance,
            scale_error,
            scale_variance,
            covariance,
            speed_mps,
            altitude_m,
            gnss_error_m,
        ];
        let words = [MAGIC, VERSION, self.fingerprint]
            .into_iter()
            .chain(numbers.map(f32::to_bits));
        let mut bytes = [0; Self::LEN];
        for (place, word) in bytes.chunks_exact_mut(4).zip(words) {
            place.copy_from_slice(&word.to_le_bytes());
        }
        let (content, checksum) = bytes.split_at_mut(CHECKED);
        checksum.copy_from_slice(&CHECKSUM.checksum(content).to_le_bytes());
        bytes
    }

    /// From a blob. Of which vehicle it is shows where it is used: [`Self::check_vehicle`].
    ///
    /// # Errors
    /// Anything but a whole, undamaged blob of this version, by kind.
    pub fn from_bytes(bytes: &[u8]) -> Result<Self, KeptError> {
        let (words, rest) = bytes.as_chunks();
        let word = |bytes: &[u8; 4]| u32::from_le_bytes(*bytes);
        // Another version may have another length: that comes after.
        if words.first().map(word).is_some_and(|magic| magic != MAGIC) {
            return Err(KeptError::Magic);
        }
        if let Some(version) = words.get(1).map(word).filter(|found| *found != VERSION) {
            return Err(KeptError::Version(version));
        }
        let (
            &[
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
                checksum,
            ],
            [],
        ) = (words, rest)
        else {
            return Err(KeptError::Length(bytes.len()));
        };
        let checked = bytes.get(..CHECKED).unwrap_or_default();
        if CHECKSUM.checksum(checked) != word(&checksum) {
            return Err(KeptError::Checksum);
        }
        let number = f32::from_le_bytes;
        let kept = Self {
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
        };
        if kept.is_possible() {
            Ok(kept)
        } else {
            Err(KeptError::Value)
        }
    }

    /// Whether a drive can have left it: ranges refuse what is no number, too.
    fn is_possible(&self) -> bool {
        let Self { slow, sensors, .. } = self;
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
    }
}

/// Tells vehicles, and edits of one, apart: CRC-32 over all parameters in a fixed order, effects
/// with their names.
fn fingerprint(vehicle: &VehicleParameters) -> u32 {
    let mut digest = CHECKSUM.digest();
    let mut add = |number: f32| add_bytes(&mut digest, &number.to_le_bytes());
    add(vehicle.mass_kg);
    add(vehicle.drag_area_m2);
    add(vehicle.rolling_resistance);
    add(vehicle.wheel_radius_m);
    add(vehicle.wheel_inertia_kgm2);
    // A measured force adds nothing, a powertrain at least one gear.
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
    for adopted in vehicle.effects.iter() {
        let amount = [
            ("amount", adopted.amount),
            ("amount_sigma", adopted.amount_sigma),
        ];
        add_bytes(&mut digest, adopted.effect.name.as_bytes());
        for (key, value) in amount.into_iter().chain(adopted.given()) {
            add_bytes(&mut digest, key.as_bytes());
            add_bytes(&mut digest, &value.to_le_bytes());
        }
    }
    digest.finalize()
}

/// Not inlined: a checksum without a table is a loop over bits, of which one is enough.
#[inline(never)]
fn add_bytes(digest: &mut Digest<'_, u32, NoTable>, bytes: &[u8]) {
    digest.update(bytes);
}
