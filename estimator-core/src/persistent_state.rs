//! The persistent state: what one drive leaves for the next, and its form in non-volatile memory.
//!
//! It holds the slow states of the vehicle, the levels of the noises, whether signals report all brakes,
//! and how late signals are. Everything else is found again within seconds. Wind is not kept: it is another one the next day.
//! [`crate::filter::SlowStates`] decides how much of the persistent state the next drive starts with.
//!
//! The stored form has [`PersistentState::LEN`] bytes. Numbers are little endian, `f32` as in
//! IEEE 754:
//!
//! | offset | type | content |
//! |---|---|---|
//! | 0 | 4 bytes | `72 67 6b 1a`: "rgk" and a control byte |
//! | 4 | u32 | version of this table, 5 |
//! | 8 | u32 | fingerprint of the vehicle parameters: CRC-32 over them |
//! | 12 | f32 | mass of the model, kg |
//! | 16 | 2 f32 | bias, %, and its variance |
//! | 24 | 2 f32 | scale less one, and its variance |
//! | 32 | f32 | covariance of the two, % |
//! | 36 | 2 f32 | slip of the driven tyres over traction per weight, and its variance |
//! | 44 | 2 f32 | error of the retarder's factor, and its variance |
//! | 52 | 6 f32 | learned over assumed variance of force, road, slow and fast GNSS error, altitude, speed |
//! | 76 | u32 | 1 if brakes act that no signal reports, else 0 |
//! | 80 | 2 f32 | delay of the receiver and its sigma, s; both 0 if none is estimated |
//! | 88 | 2 f32 | delay of the traction force and its sigma, s; both 0 if none is estimated |
//! | 96 | 2 f32 | time constant of the receiver's low-pass on altitudes and its sigma, s; both 0 if none is estimated |
//! | 104 | u32 | CRC-32 (ISO-HDLC, as in zip and Ethernet) over the bytes before |
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
use crate::delay::{Delay, Delays};
use crate::filter::{ModelMass, SlowState, SlowStates};
use crate::inference::Levels;
use crate::model::Model;
use crate::scalar::Scalar;
use crate::tuning::Prior;
use crate::vehicle::{ParameterError, Traction};
use crc::{CRC_32_ISO_HDLC, Crc, NoTable};

/// First bytes of the stored form.
const MAGIC: u32 = u32::from_le_bytes(*b"rgk\x1a");
/// Version of the layout and of the meaning of its numbers.
const VERSION: u32 = 5;
/// Without a table: the data are short and flash is scarce.
const CHECKSUM: Crc<u32, NoTable> = Crc::<u32, NoTable>::new(&CRC_32_ISO_HDLC);

/// Number of 32-bit words.
const WORDS: usize = PersistentState::LEN / 4;
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
    /// Variances of bias, %², and of the others, 1.
    pub const VARIANCE: RangeInclusive<f32> = 1e-12..=1e4;
    /// Slip over traction per weight, and error of the retarder's factor, 1.
    pub const FACTOR: RangeInclusive<f32> = -9.0..=9.0;
    /// Learned over assumed variance, 1.
    pub const LEVEL: RangeInclusive<f32> = 1e-6..=1e8;
    /// Estimated delay, s, and its sigma.
    pub const DELAY: RangeInclusive<f32> = -1.0..=40.0;
    pub const DELAY_SIGMA: RangeInclusive<f32> = 1e-6..=40.0;
    /// Square of the correlation. Rounding may leave it slightly above one.
    pub const CORRELATION: RangeInclusive<f32> = 0.0..=1.001;
}

/// What one drive leaves for the next.
#[derive(Clone, Copy, Debug, PartialEq)]
#[cfg_attr(feature = "defmt", derive(defmt::Format))]
pub struct PersistentState {
    fingerprint: u32,
    slow: SlowStates,
    levels: Levels,
    hides_brakes: bool,
    delays: Delays,
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
    pub const LEN: usize = 108;

    /// Creates what a drive leaves; `None` if a value could not be read back.
    pub(crate) fn new(
        fingerprint: u32,
        slow: SlowStates,
        levels: Levels,
        hides_brakes: bool,
        delays: Delays,
    ) -> Option<Self> {
        let levels = Levels {
            slope: 1.0,
            ..levels
        };
        let state = Self {
            fingerprint,
            slow,
            levels,
            hides_brakes,
            delays: Delays {
                receiver: kept(delays.receiver),
                traction: kept(delays.traction),
                altitude: kept(delays.altitude),
            },
        };
        state.is_possible().then_some(state)
    }

    /// Returns the slow states of the vehicle.
    #[must_use]
    pub const fn slow_states(&self) -> &SlowStates {
        &self.slow
    }

    /// Returns learned over assumed variances.
    #[must_use]
    pub const fn levels(&self) -> &Levels {
        &self.levels
    }

    /// Returns whether brakes act that no signal reports.
    #[must_use]
    pub const fn hides_brakes(&self) -> bool {
        self.hides_brakes
    }

    /// Returns how late receiver and force were found to be.
    #[must_use]
    pub const fn delays(&self) -> &Delays {
        &self.delays
    }

