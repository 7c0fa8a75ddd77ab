//! Tables of studies on the measured road and on structures.

use super::measured_tables::{of_rows, unexpected, whole_table};
use host_sim::error::Result;

/// Makes the table of the thesis's runs on its own road, over campaigns.
pub fn e4_runs() -> Result<Option<String>> {
    let header = [
        "run",
        "modified %",
        "ours %",
        "better in, of ten",
        "NEES modified",
        "NEES ours",
    ];
    of_rows("e4", "e4_campaigns", header, |row| {
        let [
            run,
            modified,
            ours,
            _,
            _,
            _,
            better,
            nees_modified,
            nees_ours,
        ] = row
        else {
            return Err(unexpected("a row of the campaigns has other columns"));
        };
        Ok([run, modified, ours, better, nees_modified, nees_ours].map(Clone::clone))
    })
}

/// Makes the table of maps against the number of runs on that road.
pub fn e4_convergence() -> Result<Option<String>> {
    let header = [
        "method",
        "1 run %",
        "3 runs %",
        "5 runs %",
        "10 runs %",
        "exponent",
    ];
    of_rows("e4", "e4_convergence", header, all)
}

/// Makes the table of the truck on a track.
pub fn track() -> Result<Option<String>> {
    whole_table("track", "track_errors")
}

/// Makes the table of what explains its errors.
pub fn track_effects() -> Result<Option<String>> {
    whole_table("track", "track_effects")
}

/// Makes the table of structures.
pub fn bridges() -> Result<Option<String>> {
    whole_table("bridges", "bridges_terrain")
}

/// Makes the table of the measured bus beside terrain.
pub fn bridges_bus() -> Result<Option<String>> {
    whole_table("bridges", "bridges_bus")
}

fn all<const N: usize>(row: &[String]) -> Result<[String; N]> {
    let row = row.to_vec().try_into();
    row.map_err(|_| unexpected("a row of a study has other columns"))
}
