// Which signals of car.dbc become ours. build.rs includes this file.
//
// Units are those of our columns (`roadgrade columns`), and a `SIGNALS.toml` for the same bus has the
// same numbers.
const CAR: &[own_messages::Mapping] = &[
    mapping("TractionForce", "Powertrain", "WheelForce"),
    mapping("Satellites", "Gps", "Satellites"),
    mapping("Latitude", "Gps", "Latitude"),
    mapping("Longitude", "Gps", "Longitude"),
    mapping("Altitude", "Gps", "Height"),
    own_messages::Mapping {
        invalid: &[3],
        values: &[(2, 1.0)],
        ..mapping("BrakeSwitch", "Wheels", "Braking")
    },
    own_messages::Mapping {
        scale: 1.0 / 3.6,
        invalid: &[0xffff],
        ..mapping("WheelSpeed", "Wheels", "VehicleSpeed")
    },
];

const fn mapping(
    signal: &'static str,
    message: &'static str,
    source: &'static str,
) -> own_messages::Mapping {
    own_messages::Mapping {
        signal,
        message,
        source,
        scale: 1.0,
        offset: 0.0,
        invalid: &[],
        values: &[],
    }
}