    /// Returns the gross mass that the drive ended with, kg, as its scale says. The model must be
    /// that of the drive ([`Self::check_model`]). A mass that was reported at the time has no part
    /// in it: the next drive is told it again.
    #[must_use]
    pub fn mass_kg(&self, model: &Model, tuning: &Prior) -> Uncertain {
        let scale = Uncertain {
            value: 1.0 + self.slow.scale.mean,
            sigma: Scalar::sqrt(self.slow.scale.variance),
        };
        ModelMass::parameter(model, tuning, self.slow.mass_kg).gross_kg(scale)
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
            levels,
            hides_brakes,
            delays,
        } = self;
        let bits = f32::to_bits;
        let (receiver_s, receiver_sigma_s) = numbers(delays.receiver);
        let (traction_s, traction_sigma_s) = numbers(delays.traction);
        let (altitude_s, altitude_sigma_s) = numbers(delays.altitude);
        let words: [u32; WORDS - 1] = [
            MAGIC,
            VERSION,
            *fingerprint,
            bits(slow.mass_kg),
            bits(slow.bias.mean),
            bits(slow.bias.variance),
            bits(slow.scale.mean),
            bits(slow.scale.variance),
            bits(slow.covariance),
            bits(slow.tyre_slip.mean),
            bits(slow.tyre_slip.variance),
            bits(slow.retarder.mean),
            bits(slow.retarder.variance),
            bits(levels.force),
            bits(levels.road),
            bits(levels.slow_gnss),
            bits(levels.fast_gnss),
            bits(levels.altitude),
            bits(levels.speed),
            u32::from(*hides_brakes),
            bits(receiver_s),
            bits(receiver_sigma_s),
            bits(traction_s),
            bits(traction_sigma_s),
            bits(altitude_s),
            bits(altitude_sigma_s),
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
        let (checksum, content) = words.split_last().unwrap_or((&[0; 4], &[]));
        let checked = bytes.get(..CHECKED).unwrap_or_default();
        if Checksum::of(checked) != word(checksum) {
            return Err(PersistentStateError::Checksum);
        }
        let &[
            _,
            _,
            fingerprint,
            mass_kg,
            ref numbers @ ..,
            hides_brakes,
            receiver_s,
            receiver_sigma_s,
            traction_s,
            traction_sigma_s,
            altitude_s,
            altitude_sigma_s,
        ] = <&[[u8; 4]; WORDS - 1]>::try_from(content)
            .map_err(|_| PersistentStateError::Length(bytes.len()))?;
        let [
            bias,
            bias_variance,
            scale,
            scale_variance,
            covariance,
            rest @ ..,
        ] = numbers.map(f32::from_le_bytes);
        let [
            slip,
            slip_variance,
            retarder,
            retarder_variance,
            levels @ ..,
        ] = rest;
        let [force, road, slow_gnss, fast_gnss, altitude, speed] = levels;
        let slow_state = |mean, variance| SlowState { mean, variance };
        let state = Self {
            fingerprint: word(&fingerprint),
            slow: SlowStates {
                mass_kg: f32::from_le_bytes(mass_kg),
                bias: slow_state(bias, bias_variance),
                scale: slow_state(scale, scale_variance),
                covariance,
                tyre_slip: slow_state(slip, slip_variance),
                retarder: slow_state(retarder, retarder_variance),
            },
            levels: Levels {
                force,
                road,
                slope: 1.0,
                slow_gnss,
                fast_gnss,
                altitude,
                speed,
            },
            hides_brakes: word(&hides_brakes) != 0,
            delays: Delays {
                receiver: delay(receiver_s, receiver_sigma_s),
                traction: delay(traction_s, traction_sigma_s),
                altitude: delay(altitude_s, altitude_sigma_s),
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
        let Self { slow, levels, .. } = self;
        let correlation =
            slow.covariance * slow.covariance / (slow.bias.variance * slow.scale.variance);
        let variances = [slow.bias, slow.scale, slow.tyre_slip, slow.retarder];
        let factors = [slow.tyre_slip, slow.retarder];
        let levels = [
            levels.force,
            levels.road,
            levels.slow_gnss,
            levels.fast_gnss,
            levels.altitude,
            levels.speed,
        ];
        let delays = [
            self.delays.receiver,
            self.delays.traction,
            self.delays.altitude,
        ];
        possible::MASS.contains(&slow.mass_kg)
            && possible::BIAS.contains(&slow.bias.mean)
            && possible::SCALE.contains(&slow.scale.mean)
            && possible::CORRELATION.contains(&correlation)
            && variances
                .iter()
                .all(|state| possible::VARIANCE.contains(&state.variance))
            && factors
                .iter()
                .all(|state| possible::FACTOR.contains(&state.mean))
            && levels.iter().all(|level| possible::LEVEL.contains(level))
            && delays.iter().all(|delay| is_possible(*delay))
    }
}

/// Returns what is kept of a delay: the next drive looks anew for one that does not fit.
const fn kept(delay: Delay) -> Delay {
    match delay {
        Delay::Invalid => Delay::Unestimated,
        kept => kept,
    }
}

/// Returns a delay as it is stored: itself and its sigma, s.
const fn numbers(delay: Delay) -> (f32, f32) {
    match delay {
        Delay::Estimated { delay_s, sigma_s } => (delay_s, sigma_s),
        Delay::Unestimated | Delay::Invalid => (0.0, 0.0),
    }
}

/// Returns the delay that is stored so.
fn delay(delay_s: [u8; 4], sigma_s: [u8; 4]) -> Delay {
    if delay_s == [0; 4] && sigma_s == [0; 4] {
        return Delay::Unestimated;
    }
    Delay::Estimated {
        delay_s: f32::from_le_bytes(delay_s),
        sigma_s: f32::from_le_bytes(sigma_s),
    }
}

fn is_possible(delay: Delay) -> bool {
    let Delay::Estimated { delay_s, sigma_s } = delay else {
        return true;
    };
    possible::DELAY.contains(&delay_s) && possible::DELAY_SIGMA.contains(&sigma_s)
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
