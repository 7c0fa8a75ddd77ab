//! Every threshold and noise level of the estimator: default, unit, range, meaning and source on one
//! line each.
//!
//! A host reads other values from a file (`--tuning FILE.toml`, see `docs/tuning.md`). The keys in
//! that file are the field names here; a [`Duration`] has the ending `_ms`. Physical constants, the
//! ranges of accepted readings and the sizes of fixed memory are no tuning: they stand where they
//! are used.
//!
//! Force noises are forces. The grade error that they make is proportional to 1/(m g), so one set
//! serves a loaded combination and a solo tractor.

mod parameter;

pub use parameter::{TuningError, TuningParameter};

use crate::time::Duration;
use parameter::tuning;

tuning! {
    /// The filter and the inference of its variances.
    estimation: Numbers {
        speed_noise_mps: f32 = 0.013, 1e-04..=1e+00, "m/s", "white noise of one wheel-speed reading, 1 sigma", "thesis tables 2 and 3: width of the pointwise grade errors gives 0.009 to 0.013";
        crawl_speed_noise_mps: f32 = 0.1, 1e-03..=1e+01, "m/s", "same of a crawling vehicle, where pulses of a wheel sensor are few", "one pulse of a 100-tooth wheel a reading";
        altitude_noise_m: f32 = 0.3, 3e-03..=3e+01, "m", "white noise of one GNSS altitude at a dilution of precision of 1, 1 sigma", "single-frequency receivers: 0.3 to 1 m from fix to fix";
        vertical_speed_noise_mps: f32 = 0.1, 1e-3..=1e1, "m/s", "white noise of a vertical speed of a receiver, 1 sigma", "single-frequency receivers: 0.03 to 0.2; its level is learned";
        body_noise: f32 = 0.05, 0.0..=1.0, "1", "error of accelerometer and pitch by the body that pitches, as a fraction of the specific force, 1 sigma", "suspensions: 0.3° for 1 m/s²";
        body_offset_percent: f32 = 0.15, 1e-3..=1e1, "%", "error of the offset of accelerometer and pitch, 1 sigma", "the bias of the force balance over a kilometre";
        body_sensor_cells: f32 = 800.0, 1e2..=1e5, "cells", "memory of that offset", "2 km: sensors warm up, loads shift";
        slow_gnss_noise_m: f32 = 3.0, 3e-02..=3e+02, "m", "slow error of GNSS altitude, 1 sigma", "Ornstein-Uhlenbeck model, Sensors 20:6050";
        slow_gnss_time_s: f32 = 200.0, 2e+00..=2e+04, "s", "correlation time of the slow error", "Ornstein-Uhlenbeck model, Sensors 20:6050: 100 to 300 s";
        fast_gnss_noise_m: f32 = 0.5, 5e-03..=5e+01, "m", "fast error of GNSS altitude, 1 sigma", "receivers on judged drives: 0.1 to 1 m within ten seconds";
        fast_gnss_time_s: f32 = 6.0, 6e-02..=6e+02, "s", "correlation time of the fast error", "receivers on judged drives; 4 to 10 s change no error by more than 1 %";
        switched_gnss_noise_m: f32 = 30.0, 3e-01..=3e+03, "m", "step of the altitude where another receiver takes over, 1 sigma", "datums differ by the height of the geoid, up to 50 m in Europe";

        slope_rate_noise: f32 = 0.006, 6e-05..=6e-01, "%/m", "change of slope along the road, 1 sigma", "AASHTO: a crest for 110 km/h (K = 74) has 0.014";
        slope_rate_length_m: f32 = 150.0, 2e+00..=2e+04, "m", "correlation length of the change of slope", "length of a vertical curve";
        invalid_road: f32 = 16.0, 2e-01..=2e+03, "1", "factor on the road's variance where shifts and brakes hide the force", "drivers shift and brake where roads bend: city and regional drives of other simulators";

        force_noise_n: f32 = 120.0, 1e+00..=1e+04, "N", "white noise of the force over one cell, 1 sigma", "pointwise grades of the thesis; its level is learned";
        inertia_noise: f32 = 0.5, 5e-03..=5e+01, "1", "error of the torque that turns engine and wheels, and of a change of traction at a launch, as a fraction of it, 1 sigma", "launches of city drives; engine inertia is a figure of a data sheet";
        invalid_noise_percent: f32 = 30.0, 3e-01..=3e+03, "%", "noise of the force where it is not known, as a slope, 1 sigma", "thesis section 3: variance up by orders of magnitude";
        bias_force_n: f32 = 250.0, 2e+00..=2e+04, "N", "slow force error that does not grow with mass, 1 sigma", "VECTO long haul: 5 kW at 80 km/h are 225 N";
        bias_resistance: f32 = 0.12, 2e-03..=2e+01, "1", "slow error as a fraction of rolling resistance and of air resistance, 1 sigma", "wet road 0.1 to 0.2; trailers and bodies differ by 10 %";
        bias_length_m: f32 = 100000.0, 1e+03..=1e+07, "m", "correlation length of the slow error", "a drive";
        wind_noise_mps: f32 = 0.8, 8e-03..=8e+01, "m/s", "wind along the road that changes within kilometres, 1 sigma", "between gusts of 2 m/s and calm air; the likelihood is flat there";
        wind_length_m: f32 = 1000.0, 1e+01..=1e+05, "m", "correlation length of the changing wind", "500 to 3000 m change the errors of judged drives by less than 2 %";
        traction_noise: f32 = 0.02, 2e-04..=2e+00, "1", "error of the traction that changes within kilometres, as a fraction of it, 1 sigma", "actual engine torque (SPN 513) is known to some per cent";
        scale_walk_per_sqrt_km: f32 = 0.002, 2e-05..=2e-01, "1/√km", "random walk of the scale", "fuel burnt, torque map";

        launch_length_m: f32 = 1000.0, 1e+01..=1e+05, "m", "distance behind a stop within which a vehicle launches", "a loaded truck reaches 80 km/h within a kilometre";
        launch_mps2: f32 = 0.2, 2e-03..=2e+01, "m/s²", "acceleration from which on it launches", "cruise controls answer roads with less";
        prior_slope_percent: f32 = 3.0, 3e-02..=3e+02, "%", "slope where a drive begins, 1 sigma", "trunk roads";
        prior_scale: f32 = 0.1, 1e-03..=1e+01, "1", "scale error at the start besides the load, 1 sigma", "torque and gears known to 10 %";
        prior_cold_tyre: f32 = 0.5, 5e-03..=5e+01, "1", "what cold tyres add, as a fraction of rolling resistance, 1 sigma", "reference/literature: 20 to 60 % at the start";
        prior_tyre_slip: f32 = 0.02, 2e-04..=2e+00, "1", "slip over traction per weight, 1 sigma", "tyres: 0.1 to 0.4. Drivers answer the road, so evidence counts for a fiftieth: a prior that is 7 times tighter";
        prior_retarder: f32 = 0.4, 4e-03..=4e+01, "1", "error of the retarder's reference torque, 1 sigma", "retarders of 2000 to 4700 Nm on engines of 1850 to 3150 Nm";
        retarder_noise: f32 = 0.08, 8e-04..=8e+00, "1", "error of the retarder's force that goes on for 20 m, as a fraction of it", "regional drives: 0.05 is too sure, 0.2 loses 3 %";
        retarder_step_noise: f32 = 2.0, 2e-02..=2e+02, "1", "error of a change of the retarder's force within a cell, as a fraction of it", "the report is a tenth of a second old, and so are speeds";

        bias_shock_percent: f32 = 0.001, 1e-05..=1e-01, "%", "scale of the prior of a step of the bias, a segment", "one step above 0.3 % in 25 km";
        shock_shape: f32 = 0.5, 5e-03..=5e+01, "1", "shape of the priors of steps: of the bias, of the road, of a doubtful force, of the load", "one degree of freedom: steps are rare and large";
        bias_shock_most_percent: f32 = 0.6, 6e-03..=6e+01, "%", "largest sigma of a step of the bias", "snow doubles the rolling resistance";
        kink_percent: f32 = 0.01, 1e-04..=1e+00, "%", "scale of the prior of a kink of the road, a segment", "roads of straight grades";
        kink_most_percent: f32 = 1.0, 1e-02..=1e+02, "%", "largest sigma of a kink", "junctions; without it one car trip of ten is 11 % worse";
        start_shock_percent: f32 = 0.02, 2e-04..=2e+00, "%", "sigma of either at the first round", "broad beside the scales: variances shrink, and hardly grow";
        start_doubt_percent: f32 = 0.3, 3e-03..=3e+01, "%", "sigma of that step at the first round", "brakes and torques that are wrong are off by tenths of a per cent and more";
        overrun_doubt_percent: f32 = 0.2, 2e-03..=2e+01, "%", "scale of the prior of a hidden brake, each 20 m", "brakes come on within 20 m";
        rest_doubt: f32 = 0.5, 5e-03..=5e+01, "1", "scale of the prior of a resting torque, as a fraction of its later jump", "a value held since the middle of the rest";
        rest_walk_percent: f32 = 0.6, 6e-03..=6e+01, "%/√s", "random walk of a torque that is not renewed, of the reference torque", "torque on motorways";
        least_force_percent: f32 = 0.03, 3e-04..=3e+00, "%", "force over weight that counts as none: of an engine in overrun, of a retarder, of a torque that rests", "1 % of the torque of a loaded truck in its top gear";
        load_shock: f32 = 0.03, 3e-04..=3e+00, "1", "scale of the prior of a load change at a stop", "most stops change nothing";
        any_load: f32 = 0.5, 5e-03..=5e+01, "1", "sigma of the load of a drive, and of its change at a stop, before the data say more", "a file for half a load: full and empty are 0.6 and 2 times its scale";
        load_told: f32 = 0.3, 1e-3..=1e1, "1", "sigma of a load change at most where the mass is reported", "reports lack some changes; empty to full is rare then";
        freedom: f32 = 4.0, 4e-02..=4e+02, "1", "degrees of freedom of the noise of a fix, and of the road of a segment", "usual for outliers (Lange, Little and Taylor 1989); 2 to 8 change errors by 1 %";
        slow_gnss_freedom: f32 = 3.0, 3e-02..=3e+02, "1", "degrees of freedom of the slow GNSS error, a segment", "2 and 4 change errors by 1 %";
        slow_gnss_most: f32 = 1000.0, 1e+01..=1e+05, "1", "largest multiplier of it", "steps of 20 m";
        road_most: f32 = 30.0, 3e-01..=3e+03, "1", "largest multiplier of it", "a crest of a minor road";
        uninformed: f32 = 0.5, 5e-03..=5e+01, "1", "part of the step from mode to mean by which a multiplier without information is larger", "0: smoothed errors 1 % larger; 1: live errors 2 % larger";
        gate: f32 = 16.0, 1.0..=1e4, "1", "square of a score or an innovation over its variance that is no chance: a closed step opens again, and the live filter leaves an altitude out", "four sigmas; with 30 snow on a long haul is lost, with 12 live errors of judged drives are 2 % larger; the live filter may have 25 as well";
        step_margin: f32 = 8.0, 0.0..=1e3, "1", "ρ²/n by which a step must exceed a kink of the road in its place", "2 ln 50: kinks are 50 times as common. Without it live errors of the measured car are 19 % larger, of the bus 18 %";
        step_odds: f32 = 0.001, 1e-05..=1e-01, "1", "prior odds of a step, a segment", "one in 50 km";

        level_weight: f32 = 20.0, 2e-01..=2e+03, "cells", "number of determined cells that the assumed levels count for", "5 to 40 change errors by 1 %";
        level_memory_m: f32 = 20000.0, 2e+02..=2e+06, "m", "distance over which levels forget", "a change of the road";
        level_low: f32 = 0.05, 5e-04..=5e+00, "1", "least level of a noise", "a fifth of the sigma; half of it and twice it change errors by less than 1 %";
        level_high: f32 = 1000.0, 1.0..=1e+05, "1", "largest level of a noise", "thirty times the sigma: the speeds of some loggers";
        road_level_low: f32 = 0.05, 5e-04..=5e+00, "1", "least level of the road", "a runway";
        road_level_high: f32 = 40.0, 4e-01..=4e+03, "1", "largest level of the road", "a town with its segments: six times the sigma";
        slow_gnss_level_low: f32 = 0.35, 3e-03..=4e+01, "1", "least level of the slow GNSS error", "1.8 m: what looks still within seconds is not within minutes";
        live_multiplier: f32 = 1.5, 1e-02..=2e+02, "1", "multiplier of road and receiver ahead of the window", "mean of four degrees of freedom is 2, mode 0.7";
        inconsistent_percent: f32 = 0.3, 3e-03..=3e+01, "%", "force beyond which a cell is inconsistent", "five times the error of a smoothed grade";
        timing_s: f32 = 0.15, 2e-03..=2e+01, "s", "time by which the signals are older than their time stamps, 1 sigma", "buses of other simulators: 0.05 to 0.2 s";
    }

    /// Receivers and reported masses.
    measurement_noise: MeasurementNoise {
        many_satellites: f32 = 8.0, 1.0..=50.0, "1", "number of satellites beyond which more do not lower the noise; n of fewer raise it by (many/n)² unless the receiver reports more", "on average four satellites have three times the vertical error of many";
        reported_mass_sigma: f32 = 0.05, 1e-3..=1.0, "1", "error of a mass that the bus reports as a part of it, 1 sigma", "axle loads from air springs scatter by some per cent";
    }

    /// What is kept for the next drive.
    prior: Prior {
        torque_sigma: f32 = 0.04, 0.0..=1.0, "1", "error of the engine torque as a part of it, 1 sigma: it is in the sigma of the mass", "engine torque is right within 4 %, 1 sigma";
        kept_bias: f32 = 0.35, 0.0..=1.0, "1", "part of the bias that belongs to the vehicle and is kept for the next drive", "drag area and shape outlast a trip, weather and tyre temperature do not: 0.3 (12 t) to 0.4 (39 t) of the variance";
        kept_scale: f32 = 0.9, 0.0..=1.0, "1", "part of the scale that is kept for the next drive with the same mass", "regular hauls are the rule: one unreported change of load in ten drives";
        kept_level_cells: f32 = 100.0, 0.0..=1e6, "cells", "determined cells that the levels of the last drive count for", "a quarter of a kilometre of this drive weighs as much";
    }

    /// Hold times, delays and timeouts.
    hold_times: HoldTimes {
        hold: ms = 500, 0.0..=60_000.0, "ms", "time for which the force stays unknown after a gear shift, braking or retarder torque", "signals have unlike delays; 0.3 to 1 s";
        gnss_latency: ms = 150, 0.0..=10_000.0, "ms", "age of a GNSS fix when it arrives", "typical of receivers on a bus";
        reading_timeout: ms = 2_500, 0.0..=2_500.0, "ms", "age beyond which speed, torque, engine speed, course and yaw rate are unknown", "tables at 1 Hz, one row missing";
        state_timeout: ms = 5_000, 0.0..=600_000.0, "ms", "age beyond which a gear, a switch or a quality figure is unknown, and silence after which another source stands in", "slowest relevant sender: 5 s (VP)";
        start: ms = 10_000, 1.0..=600_000.0, "ms", "time from the first reading in which the lowest source address takes a signal; silence after which one input alone does not move the time", "controllers start within 10 s, and all readings are stale by then";
        agreement: ms = 1_000, 1.0..=60_000.0, "ms", "time for which inputs agree on another speed or an earlier time until it counts", "ten messages at 10 Hz: a damaged one has no successors";
        measured_ratio: ms = 2_000, 0.0..=60_000.0, "ms", "time for which engine and wheels must turn at a ratio other than the reported gear's until it counts", "clutches close within two seconds";
        load_stop: ms = 15_000, 0.0..=600_000.0, "ms", "shortest standstill in which the load may change without a report; time after a stop in which a reported mass still belongs to it", "tipping and uncoupling take a quarter of a minute at least; SPN 1760 has no fixed rate";
        stop: ms = 3_000, 0.0..=600_000.0, "ms", "shortest standstill: of a cell that holds a stop, and at which the vehicle may be weighed", "a cell at 1 m/s takes 2.5 s";
        long_stop: ms = 600_000, 0.0..=1e8, "ms", "standstill or silence after which load and tyre temperature may be any", "loading and coupling take minutes";
    }

    /// Detection: states of the vehicle that are inferred from signals, and plausibility of readings.
    detection: Detection {
        slow_mps: f32 = 2.0, 0.0..=20.0, "m/s", "speed below which readings of the speed are coarse, and a course has no meaning", "wheel sensors are bad below 1.5 (ZTBus); receivers hold or scatter a course";
        launch_mps: f32 = 5.0, 0.0..=50.0, "m/s", "speed below which a vehicle launches or reverses: above it an open driveline coasts, and no vehicle reverses by its course alone", "launch in the lowest gears ends below 5; no driver reverses at 18 km/h";
        clutch_slip_percent: f32 = 5.0, 0.0..=50.0, "%", "clutch slip beyond a sensor's offset; and distance from full slip of an open clutch", "SPN 522 has a resolution of 0.4, and sensors of both shafts differ by a per cent or two";
        gear_tolerance: f32 = 0.05, 0.0..=0.5, "1", "relative difference of engine speed and gear at launch, and of a measured ratio and that of a gear, that is none; twice that once a gear is in", "worn tyres and ages of readings; the narrowest gearboxes step by 0.17";
        gear_agreed_readings: u16 = 100, 1.0..=65_535.0, "readings", "readings in which engine and gear must have agreed before a reported gear is rejected for turning otherwise", "10 s at 10 Hz: a wrong gear fits for no longer";
        loaded_percent: f32 = 10.0, 0.0..=100.0, "%", "net engine torque that more than the engine's own auxiliaries takes up", "fan, alternator and compressor take up to 30 kW of 350";
        brake_pressure_pa: f32 = 20_000.0, 0.0..=1e7, "Pa", "pressure in the service brakes beyond a sensor's offset", "sensors are off by up to 2 % of 10 bar";
        brake_pedal_percent: f32 = 0.5, 0.0..=100.0, "%", "pedal travel beyond an offset", "resolution of SPN 521: 0.4";
        retarder_percent: f32 = -1.5, -100.0..=0.0, "%", "retarder torque below which it brakes", "resolution of SPN 520: 1, and its drag";
        retarder_force_n: f32 = 300.0, 0.0..=100_000.0, "N", "force of the retarder at the wheels beyond which it brakes", "1.5 % of a retarder of 3500 Nm on the shaft";
        speed_hardest_mps2: f32 = 10.0, 1.0..=100.0, "m/s²", "largest acceleration of a vehicle on tyres", "friction of 1";
        speed_step_mps: f32 = 0.3, 0.0..=10.0, "m/s", "difference of two speed readings besides that", "noise, and steps of 1 km/h";
        speed_turned_mps2: f32 = 1.0, 0.0..=100.0, "m/s²", "acceleration by which a vehicle turns back a change of its speed from one reading to the next", "a gear shift takes longer";
        speed_turned_part: f32 = 0.125, 0.0..=1.0, "1", "part of the last speed readings that turn back, beyond which two senders send them", "of 20 garbled readings one; two senders make one in six and more";
        frozen_readings: u8 = 10, 1.0..=255.0, "readings", "equal readings in a row of a speed or an altitude that may come from a stuck sensor", "a second at 10 Hz";
        speed_frozen_change: f32 = 0.005, 0.0..=1.0, "1", "relative change of engine speed over the gear that shows it", "idle control and resolution (SPN 190: 0.125 rpm) make 0.001";
        speed_frozen_steps: f32 = 3.0, 0.0..=100.0, "steps", "the same in steps of the speed's resolution", "noise of a step to either side, and the reading before";
        fix_reach_m: f32 = 200.0, 1.0..=1e4, "m", "distance over which the last position is extended, and on which no receiver repeats an altitude to the last digit", "a receiver that is 5 s late is 125 m behind at 90 km/h; on 0.1 % the altitude changes by 0.2 m there";
        delay_memory_s: f32 = 7_200.0, 60.0..=1e6, "s", "time over which receiver and force are compared with the wheel speed for their delays", "two hours: they stay as they are, and light trucks hardly accelerate";
        delay_evidence: f32 = 6.0, 0.0..=1e9, "1", "evidence from which on a delay is another one than assumed: logarithm of the ratio of their likelihoods", "odds of 400 to 1";
        speed_scale_change: f32 = 0.03, 0.0..=1.0, "1", "relative difference of wheel speed and speed over ground above which the wheel speed is scaled", "worn tyres make 0.02";
        turn_length_m: f32 = 100.0, 1.0..=1e4, "m", "length over which the change of course is averaged, and of a change of an effect's slope that counts as one", "a receiver's course scatters by 0.3°: 0.003 m/s² of lateral acceleration at 80 km/h";
        reverse_course_mps: f32 = 0.8, 0.0..=20.0, "m/s", "lowest speed at which a course shows the direction of motion", "receivers scatter it by tens of degrees there";
        reverse_turned_deg: f32 = 120.0, 90.0..=180.0, "°", "change of course over a stop beyond which the vehicle reverses", "no vehicle turns so far within metres";
        standing_mps: f32 = 0.1, 0.0..=2.0, "m/s", "speed below which a vehicle stands", "wheel sensors report zero from about there";
        mass_change: f32 = 0.1, 0.0..=10.0, "1", "relative change of the reported mass that is another load", "axle loads scatter by 5 %";
        mass_range: f32 = 5.0, 1.0..=100.0, "1", "largest ratio of a reported mass that is accepted and the parameter, either way", "a full combination of an empty tractor";
        persist_cells: u32 = 2_000, 0.0..=1e9, "cells", "cells driven before a drive leaves a persistent state", "5 km: before that it is not worth a write";
    }
}
