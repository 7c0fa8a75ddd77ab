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

mod numbers;
mod parameter;

pub use numbers::Numbers;
pub use parameter::{TuningError, TuningParameter};

use crate::time::Duration;
use parameter::tuning;

tuning! {
    /// Noise of the sensors, and how it is learned from innovations.
    measurement_noise: MeasurementNoise {
        speed_sigma_mps: f32 = 0.013, 1e-4..=1.0, "m/s", "white noise of one wheel-speed reading, 1 sigma", "thesis tables 2 and 3: width of the pointwise grade errors gives 0.009 to 0.013";
        crawl_speed_sigma_mps: f32 = 0.1, 1e-4..=2.0, "m/s", "the same below `detection.crawl_mps`, where pulses of a wheel sensor are few", "estimate: one pulse of a 100-tooth wheel a reading";
        speed_ratio_low: f32 = 0.1, 1e-3..=1.0, "1", "smallest learned over assumed variance of speed", "a third of the assumed sigma";
        speed_ratio_high: f32 = 25.0, 1.0..=1e4, "1", "largest learned over assumed variance of speed", "five times the assumed sigma";
        speed_ratio_gain: f32 = 0.01, 0.0..=1.0, "1", "part of a normalised squared innovation by which the ratio follows", "Mehra 1970; a memory of 100 readings";
        force_ratio_gain: f32 = 0.01, 0.0..=1.0, "1", "part of the product of a normalised innovation with those before it by which the noise of the force follows", "as `speed_ratio_gain`";
        force_memory: f32 = 0.9, 0.0..=0.99, "1", "part that one more reading leaves of the innovations before it", "ten readings: what a late force adds is gone by then, what a noisy one adds is not";
        force_correlation: f32 = 0.1, 0.0..=1.0, "1", "mean of that product that is no noise of the force", "chosen";
        force_ratio_high: f32 = 10_000.0, 1.0..=1e8, "1", "largest learned over assumed variance of the force", "a hundred times the assumed sigma";
        altitude_sigma_m: f32 = 0.5, 0.01..=50.0, "m", "white noise of one GNSS altitude at a dilution of precision of 1, 1 sigma", "single-frequency receivers: 0.3 to 1 m from fix to fix";
        altitude_ratio_low: f32 = 0.05, 1e-3..=1.0, "1", "smallest learned over assumed variance of altitude", "a fifth of the assumed sigma";
        altitude_ratio_high: f32 = 100.0, 1.0..=1e4, "1", "largest learned over assumed variance of altitude", "ten times the assumed sigma";
        altitude_ratio_gain: f32 = 0.03, 0.0..=1.0, "1", "part of a normalised squared innovation by which the ratio follows", "Mehra 1970; a memory of 30 fixes";
        gnss_error_sigma_m: f32 = 3.0, 0.01..=100.0, "m", "coloured error of GNSS altitude, 1 sigma", "Ornstein-Uhlenbeck model, Sensors 20:6050";
        gnss_error_time_s: f32 = 200.0, 1.0..=1e5, "s", "correlation time of the coloured error", "Ornstein-Uhlenbeck model, Sensors 20:6050: 100 to 300 s";
        delay_readings: u16 = 450, 10.0..=65_535.0, "readings", "readings, one in two seconds, over which climbs by altitudes and by forces are compared to find a delay of altitudes", "chosen: a quarter of an hour";
        delay_part: f32 = 0.7, 0.0..=1.0, "1", "part of the variance without delay below which a delay counts", "chosen";
        gnss_error_sum_s: f32 = 16.0, 1.0..=1000.0, "s", "time over which innovations are summed to learn the coloured error", "long beside white noise, short beside `gnss_error_time_s`";
        gnss_error_ratio_low: f32 = 0.01, 1e-4..=1.0, "1", "smallest learned over assumed variance of the coloured error", "a tenth of the assumed sigma";
        gnss_error_ratio_high: f32 = 100.0, 1.0..=1e4, "1", "largest learned over assumed variance of the coloured error", "ten times the assumed sigma";
        gnss_error_first_weight: u8 = 3, 1.0..=255.0, "sums", "number of sums that the assumed variance counts as at first", "chosen: the first sums may move it by a third";
        gnss_error_last_weight: u8 = 25, 1.0..=255.0, "sums", "number of sums that the learned variance is a mean over", "chosen: 400 s";
        gnss_error_largest_sum: f32 = 9.0, 1.0..=1e4, "1", "squared sum over its variance that a sum counts as at most", "three sigmas: beyond is no noise";
        largest_innovation: f32 = 25.0, 1.0..=1e4, "1", "normalised squared innovation that an innovation counts as at most when noise is learned", "five sigmas: beyond is no noise";
        many_satellites: f32 = 8.0, 1.0..=50.0, "1", "number of satellites beyond which more do not lower the noise", "chosen";
        dilution_per_missing_satellite: f32 = 0.5, 0.0..=10.0, "1", "dilution of precision that each satellite below `many_satellites` adds, unless the receiver reports more", "on average four satellites have three times the vertical error of many";
        reported_mass_sigma: f32 = 0.05, 1e-3..=1.0, "1", "error of a mass that the bus reports as a part of it, 1 sigma", "chosen: axle loads from air springs scatter by some per cent";
        largest_dilution: f32 = 50.0, 1.0..=1e4, "1", "dilution of precision that counts at most", "chosen: what is beyond has no weight";
    }

    /// Noise of the road and of the vehicle model.
    process_noise: ProcessNoise {
        slope_rate_sigma: f32 = 0.006, 1e-5..=1.0, "%/m", "change of slope along the road, 1 sigma", "AASHTO: a crest for 110 km/h (K = 74) has 0.014";
        slope_rate_length_m: f32 = 150.0, 2.5..=1e4, "m", "correlation length of the change of slope", "length of a vertical curve";
        force_noise_n: f32 = 120.0, 0.0..=1e5, "N", "white force error over one cell, 1 sigma", "fitted on simulated drives";
        inertia_noise: f32 = 0.3, 0.0..=10.0, "1", "error of the torque that turns engine and wheels, as a part of it, 1 sigma", "engine inertia is a figure of a data sheet; torque and speed have unlike delays";
        invalid_noise_percent: f32 = 30.0, 0.0..=1e3, "%", "grade-equivalent noise over one cell in which the model does not hold (shift, brake, no traction), 1 sigma", "thesis section 3: variance up by orders of magnitude";
        bias_force_n: f32 = 250.0, 0.0..=1e5, "N", "slow force error that does not grow with mass (auxiliaries, steady wind), 1 sigma", "VECTO long haul: 5 kW at 80 km/h are 225 N";
        bias_rolling: f32 = 0.15, 0.0..=2.0, "1", "slow error as a part of the rolling resistance (tyres, surface), 1 sigma", "wet road 0.1 to 0.2; a wrong parameter 0.1";
        bias_drag: f32 = 0.1, 0.0..=2.0, "1", "slow error as a part of the air resistance (shape, density), 1 sigma", "a wrong parameter 0.1";
        bias_length_m: f32 = 100_000.0, 100.0..=1e7, "m", "correlation length of the bias", "tyres and oil change within 10 to 50 km";
        wind_sigma_mps: f32 = 0.7, 0.0..=30.0, "m/s", "wind along the road that changes within kilometres, 1 sigma", "fitted on simulated drives";
        wind_length_m: f32 = 3_000.0, 2.5..=1e6, "m", "correlation length of that wind", "wind changes within 1 to 10 km";
        level_knot_m: f32 = 80.0, 10.0..=1e4, "m", "length of a knot, over which climbs are compared to find the levels of the coloured errors", "chosen: four fixes at 20 m/s";
        level_memory_m: f32 = 20_000.0, 100.0..=1e7, "m", "length over which that evidence is forgotten", "weather and surface change within tens of kilometres";
        level_evidence: f32 = 5.0, 0.0..=100.0, "1", "log-likelihood that a level above the assumed one needs beyond it", "a factor of 55";
        scale_walk_per_sqrt_km: f32 = 0.002, 0.0..=1.0, "1/√km", "random walk of the traction scale, 1 sigma", "chosen: 2 % in 100 km";
        traction_change_percent: f32 = 0.1, 0.0..=100.0, "%", "largest change of traction over weight in one cell that the road may have caused", "AASHTO: the sharpest crest for 80 km/h (K = 26) bends by 0.096";
        launch_mps2: f32 = 0.2, 0.0..=10.0, "m/s²", "acceleration above which a change of traction is no answer to the road", "cruise controls accelerate by less";
        jump_matters_percent: f32 = 0.1, 0.0..=100.0, "%", "slope that the unknown part of the scale makes of a change of traction, above which the change shows the scale", "as `traction_change_percent`";
        jump_scale_sigma: f32 = 0.08, 0.0..=1.0, "1", "sigma of the scale, as a part of it, that such changes do not reach", "rotating mass, slip and timing at a launch are known no better";
        jump_noise: f32 = 0.5, 0.0..=10.0, "1", "error of a change of traction that no road causes, as a part of it, 1 sigma", "torque and speed signals have unlike delays";
        effect_change_length_m: f32 = 100.0, 2.5..=1e5, "m", "length of a change of an effect's slope that counts as one change", "chosen";
    }

    /// What is assumed where a drive begins, and when that is reset.
    prior: Prior {
        slope_sigma_percent: f32 = 3.0, 0.01..=50.0, "%", "grade before anything is known, 1 sigma", "roads: standard deviation 1 to 3";
        scale_sigma: f32 = 0.1, 1e-4..=2.0, "1", "error of the traction scale (mass or torque), 1 sigma", "a parameter file for the load at hand: 0.1";
        unreported_scale_sigma: f32 = 0.35, 1e-4..=2.0, "1", "the same where a drive begins in motion and nothing reports the mass, 1 sigma", "files of another load are common: 40 % more, or 30 % less";
        torque_sigma: f32 = 0.04, 0.0..=1.0, "1", "error of the engine torque as a part of it, 1 sigma: it is in the sigma of the mass", "engine torque is right within 4 %, 1 sigma";
        cold_tyre_rolling: f32 = 0.5, 0.0..=5.0, "1", "bias besides the usual at the start, as a part of the rolling resistance, 1 sigma", "cold tyres add 0.3 to 0.8 of it";
        kept_bias: f32 = 0.35, 0.0..=1.0, "1", "part of the bias that belongs to the vehicle and is kept for the next drive", "drag area and shape outlast a trip, weather and tyre temperature do not: 0.3 (12 t) to 0.4 (39 t) of the variance";
        kept_scale: f32 = 0.9, 0.0..=1.0, "1", "part of the scale that is kept for the next drive with the same mass", "regular hauls are the rule: one unreported change of load in ten drives";
        any_load_scale_sigma: f32 = 0.25, 1e-4..=5.0, "1", "scale of a vehicle whose load may be any, 1 sigma", "30 % more load make 0.23";
        same_load: f32 = 0.05, 0.0..=1.0, "1", "largest relative change of the mass that is the same load", "scatter of axle loads";
        open_scale_sigma: f32 = 0.8, 1e-3..=10.0, "1", "scale after a stop, as a part of it: any load, 1 sigma", "an empty and a full combination are a factor of 2.6 apart";
        same_load_sigma: f32 = 0.03, 0.0..=1.0, "1", "change of the scale over a stop that is the same load, 1 sigma", "passengers, parcels, fuel";
        same_load_sigmas: f32 = 2.5, 0.1..=100.0, "1", "difference of the scales before and after a stop, in sigmas, beyond which the load changed", "chosen: one false change in 80 stops";
        launch_m: f32 = 100.0, 2.5..=1e4, "m", "driven distance after which a launch has shown the scale", "gears up to half of the speed";
        launch_longest_m: f32 = 1_000.0, 2.5..=1e5, "m", "the same where it shows little", "chosen";
        open_longest_m: f32 = 20_000.0, 2.5..=1e6, "m", "driven distance after which a load that agrees with the one before is taken for the same", "a flat road shows little";
        launch_scale_sigma: f32 = 0.04, 1e-3..=10.0, "1", "relative sigma of the scale with which it is known well enough to be compared", "chosen: loads differ by more";
        scale_low: f32 = 0.22, 0.01..=1.0, "1", "smallest scale that a vehicle can have", "an empty tractor with the file of a full combination";
        scale_high: f32 = 4.5, 1.0..=100.0, "1", "largest scale that a vehicle can have", "the reverse";
        scale_reset_sigmas: f32 = 3.0, 0.1..=100.0, "1", "distance of the scale from its prior, in sigmas, beyond which the prior was too narrow", "three sigmas";
        scale_reset_cells: u32 = 200, 1.0..=1e6, "cells", "number of cells for which it must be so", "500 m: single fixes move the scale far and back";
    }

    /// The accelerometer: its errors, and when it is used.
    inertial: Inertial {
        acceleration_sigma_mps2: f32 = 0.2, 1e-3..=10.0, "m/s²", "white noise of one reading, 1 sigma", "road roughness in a cab: 0.1 to 0.3";
        ratio_low: f32 = 0.02, 1e-4..=1.0, "1", "smallest learned over assumed variance of a reading", "a seventh of the assumed sigma";
        ratio_high: f32 = 100.0, 1.0..=1e4, "1", "largest learned over assumed variance of a reading", "ten times the assumed sigma";
        ratio_gain: f32 = 0.01, 0.0..=1.0, "1", "part of a normalised squared innovation by which the ratio follows", "as `speed_ratio_gain`";
        offset_sigma_mps2: f32 = 0.5, 1e-3..=10.0, "m/s²", "offset before anything is known, 1 sigma", "a mounting angle of 3°";
        changed_offset_sigma_mps2: f32 = 0.1, 0.0..=10.0, "m/s²", "change of the offset over a drive, 1 sigma", "chosen: its drift, and the bias of the model";
        kept_offset_sigma_mps2: f32 = 0.05, 0.0..=10.0, "m/s²", "change of the offset from the end of a drive to the start of the next, 1 sigma", "a warm sensor is cold again";
        drift_mps2_per_sqrt_s: f32 = 0.001, 0.0..=1.0, "m/s²/√s", "random walk of the offset, 1 sigma", "0.02 to 0.05 over twenty minutes of warming up";
        gain: f32 = 0.05, -1.0..=1.0, "1", "what the reading of a specific force gains because the body pitches under it", "suspensions: 0.3° for 1 m/s²";
        gain_sigma: f32 = 0.03, 0.0..=1.0, "1", "its error, and that of the sensor's scale, 1 sigma", "chosen";
        gain_least_sigma: f32 = 0.02, 0.0..=1.0, "1", "its error once learned, 1 sigma", "the scale of the forces looks the same";
        pitch_gain_sigma: f32 = 0.03, 0.0..=1.0, "1", "what the reading of an acceleration gains besides, 1 sigma", "chosen";
        pitch_gain_least_sigma: f32 = 0.01, 0.0..=1.0, "1", "its error once learned, 1 sigma", "rotating mass and timing of the torque look the same";
        scale_sigma: f32 = 0.8, 1e-3..=10.0, "1", "scale of the forces before it is compared with the accelerometer, 1 sigma", "as `open_scale_sigma`";
        scale_least_sigma: f32 = 0.02, 1e-4..=1.0, "1", "the same once compared, 1 sigma", "as `gain_least_sigma`";
        air_sigma: f32 = 0.3, 0.0..=10.0, "1", "part of the air resistance that the model lacks, before it is compared with the accelerometer, 1 sigma", "a drag that is off by 15 %, and a steady wind of 3 m/s at 30 m/s";
        air_least_sigma: f32 = 0.1, 0.0..=10.0, "1", "the same once compared, 1 sigma", "winds change with the direction";
        scale_error: f32 = 0.1, 0.0..=10.0, "1", "scale error of an accelerometer that may be used, 1 sigma", "chosen: beyond three of it the axis or the unit is wrong";
        learned_m: f32 = 500.0, 0.0..=1e5, "m", "distance with a valid model before an accelerometer may be used", "chosen";
        known_sigma_mps2: f32 = 0.03, 1e-4..=10.0, "m/s²", "sigma of its slow errors at which it may be used", "0.3 % of slope";
        usable_sigma_mps2: f32 = 0.1, 1e-4..=10.0, "m/s²", "the same up to which it begins to be used then; it goes on up to 1.5 times that", "1 % of slope";
        known_scale_sigma: f32 = 0.15, 1e-3..=10.0, "1", "sigma of the scale by the accelerometer at which it may be used", "a sensor on another axis or in another unit differs by more";
        largest_usual: f32 = 9.0, 1.0..=1e4, "1", "usual square of a block of innovations over its variance, beyond which the accelerometer is not used", "chosen";
        frozen_cells: u16 = 20, 1.0..=65_535.0, "cells", "equal readings in a row that show a stuck accelerometer", "chosen: road noise moves the mean of a cell";
        block_cells: u8 = 8, 1.0..=255.0, "cells", "cells over which innovations are summed to compare force and accelerometer", "20 m";
        slack: f32 = 0.7, 0.0..=10.0, "1", "part of each block that is usual, in sigmas", "half of the smallest shift that is looked for";
        sum: f32 = 7.0, 0.1..=1e3, "1", "sum of blocks, in sigmas, that shows a wrong force", "a false one in a thousand kilometres";
        small_slack: f32 = 0.3, 0.0..=10.0, "1", "the same where a small error is looked for", "half of it";
        small_sum: f32 = 12.0, 0.1..=1e3, "1", "sum of blocks, in sigmas, that shows a small error", "as rare";
        suspicion: f32 = 2.0, 0.0..=100.0, "1", "error of the force that is suspected where a sum is nearly that large, as a part of what the accelerometer shows, 1 sigma", "chosen";
        unchanged_part: f32 = 0.4, 0.0..=1.0, "1", "part of both sums that is enough while the traction stays the same to the last digit for unusually long", "a stuck torque does";
        unchanged_s: f32 = 3.5, 0.1..=1e4, "s", "time for which a traction stays the same to the last digit, beyond twice the longest so far, at which that part is reached", "chosen";
        agreed_sigmas: f32 = 2.0, 0.1..=100.0, "1", "largest difference of a block, in sigmas, that agrees", "two sigmas";
        agreed_blocks: u16 = 6, 1.0..=1e4, "blocks", "blocks in a row that must agree before a force is believed again", "120 m";
        doubt: f32 = 0.3, 0.0..=10.0, "1", "part of a disagreement that may be the accelerometer's, 1 sigma", "chosen";
        longest_m: f32 = 3_000.0, 2.5..=1e6, "m", "distance of a disagreement after which the accelerometer is rejected", "chosen: torque comes back sooner";
        unchanged_percent_per_s: f32 = 0.5, 0.0..=100.0, "%/s", "what is not known of a traction for each second for which it stays the same unusually long, 1 sigma", "traction follows the road: 0.1 % in a cell at most";
        weigh_m: f32 = 250.0, 2.5..=1e6, "m", "distance between two measurements of the scale by the accelerometer", "chosen";
        alone_m: f32 = 200.0, 2.5..=1e6, "m", "distance without a valid model from which the sigma contains the slow error of the accelerometer", "its noise is larger before that";
    }

    /// Gates: which measurements to reject.
    gates: Gates {
        speed_test_ratio: f32 = 25.0, 1.0..=1e6, "1", "normalised squared innovation beyond which a speed is a step of the sensor", "five sigmas";
        slope_step_cells: f32 = 8.0, 1.0..=1e3, "cells", "cells over which innovations of the speed are summed to find a step of the slope", "20 m: roads bend over more";
        slope_step_sigmas: f32 = 5.0, 0.1..=100.0, "1", "sum of such innovations, in sigmas, that is a step", "chosen";
        slope_step_first_cells: u16 = 200, 0.0..=65_535.0, "cells", "cells before the first step may be found", "1 km: the noise of the speed is learned by then";
        slope_step_rest_cells: u16 = 20, 0.0..=65_535.0, "cells", "cells between two steps", "chosen";
        slope_step_gain: f32 = 0.005, 0.0..=1.0, "1", "part of a squared sum by which its usual size follows", "a memory of 200 cells";
        slope_step_largest: f32 = 4.0, 1.0..=1e4, "1", "squared sum over its usual size that counts at most for it", "a step is not usual";
        slope_step_percent: f32 = 0.7, 0.0..=50.0, "%", "size of a step, 1 sigma", "snow doubles or triples a rolling resistance of 0.6";
        altitude_test_ratio: f32 = 25.0, 1.0..=1e6, "1", "normalised squared innovation beyond which an altitude is rejected", "five sigmas: errors among houses have heavy tails";
        receiver_step_fixes: u8 = 4, 1.0..=255.0, "fixes", "rejected fixes in a row that make a step of the receiver", "chosen";
        receiver_step_agreement: f32 = 0.5, 0.0..=1.0, "1", "part of their offset within which these fixes must agree", "chosen";
        contradiction_percent: f32 = 3.0, 0.0..=100.0, "%", "offset over the distance without a fix above which a growing one shows a wrong model", "a receiver does not drift by 3 m in 100";
        drift_sigmas: f32 = 4.0, 0.1..=1e3, "1", "difference of climbs by GNSS and by the model, in sigmas, beyond which the receiver drifts", "chosen on simulated drives: no false drift in 20 drives";
        drift_fixes: u8 = 3, 1.0..=255.0, "fixes", "compared fixes in a row that must say so", "chosen";
        drift_segment_m: f32 = 100.0, 2.5..=1e4, "m", "length of a segment over which climbs are compared", "chosen: ten segments are one kilometre";
        drift_model_sigma_m: f32 = 0.1, 0.0..=10.0, "m", "error of the model's climb that does not grow with length, 1 sigma", "reading noise at both ends";
        drift_model_most_percent: f32 = 1.5, 0.0..=100.0, "%", "slope of a drift up to which the model may be off instead", "snow at three times the rolling resistance is 1.2";
        drift_slope_sigma_percent: f32 = 0.25, 1e-3..=100.0, "%", "largest sigma of bias, wind and scale, as a slope, with which the model can test a receiver", "chosen: where a drive begins, the model is off";
        drift_ratio_high: f32 = 10.0, 1.0..=1e4, "1", "largest learned over assumed variance of the climbs' difference", "three times the assumed sigma";
        drift_ratio_gain: f32 = 0.005, 0.0..=1.0, "1", "part of a comparison by which the ratio follows", "a memory of 200 comparisons";
        drift_largest_mean: f32 = 2.0, 1.0..=1e4, "1", "mean normalised squared difference that a comparison counts as at most", "a drift is not usual";
        doubt_mean: f32 = 3.0, 0.1..=1e4, "1", "mean normalised squared difference of a comparison beyond which the model is in doubt", "chosen: 1 is expected; 5 % of the cells on hilly roads without a fault";
        doubt_fixes: u8 = 4, 1.0..=255.0, "fixes", "compared fixes in a row, of the same sign, that must say so", "chosen: 100 m and more";
        drift_end_ratio: f32 = 4.0, 0.1..=1e4, "1", "normalised squared difference below which a drift is over", "two sigmas";
        drift_end_m: f32 = 300.0, 2.5..=1e5, "m", "length over which the climbs must agree again", "chosen";
        drift_longest_m: f32 = 2_500.0, 2.5..=1e6, "m", "length after which a drift is an error of the model", "chosen: receivers recover sooner";
        drift_believed_m: f32 = 5_000.0, 2.5..=1e6, "m", "length for which fixes are used untested afterwards", "chosen: the filter relearns its bias";
        altitude_gap_s: f32 = 10.0, 0.1..=1e4, "s", "time without an altitude that counts as a gap", "slow receivers send every 5 s";
        gnss_silence: ms = 900_000, 0.0..=1e8, "ms", "time without an altitude after which the next one sets the altitude", "altitudes of telematics come every 2 to 10 minutes, and teach the bias; beyond, the receiver's state is another one";
    }

    /// Hold times, delays and timeouts.
    hold_times: HoldTimes {
        shift_hold: ms = 1_000, 0.0..=60_000.0, "ms", "time for which the model stays invalid after a gear shift", "torque and speed signals have unlike delays";
        brake_hold: ms = 1_000, 0.0..=60_000.0, "ms", "time for which the model stays invalid after braking", "brakes release within a second";
        retarder_hold: ms = 2_000, 0.0..=60_000.0, "ms", "time for which the model stays invalid after retarder torque", "a retarder empties slowly";
        gnss_latency: ms = 150, 0.0..=10_000.0, "ms", "age of a GNSS fix when it arrives", "typical of receivers on a bus";
        held_torque_timeout: ms = 1_500, 0.0..=60_000.0, "ms", "age beyond which a torque is unknown whose repeated values are no new ones", "tables at 1 Hz renew it sooner";
        torque_timeout: ms = 2_500, 0.0..=60_000.0, "ms", "age beyond which torque, force or engine speed are unknown", "tables at 1 Hz, one row missing";
        speed_timeout: ms = 2_500, 0.0..=2_500.0, "ms", "longest time between two speed readings that is bridged", "tables at 1 Hz, one row missing";
        state_timeout: ms = 5_000, 0.0..=600_000.0, "ms", "age beyond which a gear, a switch or a quality figure is unknown", "slowest sender of such a signal: 1 s";
        effect_input_timeout: ms = 2_500, 0.0..=600_000.0, "ms", "age beyond which course, yaw rate and GNSS speed are unknown", "they change with the position";
        source_timeout: ms = 5_000, 0.0..=600_000.0, "ms", "silence of a signal's source after which another one may stand in", "slowest relevant sender: 5 s (VP)";
        source_start: ms = 10_000, 0.0..=600_000.0, "ms", "time from the first reading in which the lowest source address takes a signal", "controllers start within 10 s";
        clock_set_back: ms = 1_000, 1.0..=60_000.0, "ms", "time for which inputs continue from an earlier time before the clock counts as set back", "chosen";
        clock_far_ahead: ms = 10_000, 1.0..=600_000.0, "ms", "silence after which one input alone does not move the time", "all readings are stale by then";
        measured_ratio: ms = 2_000, 0.0..=60_000.0, "ms", "time for which engine and wheels must turn at a ratio other than the reported gear's until it counts", "clutches close within two seconds";
        load_stop: ms = 15_000, 0.0..=1e8, "ms", "shortest standstill in which the load may change without a report", "tipping and uncoupling take a quarter of a minute at least";
        weighing: ms = 30_000, 0.0..=600_000.0, "ms", "time after a stop in which a reported mass still belongs to it", "SPN 1760 has no fixed rate";
        stop: ms = 3_000, 0.0..=600_000.0, "ms", "shortest standstill at which the vehicle may be weighed", "chosen";
        long_stop: ms = 600_000, 0.0..=1e8, "ms", "standstill or silence after which load and tyre temperature may be any", "loading and coupling take minutes";
    }

    /// Detection: states of the vehicle that are inferred from signals, and plausibility of readings.
    detection: Detection {
        crawl_mps: f32 = 1.5, 0.0..=20.0, "m/s", "speed below which speed readings are coarse", "wheel sensors are bad below 1.5 (ZTBus)";
        coast_mps: f32 = 5.0, 0.0..=50.0, "m/s", "speed from which an open driveline coasts; below it a clutch slips at launch and passes torque", "launch in the lowest gears ends below 5";
        clutch_slip_percent: f32 = 5.0, 0.0..=50.0, "%", "clutch slip beyond a sensor's offset; and distance from full slip of an open clutch", "chosen";
        engine_tolerance: f32 = 0.1, 0.0..=1.0, "1", "relative difference of engine speed and gear that is no slip", "worn tyres and ages of readings; gearboxes step by 0.17";
        launch_tolerance: f32 = 0.05, 0.0..=1.0, "1", "the same at launch, where the engine approaches the gear's speed slowly", "chosen";
        gear_ratio_tolerance: f32 = 0.05, 0.0..=0.5, "1", "relative difference up to which a measured ratio is that of a gear", "the narrowest gearboxes step by 0.17";
        gear_agreed_readings: u16 = 100, 1.0..=65_535.0, "readings", "readings in which engine and gear must have agreed before a reported gear is rejected for turning otherwise", "chosen: 10 s at 10 Hz";
        loaded_percent: f32 = 10.0, 0.0..=100.0, "%", "net engine torque that more than the engine's own auxiliaries takes up", "chosen";
        brake_pressure_pa: f32 = 20_000.0, 0.0..=1e7, "Pa", "pressure in the service brakes beyond a sensor's offset", "chosen";
        brake_pedal_percent: f32 = 0.5, 0.0..=100.0, "%", "pedal travel beyond an offset", "resolution of SPN 521: 0.4";
        retarder_percent: f32 = -1.5, -100.0..=0.0, "%", "retarder torque below which it brakes", "resolution of SPN 520: 1, and its drag";
        retarder_force_n: f32 = 300.0, 0.0..=100_000.0, "N", "force of the retarder at the wheels beyond which it brakes", "1.5 % of a retarder of 3500 Nm on the shaft";
        undeclared_brake_percent: f32 = 3.0, 0.0..=100.0, "%", "slope of the moment above that of the road so far that is a brake, where none is reported", "no road steepens by 3 within metres";
        undeclared_brake_sigmas: f32 = 4.0, 0.0..=100.0, "1", "the same in standard deviations of the one around the other", "four sigmas";
        undeclared_brake_moment_cells: f32 = 4.0, 1.0..=1e4, "cells", "cells over which the slope of the moment is averaged", "noise of the wheel speed";
        undeclared_brake_road_cells: f32 = 40.0, 1.0..=1e4, "cells", "cells over which the slope of the road is averaged", "100 m";
        undeclared_brake_sigma_cells: f32 = 400.0, 1.0..=1e5, "cells", "cells over which the standard deviation is averaged", "1 km";
        undeclared_brake_longest_cells: u16 = 200, 1.0..=65_535.0, "cells", "cells after which it was a slope", "500 m";
        held_rest: ms = 800, 0.0..=60_000.0, "ms", "time for which a torque is the same, after which its change follows a rest", "frames come ten times as often at least";
        held_part: f32 = 0.9, 0.0..=1.0, "1", "part of the movement of a torque after rests, beyond which it is held between them", "fresh torque steps after a rest where the driver lets go, and moves on at once elsewhere";
        held_after_percent: f32 = 100.0, 0.0..=1e5, "%", "movement of the torque after which it may be found to be held", "some five changes; a part of 0.3 at most follows rests on the trips of the measured car";
        silent_brake_traction_percent: f32 = 0.1, -10.0..=10.0, "%", "traction over weight up to which the engine drives nothing", "drivers do not brake and drive at once";
        silent_brake_sum: f32 = 10.0, 0.1..=1e3, "1", "sum of altitudes below the climb of the model, in sigmas, that shows a brake then", "a false one in a thousand kilometres without traction";
        silent_brake_least_percent: f32 = 1.5, 0.0..=100.0, "%", "slope that it hides at least", "receivers drift by 1 m in 100 m";
        silent_brake_steepest_percent: f32 = 15.0, 0.0..=100.0, "%", "slope beyond which it is an error of the altitude", "no main road is steeper";
        silent_brake_slack: f32 = 0.5, 0.0..=10.0, "1", "part of each that is usual, in sigmas", "half of the smallest shift that is looked for";
        silent_brake_most: f32 = 3.5, 0.1..=100.0, "1", "most that one of them counts, in sigmas", "chosen: one may be an outlier";
        silent_brake_slope_percent: f32 = 6.0, 0.0..=100.0, "%", "slope that an unreported brake may hide, 1 sigma", "steep descents of main roads";
        speed_hardest_mps2: f32 = 10.0, 1.0..=100.0, "m/s²", "largest acceleration of a vehicle on tyres", "friction of 1";
        speed_step_mps: f32 = 0.3, 0.0..=10.0, "m/s", "difference of two speed readings besides that", "noise, and steps of 1 km/h";
        speed_believed: ms = 1_000, 0.0..=60_000.0, "ms", "time for which readings agree on another speed until it counts", "chosen";
        speed_turned_mps2: f32 = 1.0, 0.0..=100.0, "m/s²", "acceleration by which a vehicle turns back a change of its speed from one reading to the next", "a gear shift takes longer";
        speed_turned_part: f32 = 0.125, 0.0..=1.0, "1", "part of the last speed readings that turn back, beyond which two senders send them", "of 20 garbled readings one; two senders make one in six and more";
        speed_frozen_readings: u8 = 20, 1.0..=255.0, "readings", "equal speed readings in a row that may come from a stuck sensor", "chosen: 2 s at 10 Hz";
        speed_frozen_change: f32 = 0.005, 0.0..=1.0, "1", "relative change of engine speed over the gear that shows it", "chosen";
        speed_frozen_steps: f32 = 3.0, 0.0..=100.0, "steps", "the same in steps of the speed's resolution", "chosen";
        altitude_frozen_m: f32 = 100.0, 1.0..=1e4, "m", "length on which no receiver repeats an altitude to the last digit", "chosen";
        altitude_frozen_fixes: u8 = 6, 1.0..=255.0, "fixes", "repetitions that show a stuck receiver", "chosen";
        fewest_satellites: f32 = 4.0, 0.0..=50.0, "1", "fewest satellites that give an altitude", "four unknowns: position and clock";
        position_reach_m: f32 = 200.0, 0.0..=1e4, "m", "distance over which the last position is extended", "chosen";
        course_mps: f32 = 2.0, 0.0..=20.0, "m/s", "lowest speed at which a course over ground has a meaning", "receivers hold or scatter it below";
        turn_mps: f32 = 3.0, 0.0..=20.0, "m/s", "lowest speed at which its change gives a yaw rate", "chosen";
        timing_readings: u16 = 400, 10.0..=65_535.0, "readings", "readings of the speed over ground over which it is compared with wheel speed", "chosen: five minutes at 10 Hz";
        timing_part: f32 = 0.6, 0.0..=1.0, "1", "part of the variance at the assumed latency below which another latency counts", "chosen";
        lag_slots: u16 = 28_800, 40.0..=65_535.0, "slots", "quarters of a second over which the speed over ground is compared with the acceleration", "two hours; a receiver stays as it is, and light trucks hardly accelerate";
        traction_lag_slots: u16 = 4_800, 40.0..=65_535.0, "slots", "quarters of a second over which the force is compared with the acceleration", "twenty minutes";
        lag_sigma_s: f32 = 0.03, 1e-4..=10.0, "s", "sigma of the receiver's latency from which on it may count", "0.7 m at 80 km/h";
        lag_apart_s: f32 = 0.04, 0.0..=10.0, "s", "difference from the assumed latency, besides two sigmas, beyond which another one counts", "wheel speeds are late as well, by some 30 ms";
        speed_scale_change: f32 = 0.03, 0.0..=1.0, "1", "relative difference of wheel speed and speed over ground above which the wheel speed is scaled", "worn tyres make 0.02";
        turn_length_m: f32 = 50.0, 1.0..=1e4, "m", "length over which the change of course is averaged", "a receiver's course scatters by 0.3°";
        reverse_course_mps: f32 = 0.8, 0.0..=20.0, "m/s", "lowest speed at which a course shows the direction of motion", "receivers scatter it by tens of degrees there";
        reverse_fastest_mps: f32 = 5.0, 0.0..=100.0, "m/s", "highest speed of a vehicle that reverses by its course alone", "no driver reverses at 18 km/h";
        reverse_turned_deg: f32 = 120.0, 90.0..=180.0, "°", "change of course over a stop beyond which the vehicle reverses", "no vehicle turns so far within metres";
        standing_mps: f32 = 0.1, 0.0..=2.0, "m/s", "speed below which a vehicle stands", "wheel sensors report zero from about there";
        mass_change: f32 = 0.15, 0.0..=10.0, "1", "relative change of the reported mass at stops that is another load", "weighings and passenger counts report less well enough";
        mass_low: f32 = 0.2, 0.0..=1.0, "1", "smallest reported mass that is accepted, as a part of the parameter", "an empty tractor of a full combination";
        mass_high: f32 = 5.0, 1.0..=100.0, "1", "largest reported mass that is accepted, as a part of the parameter", "a full combination of an empty tractor";
        persist_cells: u32 = 2_000, 0.0..=1e9, "cells", "cells driven before a drive leaves a persistent state", "5 km: before that it is not worth a write";
        persist_altitudes: u32 = 100, 0.0..=1e9, "fixes", "altitudes used before a drive leaves a persistent state", "as above";
    }
}
