//! How the tuning is declared: a struct for each group, and a table of all parameters.

use crate::time::Duration;
use core::fmt;

/// A parameter of the tuning: what a user reads before changing it.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct TuningParameter {
    /// Group: a table in the tuning file.
    pub group: &'static str,
    /// Key in that table.
    pub key: &'static str,
    /// Default value, as it is written in the source.
    pub default: &'static str,
    /// Smallest possible value.
    pub low: f32,
    /// Largest possible value.
    pub high: f32,
    /// Unit; "1" if it has none.
    pub unit: &'static str,
    /// Meaning.
    pub meaning: &'static str,
    /// Source of the default.
    pub source: &'static str,
}

/// Why a value is not set.
#[derive(Clone, Copy, Debug, PartialEq)]
#[cfg_attr(feature = "defmt", derive(defmt::Format))]
pub enum TuningError {
    /// There is no parameter of this group and key.
    Unknown,
    /// The value is outside the range of the parameter.
    OutOfRange {
        /// Smallest possible value.
        low: f32,
        /// Largest possible value.
        high: f32,
    },
    /// The parameter is a whole number, and the value is not.
    NotWhole,
}

impl fmt::Display for TuningError {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        match self {
            Self::Unknown => f.write_str("unknown key"),
            Self::OutOfRange { low, high } => write!(f, "expected a value from {low} to {high}"),
            Self::NotWhole => f.write_str("expected a whole number"),
        }
    }
}

impl core::error::Error for TuningError {}

/// A type that parameters have.
pub(super) trait ParameterValue: Copy {
    /// Returns the value as a number, in the unit of the tuning file.
    fn to_number(self) -> f64;
    /// Returns the value of a number; `None` if it has to be whole and is not.
    fn from_number(number: f64) -> Option<Self>;
}

impl ParameterValue for f32 {
    fn to_number(self) -> f64 {
        self.into()
    }

    fn from_number(number: f64) -> Option<Self> {
        Some(number as Self)
    }
}

macro_rules! whole_parameter {
    ($($whole:ty),*) => {$(
        impl ParameterValue for $whole {
            fn to_number(self) -> f64 {
                self.into()
            }

            fn from_number(number: f64) -> Option<Self> {
                let whole = number as Self;
                (f64::from(whole) == number).then_some(whole)
            }
        }
    )*};
}

whole_parameter!(u8, u16, u32);

/// In milliseconds.
impl ParameterValue for Duration {
    fn to_number(self) -> f64 {
        self.micros() as f64 * 1e-3
    }

    fn from_number(number: f64) -> Option<Self> {
        u32::from_number(number).map(Self::from_millis)
    }
}

/// Expands to the field type of a kind: a number type, or `ms` for a time in milliseconds.
macro_rules! parameter_type {
    (ms) => {
        Duration
    };
    ($number:ident) => {
        $number
    };
}

/// Expands to the default of a kind.
macro_rules! parameter_default {
    (ms, $default:literal) => {
        Duration::from_millis($default)
    };
    ($number:ident, $default:literal) => {
        $default
    };
}

/// Expands to the key of a field in the tuning file.
macro_rules! parameter_key {
    (ms, $name:ident) => {
        concat!(stringify!($name), "_ms")
    };
    ($number:ident, $name:ident) => {
        stringify!($name)
    };
}

/// Declares groups of parameters, a line each: name, kind, default, range, unit, meaning, source.
macro_rules! tuning {
    ($(
        $(#[$about:meta])*
        $group:ident: $Group:ident {
            $($name:ident: $kind:ident = $default:literal, $low:literal..=$high:literal, $unit:literal, $meaning:literal, $source:literal;)*
        }
    )*) => {
        $(
            $(#[$about])*
            #[derive(Clone, Debug, PartialEq)]
            pub struct $Group {
                $(
                    #[doc = concat!("The ", $meaning, "; ", $unit, ".\n\nDefault ", stringify!($default), ". Source: ", $source, ".")]
                    pub $name: $crate::tuning::parameter::parameter_type!($kind),
                )*
            }

            impl $Group {
                const DEFAULT: Self = Self {
                    $($name: $crate::tuning::parameter::parameter_default!($kind, $default),)*
                };
            }

            impl Default for $Group {
                fn default() -> Self {
                    Self::DEFAULT
                }
            }
        )*

        /// All parameters, by group.
        #[derive(Clone, Debug, PartialEq)]
        pub struct Tuning {
            $(
                $(#[$about])*
                pub $group: $Group,
            )*
        }

        impl Tuning {
            /// The defaults.
            pub const DEFAULT: Self = Self {
                $($group: $Group::DEFAULT,)*
            };

            /// Every parameter, in the order of their declaration.
            pub const PARAMETERS: &'static [TuningParameter] = &[
                $($(
                    TuningParameter {
                        group: stringify!($group),
                        key: $crate::tuning::parameter::parameter_key!($kind, $name),
                        default: stringify!($default),
                        low: $low,
                        high: $high,
                        unit: $unit,
                        meaning: $meaning,
                        source: $source,
                    },
                )*)*
            ];

            /// Returns the value of a parameter, in the unit of the table; `None` if there is no
            /// such parameter.
            #[must_use]
            pub fn get(&self, group: &str, key: &str) -> Option<f64> {
                use $crate::tuning::parameter::ParameterValue as _;
                $($(
                    if group == stringify!($group)
                        && key == $crate::tuning::parameter::parameter_key!($kind, $name)
                    {
                        return Some(self.$group.$name.to_number());
                    }
                )*)*
                None
            }

            /// Sets a parameter to a value in the unit of the table.
            ///
            /// # Errors
            /// [`TuningError`]: the parameter is unknown, or the value is outside its range or not
            /// whole. The parameter is unchanged then.
            pub fn set(&mut self, group: &str, key: &str, value: f64) -> Result<(), TuningError> {
                use $crate::tuning::parameter::ParameterValue as _;
                $($(
                    if group == stringify!($group)
                        && key == $crate::tuning::parameter::parameter_key!($kind, $name)
                    {
                        // In the precision of the parameter: a limit that is read back is within it.
                        let (low, high) = ($low, $high);
                        if !(low..=high).contains(&(value as f32)) {
                            return Err(TuningError::OutOfRange { low, high });
                        }
                        type Type = $crate::tuning::parameter::parameter_type!($kind);
                        self.$group.$name = Type::from_number(value).ok_or(TuningError::NotWhole)?;
                        return Ok(());
                    }
                )*)*
                Err(TuningError::Unknown)
            }
        }

        impl Default for Tuning {
            fn default() -> Self {
                Self::DEFAULT
            }
        }
    };
}

pub(super) use tuning;
pub(crate) use {parameter_default, parameter_key, parameter_type};
