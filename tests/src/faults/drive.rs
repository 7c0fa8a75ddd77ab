//! The simulated drives for the faults, with their truth.

use host_sim::error::Result;
use host_sim::simulator::scenario::Scenario;
use host_sim::simulator::{SimulatedRun, simulate};
use std::path::Path;
use test_kit::simulated::without_sessions;

/// Simulates 30 km of truck "A" or "B" with every parameter wrong by one sigma, wind and cold
/// tyres. Multi-packet messages are left out: faults count and change frames one by one.
///
/// # Errors
/// The truck is unknown, or gets stuck.
pub fn drive(truck: &str, seed: u64) -> Result<SimulatedRun> {
    let text = format!(
        "seed = {seed}\n[road]\nlength_m = 30000.0\n[rates]\nfast_ms = 50.0\n\
         [errors]\nmass_sigma = 0.1\ndrag_sigma = 0.1\nrolling_sigma = 0.1\ntorque_sigma = 0.04\n\
         [tyres]\ncold_amount = 0.3\n\
         [wind]\nspeed_mps = 2.0\nfrom_deg = 250.0\ngust_sigma_mps = 0.3\n\
         [gnss]\naltitude_sigma_m = 2.0\naltitude_time_s = 250.0\naltitude_white_sigma_m = 0.3\n\
         [[runs]]\nname = \"x\"\ntruck = \"{truck}\"\nstart_time_s = 20000.0\n"
    );
    simulated(&Scenario::parse(&text, Path::new("faults"))?, 0)
}

/// Number of laps of 20 km that take more than 24 hours.
pub const DAY_LAPS: usize = 98;

/// Simulates the two laps of a day of [`DAY_LAPS`]: 20 km there, and 20 km back.
///
/// # Errors
/// Returns the errors of [`drive`].
pub fn lap(truck: &str) -> Result<[SimulatedRun; 2]> {
    let text = format!(
        "[road]\nlength_m = 20000.0\n[rates]\nfast_ms = 1000.0\n\
         [gnss]\naltitude_sigma_m = 2.0\naltitude_time_s = 250.0\naltitude_white_sigma_m = 0.3\n\
         [[runs]]\nname = \"there\"\ntruck = \"{truck}\"\n\
         [[runs]]\nname = \"back\"\ntruck = \"{truck}\"\ndirection = \"backward\"\n"
    );
    let scenario = Scenario::parse(&text, Path::new("day"))?;
    Ok([simulated(&scenario, 0)?, simulated(&scenario, 1)?])
}

fn simulated(scenario: &Scenario, index: usize) -> Result<SimulatedRun> {
    let mut run = simulate(scenario, index)?;
    run.frames = without_sessions(run.frames);
    Ok(run)
}
