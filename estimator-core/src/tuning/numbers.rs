//! Every number of filter and inference: default, unit, meaning, and where it comes from.

macro_rules! numbers {
    ($($name:ident = $default:literal, $unit:literal, $meaning:literal, $source:literal;)*) => {
        /// Every number of filter and inference.
        #[derive(Clone, Debug, PartialEq)]
        pub struct Numbers {
            $(
                #[doc = concat!("The ", $meaning, "; ", $unit, ".\n\nDefault ", stringify!($default), ". Source: ", $source, ".")]
                pub $name: f32,
            )*
        }

        impl Default for Numbers {
            fn default() -> Self {
                Self { $($name: $default,)* }
            }
        }

        impl Numbers {
            /// Names of the numbers.
            pub const NAMES: &'static [&'static str] = &[$(stringify!($name),)*];

            /// Returns a number by its name; `None` if there is none.
            pub fn by_name(&mut self, name: &str) -> Option<&mut f32> {
                match name {
                    $(stringify!($name) => Some(&mut self.$name),)*
                    _ => None,
                }
            }
        }
    };
}

numbers! {
    speed_noise_mps = 0.013, "m/s", "white noise of one wheel-speed reading, 1 sigma", "thesis tables 2 and 3: width of the pointwise grade errors gives 0.009 to 0.013";
    crawl_speed_noise_mps = 0.1, "m/s", "same of a crawling vehicle, where pulses of a wheel sensor are few", "one pulse of a 100-tooth wheel a reading";
    altitude_noise_m = 0.3, "m", "white noise of one GNSS altitude at a dilution of precision of 1, 1 sigma", "single-frequency receivers: 0.3 to 1 m from fix to fix";
    slow_gnss_noise_m = 3.0, "m", "slow error of GNSS altitude, 1 sigma", "Ornstein-Uhlenbeck model, Sensors 20:6050";
    slow_gnss_time_s = 200.0, "s", "correlation time of the slow error", "same source: 100 to 300 s";
    fast_gnss_noise_m = 0.5, "m", "fast error of GNSS altitude, 1 sigma", "receivers on judged drives: 0.1 to 1 m within ten seconds";
    fast_gnss_time_s = 6.0, "s", "correlation time of the fast error", "same drives; 4 to 10 s change no error by more than 1 %";
    switched_gnss_noise_m = 30.0, "m", "step of the altitude where another receiver takes over, 1 sigma", "datums differ by the height of the geoid, up to 50 m in Europe";
    live_gate = 25.0, "1", "squared innovation over its variance beyond which the live filter leaves an altitude out", "five sigmas; the window weighs altitudes instead";

    slope_rate_noise = 0.006, "%/m", "change of slope along the road, 1 sigma", "AASHTO: a crest for 110 km/h (K = 74) has 0.014";
    slope_rate_length_m = 150.0, "m", "correlation length of the change of slope", "length of a vertical curve";
    invalid_road = 16.0, "1", "factor on the road's variance where shifts and brakes hide the force", "drivers shift and brake where roads bend: city and regional drives of other simulators";

    force_noise_n = 120.0, "N", "white noise of the force over one cell, 1 sigma", "pointwise grades of the thesis; its level is learned";
    inertia_noise = 0.6, "1", "error of the torque that turns engine and wheels, as a fraction of it, 1 sigma", "launches of city drives; engine inertia is a figure of a data sheet";
    jump_noise = 0.5, "1", "error of a change of traction at a launch, as a fraction of it, 1 sigma", "rotating mass and timing";
    invalid_noise_percent = 30.0, "%", "noise of the force where it is not known, as a slope, 1 sigma", "thesis section 3: variance up by orders of magnitude";
    bias_force_n = 250.0, "N", "slow force error that does not grow with mass, 1 sigma", "VECTO long haul: 5 kW at 80 km/h are 225 N";
    bias_rolling = 0.15, "1", "slow error as a fraction of rolling resistance, 1 sigma", "wet road 0.1 to 0.2; a wrong parameter 0.1";
    bias_drag = 0.1, "1", "slow error as a fraction of air resistance, 1 sigma", "trailers and bodies differ by 10 %";
    bias_length_m = 100000.0, "m", "correlation length of the slow error", "a drive";
    wind_noise_mps = 0.8, "m/s", "wind along the road that changes within kilometres, 1 sigma", "between gusts of 2 m/s and calm air; the likelihood is flat there";
    wind_length_m = 1000.0, "m", "correlation length of the changing wind", "500 to 3000 m change the errors of judged drives by less than 2 %";
    traction_noise = 0.02, "1", "error of the traction that changes within kilometres, as a fraction of it, 1 sigma", "actual engine torque (SPN 513) is known to some per cent";
    scale_walk_per_sqrt_km = 0.002, "1/√km", "random walk of the scale", "fuel burnt, torque map";
    overrun_percent = 0.04, "%", "traction over weight below which the engine drives nothing", "1 % of the torque of a loaded truck in its top gear";

    launch_stop_s = 3.0, "s", "duration of a cell from which on it holds a stop", "a cell at 1 m/s takes 2.5 s";
    launch_length_m = 1000.0, "m", "distance behind a stop within which a vehicle launches", "a loaded truck reaches 80 km/h within a kilometre";
    launch_mps2 = 0.2, "m/s²", "acceleration from which on it launches", "cruise controls answer roads with less";
    prior_slope_percent = 3.0, "%", "slope where a drive begins, 1 sigma", "trunk roads";
    prior_altitude_m = 100.0, "m", "altitude before the first fix, 1 sigma", "far beyond the error of a receiver";
    prior_scale = 0.1, "1", "scale error at the start, 1 sigma", "mass known to 8 %, torque to 5 %";
    prior_cold_tyre = 0.5, "1", "what cold tyres add, as a fraction of rolling resistance, 1 sigma", "reference/literature: 20 to 60 % at the start";
    prior_tyre_slip = 0.02, "1", "slip over traction per weight, 1 sigma", "tyres: 0.1 to 0.4. Drivers answer the road, so evidence counts for a fiftieth: a prior that is 7 times tighter";
    prior_retarder = 0.4, "1", "error of the retarder's reference torque, 1 sigma", "retarders of 2000 to 4700 Nm on engines of 1850 to 3150 Nm";
    retarder_noise = 0.08, "1", "error of the retarder's force that goes on for 20 m, as a fraction of it", "regional drives: 0.05 is too sure, 0.2 loses 3 %";
    retarder_step_noise = 2.0, "1", "error of a change of the retarder's force within a cell, as a fraction of it", "the report is a tenth of a second old, and so are speeds";

    bias_shock_percent = 0.001, "%", "scale of the prior of a step of the bias, a segment", "one step above 0.3 % in 25 km";
    bias_shock_shape = 0.5, "1", "shape of that prior", "one degree of freedom: steps are rare and large";
    bias_shock_most_percent = 0.6, "%", "largest sigma of a step of the bias", "snow doubles the rolling resistance";
    kink_percent = 0.01, "%", "scale of the prior of a kink of the road, a segment", "roads of straight grades";
    kink_shape = 1.0, "1", "shape of that prior", "two degrees of freedom";
    kink_most_percent = 1.0, "%", "largest sigma of a kink", "junctions";
    start_shock_percent = 0.02, "%", "sigma of either at the first round", "broad beside the scales: variances shrink, and hardly grow";
    doubt_shape = 0.5, "1", "shape of the prior of a step of the doubtful force", "one degree of freedom";
    start_doubt_percent = 0.3, "%", "sigma of that step at the first round", "as above";
    overrun_doubt_percent = 0.2, "%", "scale of the prior of a hidden brake, each 20 m", "brakes come on within 20 m";
    rest_doubt = 0.5, "1", "scale of the prior of a resting torque, as a fraction of its later jump", "a value held since the middle of the rest";
    rest_walk_percent = 0.6, "%/√s", "random walk of a torque that is not renewed, of the reference torque", "torque on motorways";
    rest_long_s = 3.0, "s", "rest from which on a torque may be stuck", "cruise controls hold a torque for less";
    rest_least_percent = 0.02, "%", "force of a rest from which on it is in doubt, as a slope", "below the noise of a cell";
    load_shock = 0.03, "1", "scale of the prior of a load change at a stop", "most stops change nothing";
    load_shock_shape = 0.5, "1", "shape of that prior", "one degree of freedom";
    load_shock_start = 0.8, "1", "sigma of a load change at the first round", "empty to full";
    altitude_freedom = 4.0, "1", "degrees of freedom of the noise of a fix", "usual for outliers (Lange, Little and Taylor 1989)";
    slow_gnss_freedom = 3.0, "1", "degrees of freedom of the slow GNSS error, a segment", "2 and 4 change errors by 1 %";
    slow_gnss_most = 1000.0, "1", "largest multiplier of it", "steps of 20 m";
    road_freedom = 4.0, "1", "degrees of freedom of the road, a segment", "2 to 8 change errors by 1 %";
    road_most = 30.0, "1", "largest multiplier of it", "a crest of a minor road";
    uninformed = 0.5, "1", "part of the step from mode to mean by which a multiplier without information is larger", "0: smoothed errors 1 % larger; 1: live errors 2 % larger";
    revive = 30.0, "1", "score ρ²/n from which on a closed step opens again", "five and a half sigmas; with 20 the NEES of a town is 15 % larger";
    step_odds = 0.001, "1", "prior odds of a step, a segment", "one in 50 km";

    level_weight = 20.0, "cells", "number of determined cells that the assumed levels count for", "5 to 40 change errors by 1 %";
    wind_level_weight = 6.0, "cells", "same of the wind", "its cells are determined a little each";
    level_memory_m = 20000.0, "m", "distance over which levels forget", "a change of the road";
    road_level_low = 0.05, "1", "least level of the road", "a runway";
    road_level_high = 40.0, "1", "largest level of the road", "a town with its segments: six times the sigma";
    wind_level_low = 1.0, "1", "least level of the wind", "the likelihood prefers too little: it cannot tell wind from the receiver";
    wind_level_high = 4.0, "1", "largest level of the wind", "without a bound it takes the place of the road on the measured car: 0.46 % instead of 0.57 % on nine trips of ten";
    slow_gnss_level_low = 0.35, "1", "least level of the slow GNSS error", "1.8 m: what looks still within seconds is not within minutes";
    gnss_level_low = 0.02, "1", "least level of the fast GNSS error", "a seventh of the sigma";
    gnss_level_high = 100.0, "1", "largest level of either GNSS error", "ten times the sigma";
    altitude_level_low = 0.03, "1", "least level of the white noise of a fix", "a sixth of the sigma";
    altitude_level_high = 100.0, "1", "largest level of it", "ten times the sigma";
    force_level_low = 0.1, "1", "least level of the white noise of the force", "a third of the sigma";
    force_level_high = 10000.0, "1", "largest level of it", "a hundred times the sigma";
    speed_level_low = 0.1, "1", "least level of the noise of the speed", "a third of the sigma";
    speed_level_high = 25.0, "1", "largest level of it", "five times the sigma";
    live_multiplier = 1.5, "1", "multiplier of road and receiver ahead of the window", "mean of four degrees of freedom is 2, mode 0.7";
    inconsistent_percent = 0.3, "%", "force beyond which a cell is inconsistent", "five times the error of a smoothed grade";
    timing_s = 0.15, "s", "time by which the signals are older than their time stamps, 1 sigma", "buses of other simulators: 0.05 to 0.2 s";
}
