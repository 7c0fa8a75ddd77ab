//! Requirements that the estimator does not meet under a fault, with the reason.

/// The requirements that are not met.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct Short {
    /// The sigmas are too small.
    pub dishonest: bool,
    /// The error persists for more than 2 km after the fault.
    pub lasting: bool,
    /// No counter detects it.
    pub unseen: bool,
    /// The distance is wrong.
    pub displaced: bool,
    /// The reason.
    pub reason: Option<&'static str>,
}

const MET: Short = Short {
    dishonest: false,
    lasting: false,
    unseen: false,
    displaced: false,
    reason: None,
};
const DISHONEST: Short = Short {
    dishonest: true,
    ..MET
};
const LASTING: Short = Short {
    lasting: true,
    ..MET
};
const UNSEEN: Short = Short {
    unseen: true,
    ..MET
};
const DISPLACED: Short = Short {
    displaced: true,
    ..MET
};

const BRIDGED: &str = "Not detected: gaps shorter than 2.5 s are bridged by interpolation.";
const NOISE_OF_TORQUE: &str =
    "Not detected: torque is received a hundred times per second, and the errors average out.";
const NO_DISTANCE: &str = "The distance of a long gap is its duration times the mean of the speeds \
    before and after it. Its cells are missing.";
const STUCK_SPEED: &str = "Detected only when the engine speed differs by 0.5 % from the reported wheel \
    speed. Until then, for some seconds, a constant speed is read as a slope; those cells are marked. After \
    that the front axle speed is used. Without it cells are missing.";
const STUCK_TORQUE: &str = "Detected where altitudes leave the climb of the forces while the torque does \
    not change, after some hundred metres: full load and overrun are constant torques too. Until then the live \
    grade is wrong. The lagged cells up to there are marked, and the smoothed ones are without the torque.";
const WRONG_RADIUS: &str = "A step of the speed is counted if it occurs while driving. A speed that is \
    wrong from the start equals that of another wheel radius, such as worn tyres: the distance is wrong \
    by the same ratio, the grade by 3 % of itself. `diagnose` finds the error over several drives.";
const SLOW_DRIFT: &str = "Not detected: 2 m per km for some minutes is usual for the slow error of a \
    receiver, and has the same symptoms as a slow error of the model. The error is bounded by the slope of \
    the drift, 0.2 %.";
const CLOCK_JUMP: &str = "A clock that jumps ahead cannot be distinguished from a silent bus: the distance \
    is that of the apparent time. After an hour the estimate starts anew, and is for some kilometres less \
    accurate. Use a clock for time stamps that is never set.";
const FAST_DRIFT: &str = "Detected, and a part of its cells is marked, but the error stays larger on the rest of \
    the drive.";
const ONLY_SENDER: &str = "Not defended: the only sender for more than 5 s is accepted, as a redundant \
    controller must be. The switch is counted, and ends when the true sender is back. Until then the cells are \
    marked: no controller but the engine's measures its torque.";
const ONE_ADDRESS: &str = "Not defended: two senders with one source address cannot be distinguished on a \
    bus without authentication. The rate is counted, and the cells are marked. Speeds that go back and forth \
    are not used; cells are then missing.";

/// Shortfalls by the fault's name.
const ALL: &[(&str, Short, &str)] = &[
    ("silence of 1 s", UNSEEN, BRIDGED),
    ("silence of 60 s", DISPLACED, NO_DISTANCE),
    ("both speeds: error for 120 s", DISPLACED, NO_DISTANCE),
    ("all signals: error for 120 s", DISPLACED, NO_DISTANCE),
    ("wheel speed stuck", MET, STUCK_SPEED),
    (
        "both speeds stuck",
        Short {
            displaced: true,
            ..MET
        },
        STUCK_SPEED,
    ),
    ("torque stuck", MET, STUCK_TORQUE),
    (
        "one torque in 20 wrong by up to 50 %",
        UNSEEN,
        NOISE_OF_TORQUE,
    ),
    ("speed 3 % high for 120 s", DISPLACED, WRONG_RADIUS),
    ("speed 3 % high from the start", DISPLACED, WRONG_RADIUS),
    ("drifts down by 10 m in 1 km", LASTING, FAST_DRIFT),
    ("drifts up by 10 m in 5 km", DISHONEST, SLOW_DRIFT),
    ("jumps ahead by 60 s", DISPLACED, CLOCK_JUMP),
    ("jumps ahead by 1 h", DISPLACED, CLOCK_JUMP),
    (
        "sends while the true senders pause for 15 s",
        Short {
            displaced: true,
            ..MET
        },
        ONLY_SENDER,
    ),
    (
        "replay from the true source addresses",
        DISPLACED,
        ONE_ADDRESS,
    ),
    (
        "replay from the true source addresses, five times as fast",
        DISPLACED,
        ONE_ADDRESS,
    ),
];

impl Short {
    /// Returns the shortfalls under the fault of this name.
    pub(super) fn of(name: &str) -> Self {
        let found = ALL.iter().find(|(known, ..)| *known == name);
        found.map_or(MET, |&(_, short, reason)| Self {
            reason: Some(reason),
            ..short
        })
    }
}
