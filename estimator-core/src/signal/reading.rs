//! Readings: signals, and their values with units.

/// The value of a signal, or the reason why there is none.
#[derive(Clone, Copy, Debug, PartialEq)]
#[cfg_attr(feature = "defmt", derive(defmt::Format))]
pub enum Value {
    /// A number in the signal's unit; switches are 0 or 1.
    Real(f32),
    /// An angle in 1e-7 degrees: a position in `f32` would have steps of 0.4 m.
    DegreesE7(i32),
    /// The sender reports "not available".
    NotAvailable,
    /// The sender reports an error, or sends a reserved code.
    Error,
}

impl Value {
    /// Returns the number if there is a finite one.
    #[must_use]
    pub fn real(self) -> Option<f32> {
        match self {
            Self::Real(value) if value.is_finite() => Some(value),
            _ => None,
        }
    }

    /// Returns the angle in 1e-7 degrees if there is one.
    #[must_use]
    pub const fn degrees_e7(self) -> Option<i32> {
        match self {
            Self::DegreesE7(value) => Some(value),
            _ => None,
        }
    }

    /// Returns whether this is a measurement.
    #[must_use]
    pub const fn is_available(self) -> bool {
        match self {
            Self::Real(value) => value.is_finite(),
            Self::DegreesE7(_) => true,
            Self::NotAvailable | Self::Error => false,
        }
    }
}

/// One value of one signal.
#[derive(Clone, Copy, Debug, PartialEq)]
#[cfg_attr(feature = "defmt", derive(defmt::Format))]
pub struct Reading {
    /// The signal.
    pub signal: Signal,
    /// Its value, in the unit of [`Signal::column`].
    pub value: Value,
}

