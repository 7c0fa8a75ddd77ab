//! What a drive leaves of the sensors that are fixed to the body and feel the slope.
//!
//! A mounting angle outlasts a drive, and so do the springs of the body. What is learned of a sensor
//! is relative to the slow error of the force model, which is another one on the next day. So a drive
//! leaves the offset of the sensor itself, o = c + u (b + w) with the sensor's unit u of a slope of
//! 1 %, and the next drive takes its own b + w from it. The variances add up: what bias and wind have
//! in common with the offset is not kept.

/// A sensor on the body: an accelerometer (unit m/s²), or a pitch sensor (unit % of slope).
#[derive(Clone, Copy, Debug, PartialEq)]
#[cfg_attr(feature = "defmt", derive(defmt::Format))]
pub struct BodySensor {
    /// Reading at rest on a level road, in the sensor's unit.
    pub offset: f32,
    /// Its variance.
    pub offset_variance: f32,
    /// What the reading gains with the specific force because the body pitches under it: as a part of
    /// that force (accelerometer), or in % for 1 m/s² (pitch).
    pub gain: f32,
    /// Its variance.
    pub gain_variance: f32,
    /// Noise of one reading, 1 sigma, in the sensor's unit.
    pub noise_sigma: f32,
}

/// What a drive knows of them; `None` of one that it lacks or does not trust.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
#[cfg_attr(feature = "defmt", derive(defmt::Format))]
pub struct BodySensors {
    /// The accelerometer along the vehicle.
    pub accelerometer: Option<BodySensor>,
    /// The pitch sensor.
    pub pitch: Option<BodySensor>,
}

impl BodySensor {
    /// Returns it with the offset moved by a value with a variance, both in the sensor's unit.
    pub(super) fn moved(self, value: f32, variance: f32) -> Self {
        Self {
            offset: self.offset + value,
            offset_variance: self.offset_variance + variance,
            ..self
        }
    }
}

/// What the offset of a sensor is counted from.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(super) enum OffsetOrigin {
    /// The slow error of this drive's model: learned beside it.
    Model,
    /// A level road: left by an earlier drive.
    LevelRoad,
}

impl OffsetOrigin {
    /// Returns what a drive leaves of a sensor. `model_error` is the slow error of its model with its
    /// variance, in the sensor's unit.
    pub(super) fn kept(self, learned: BodySensor, model_error: (f32, f32)) -> BodySensor {
        let (error, variance) = model_error;
        match self {
            Self::Model => learned.moved(error, variance),
            Self::LevelRoad => learned,
        }
    }
}
