//! Where the estimator falls short of withstanding a fault, and why.

/// What is not met.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct Short {
    /// Sigmas are too small.
    pub dishonest: bool,
    /// It is not got over within 2 km.
    pub lasting: bool,
    /// Nothing counts it.
    pub unseen: bool,
    /// The way is longer or shorter.
    pub displaced: bool,
    /// Why.
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
const UNSEEN: Short = Short {
    unseen: true,
    ..MET
};
const DISPLACED: Short = Short {
    displaced: true,
    ..MET
};

const BRIDGED: &str = "Not detected: gaps of less than 2.5 s are bridged by what was before and \
    after.";
const NOISE_OF_TORQUE: &str =
    "Not detected: torques come a hundred times a second and average out.";
const NO_WAY: &str = "The way in a long gap is its time times the mean of the speeds before and \
    after; its cells are missing, not made up.";
const STUCK_SPEED: &str = "Detected only when the engine has come away by 0.5 % from the speed that is \
    reported: until then, for some seconds, a speed that does not change is read as a slope. After that \
    the front axle's speed stands in, or there is none, and cells are missing.";
const STUCK_TORQUE: &str = "Not detected for what it is: full load and overrun are constant torques, \
    too, and the road may rise by what the torque lacks. GNSS, which tells otherwise, is taken to \
    drift for up to 2.5 km, and what was learned of the model meanwhile is unlearned slowly.";
const WRONG_RADIUS: &str = "A step of the speed is counted where it comes while driving. Speeds that \
    are wrong from the start are those of another wheel radius, as worn tyres have: the way is wrong \
    by as much, the grade by 3 % of itself. `diagnose` finds that over several drives.";
const SLOW_DRIFT: &str = "Not detected for what it is: 2 m per km for some minutes is what a \
    receiver's slow error does anyway, and what a slow error of the model looks like. The error is \
    bounded by the drift's own slope, 0.2 %.";
const A_LEAP: &str = "A clock that leaps ahead is told like a silent bus: the way is that of the time \
    that seems to have passed. Stamp frames by a clock that nobody sets.";
const STANDS_IN: &str = "Not defended: who speaks alone for more than 5 s is believed, as a second \
    controller should be. It is counted, and ends when the true sender is back.";
const ONE_ADDRESS: &str = "Not defended: two that use one address cannot be told apart on a bus \
    without authentication. It is counted.";

/// By the fault's name.
const ALL: &[(&str, Short, &str)] = &[
    ("silence of 1 s", UNSEEN, BRIDGED),
    ("silence of 60 s", DISPLACED, NO_WAY),
    ("both speeds: error for 120 s", DISPLACED, NO_WAY),
    ("all signals: error for 120 s", DISPLACED, NO_WAY),
    ("wheel speed stuck", DISHONEST, STUCK_SPEED),
    (
        "both speeds stuck",
        Short {
            displaced: true,
            ..DISHONEST
        },
        STUCK_SPEED,
    ),
    (
        "torque stuck",
        Short {
            lasting: true,
            ..DISHONEST
        },
        STUCK_TORQUE,
    ),
    (
        "one torque in 20 off by up to 50 %",
        UNSEEN,
        NOISE_OF_TORQUE,
    ),
    ("speed 3 % high for 120 s", DISPLACED, WRONG_RADIUS),
    ("speed 3 % high for ever", DISPLACED, WRONG_RADIUS),
    ("drifts up by 10 m in 5 km", DISHONEST, SLOW_DRIFT),
    ("leaps ahead by 60 s", DISPLACED, A_LEAP),
    ("leaps ahead by 1 h", DISPLACED, A_LEAP),
    (
        "speaks while the true senders pause for 15 s",
        Short {
            displaced: true,
            ..DISHONEST
        },
        STANDS_IN,
    ),
    ("repeats from the true addresses", DISHONEST, ONE_ADDRESS),
    (
        "the same, five times as fast, true addresses",
        DISHONEST,
        ONE_ADDRESS,
    ),
];

impl Short {
    /// What is not met of the fault of this name.
    pub(super) fn of(name: &str) -> Self {
        let found = ALL.iter().find(|(known, ..)| *known == name);
        found.map_or(MET, |&(_, short, reason)| Self {
            reason: Some(reason),
            ..short
        })
    }
}