macro_rules! signals {
    ($($(#[$doc:meta])* $variant:ident = $column:literal;)*) => {
        /// A signal of a vehicle or a GNSS receiver.
        ///
        /// Readings of the same time are to be given to the estimator in this order: the torque
        /// fraction before the torque, the quality of a fix before its altitude, forces and gears
        /// before the speed that closes an interval.
        #[derive(Clone, Copy, Debug, PartialEq, Eq, PartialOrd, Ord, Hash)]
        #[cfg_attr(feature = "defmt", derive(defmt::Format))]
        pub enum Signal {
            $($(#[$doc])* $variant,)*
        }

        impl Signal {
            /// Every signal, in order.
            pub const ALL: &'static [Self] = &[$(Self::$variant,)*];

            /// Returns its name with unit, which is its column in a signal table.
            #[must_use]
            pub const fn column(self) -> &'static str {
                match self {
                    $(Self::$variant => $column,)*
                }
            }
        }
    };
}

signals! {
    /// Torque that 100 % of the engine torque stands for (SPN 544).
    EngineReferenceTorque = "reference_torque_nm";
    /// Moment of inertia of the engine (SPN 1794).
    EngineInertia = "engine_inertia_kgm2";
    /// Torque that 100 % of the retarder torque stands for (SPN 556).
    RetarderReferenceTorque = "retarder_reference_torque_nm";
    /// Grade of the road by the map of a predictive cruise control (SPN 7432).
    RoadwayGrade = "roadway_grade_percent";
    /// Control mode that sets the engine torque (SPN 899).
    EngineTorqueMode = "engine_torque_mode";
    /// Fraction to add to the engine torque (SPN 4154).
    EngineTorqueFraction = "engine_torque_fraction_percent";
    /// Engine's nominal friction torque (SPN 514).
    FrictionTorque = "friction_torque_percent";
    /// Torque that auxiliaries take (SPN 2978).
    ParasiticTorque = "parasitic_torque_percent";
    /// Engine speed (SPN 190).
    EngineSpeed = "engine_speed_rpm";
    /// Speed of an electric motor in the engine's place; negative in reverse.
    MotorSpeed = "motor_speed_rpm";
    /// Whether the driveline is engaged (SPN 560).
    DrivelineEngaged = "driveline_engaged";
    /// Whether a gear shift is in process (SPN 574).
    ShiftInProcess = "shifting";
    /// Clutch slip (SPN 522).
    ClutchSlip = "clutch_slip_percent";
    /// Whether the clutch pedal is pressed (SPN 598).
    ClutchSwitch = "clutch_switch";
    /// Speed of the gearbox's output shaft (SPN 191).
    OutputShaftSpeed = "output_shaft_rpm";
    /// Gear to be engaged (SPN 524).
    SelectedGear = "selected_gear";
    /// Ratio of the current gear (SPN 526).
    GearRatio = "gear_ratio";
    /// Gear engaged, 0 is neutral, negative is reverse (SPN 523).
    CurrentGear = "gear";
    /// Whether the service brake is used (SPN 597).
    BrakeSwitch = "brake";
    /// Whether the brake light is on, which the driver's braking switches.
    BrakeLight = "brake_light";
    /// Whether the foundation brakes are used, by the pedal or not (SPN 2919).
    FoundationBrake = "foundation_brake";
    /// Brake pedal position (SPN 521).
    BrakePedal = "brake_pedal_percent";
    /// Service brake pressure.
    BrakePressure = "brake_pressure_pa";
    /// Whether the parking brake is set (SPN 70).
    ParkingBrake = "parking_brake";
    /// Retarder torque, negative when it brakes (SPN 520).
    RetarderTorque = "retarder_torque_percent";
    /// Force of the retarder at the wheels. Its sign does not count: it brakes.
    RetarderForce = "retarder_force_n";
    /// Gross combination mass (SPN 1760).
    Mass = "mass_kg";
    /// Passengers on board.
    Passengers = "passengers";
    /// Fan drive (SPN 975).
    Fan = "fan_percent";
    /// Outside temperature (SPN 171).
    AmbientTemperature = "ambient_celsius";
    /// Barometric pressure (SPN 108).
    AirPressure = "air_pressure_pa";
    /// Yaw rate, positive to the left (SPN 1808).
    YawRate = "yaw_rate_radps";
    /// Longitudinal acceleration of an accelerometer, positive forwards: motion and gravity (SPN 5348).
    LongitudinalAcceleration = "longitudinal_acceleration_mps2";
    /// Pitch of the body against the horizon, positive nose up (SPN 4976).
    Pitch = "pitch_deg";
    /// Rate of the pitch, positive nose up (SPN 4983).
    PitchRate = "pitch_rate_radps";
    /// Net torque of the engine's shaft, instead of a part of the reference torque.
    NetEngineTorque = "engine_torque_nm";
    /// Torque of an electric motor in the engine's place, negative where it brakes.
    MotorTorque = "motor_torque_nm";
    /// Indicated engine torque, part of the reference torque (SPN 513).
    EngineTorque = "engine_torque_percent";
    /// Measured traction force, instead of an engine torque.
    TractionForce = "traction_force_n";
    /// Method of a GNSS fix: 0 none, 1 GNSS, 2 DGNSS, 4 and 5 RTK, 6 dead reckoning.
    FixMethod = "gnss_method";
    /// Satellites used in a fix.
    Satellites = "satellites";
    /// Horizontal dilution of precision.
    Hdop = "hdop";
    /// Vertical dilution of precision.
    Vdop = "vdop";
    /// Course over ground, clockwise from north.
    Course = "course_deg";
    /// Speed over ground.
    GnssSpeed = "gnss_speed_mps";
    /// Vertical speed by a GNSS receiver, positive upwards.
    VerticalSpeed = "vertical_speed_mps";
    /// Latitude of a fix.
    Latitude = "latitude_deg";
    /// Longitude of a fix; completes a position.
    Longitude = "longitude_deg";
    /// Altitude of a fix; completes it.
    Altitude = "altitude_m";
    /// Speed by the tachograph (SPN 1624).
    TachographSpeed = "tachograph_speed_mps";
    /// Speed of the front axle (SPN 904).
    FrontAxleSpeed = "front_axle_speed_mps";
    /// Wheel-based vehicle speed (SPN 84).
    WheelSpeed = "wheel_speed_mps";
}

impl Signal {
    /// Returns the signal of a column of a signal table.
    #[must_use]
    pub fn from_column(column: &str) -> Option<Self> {
        Self::ALL.iter().copied().find(|s| s.column() == column)
    }
}
