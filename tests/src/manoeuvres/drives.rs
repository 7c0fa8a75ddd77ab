//! A drive of the bench: what happens on it, and what was true of it.

use super::road::{Profile, with_profiles};
use super::signals::Edit;
use super::truth::{Driven, When};
use host_sim::error::Result;
use host_sim::simulator::manoeuvre_file::{Section, Stop};
use host_sim::simulator::road::Road;
use host_sim::simulator::scenario::Scenario;
use std::path::Path;

/// Length of a drive, m.
pub const LENGTH_M: f64 = 35_000.0;
/// Way between the stretches of successive seeds, m; the first one starts so far from the road's
/// start.
const STRETCH_M: f64 = 17_000.0;
/// Time of the log's clock at the start, s.
const START_S: f64 = 20_000.0;

/// A truck of the bench.
#[derive(Clone, Copy, Debug, PartialEq, Eq, PartialOrd, Ord)]
pub enum BenchTruck {
    /// 39 t.
    A,
    /// 12 t.
    B,
}

impl BenchTruck {
    /// Both trucks.
    pub const ALL: [Self; 2] = [Self::A, Self::B];

    /// Returns the name.
    #[must_use]
    pub const fn name(self) -> &'static str {
        match self {
            Self::A => "A",
            Self::B => "B",
        }
    }
}

/// What happens on a drive. Distances are m from its start.
#[derive(Clone, Debug)]
pub struct Plan {
    /// What happens, in words.
    pub name: String,
    /// The truck.
    pub truck: BenchTruck,
    /// Seed of the drive; the stretch of the road follows from it.
    pub seed: u64,
    /// Mass in the vehicle file, kg; `None` is that of the truck.
    pub mass_kg: Option<f64>,
    /// Steady wind and gusts, m/s, and correlation time of gusts, s.
    pub wind: (f64, f64, f64),
    /// Age of GNSS messages, s; `None` is the usual one.
    pub gnss_late_s: Option<f64>,
    /// Stretches without a fix, m.
    pub outages: Vec<(f64, f64)>,
    /// Altitude steps: from, to, and by how much, m.
    pub steps: Vec<(f64, f64, f64)>,
    /// Altitude ramps: from, to, and up to what error, m.
    pub ramps: Vec<(f64, f64, f64)>,
    /// Stops; their masses are those that the vehicle file would have to have.
    pub stops: Vec<Stop>,
    /// Sections in which something is different.
    pub sections: Vec<Section>,
    /// Other profiles of the road.
    pub profiles: Vec<Profile>,
    /// Changes of what frames say.
    pub edits: Vec<(When, Edit)>,
    /// When there is a fault; empty on a drive without any.
    pub faults: Vec<When>,
    /// True if cells are judged by the place that they state, not by their time.
    pub by_place: bool,
}

impl Plan {
    /// Creates a drive without manoeuvre or fault.
    #[must_use]
    pub fn new(name: impl Into<String>, truck: BenchTruck, seed: u64) -> Self {
        Self {
            name: name.into(),
            truck,
            seed,
            mass_kg: None,
            wind: (2.0, 0.3, 60.0),
            gnss_late_s: None,
            outages: Vec::new(),
            steps: Vec::new(),
            ramps: Vec::new(),
            stops: Vec::new(),
            sections: Vec::new(),
            profiles: Vec::new(),
            edits: Vec::new(),
            faults: Vec::new(),
            by_place: false,
        }
    }

    /// Returns the scenario: the base errors of the faults' drives, and what happens.
    fn scenario(&self, road: &Road) -> Result<Scenario> {
        let (wind_mps, gust_mps, gust_s) = self.wind;
        let mass = self
            .mass_kg
            .map_or_else(String::new, |mass_kg| format!("mass_kg = {mass_kg:?}\n"));
        let text = format!(
            "seed = {}\n[road]\nlength_m = 100.0\n[rates]\nfast_ms = 50.0\n\
             [errors]\nmass_sigma = 0.1\ndrag_sigma = 0.1\nrolling_sigma = 0.1\ntorque_sigma = 0.04\n\
             [tyres]\ncold_amount = 0.3\n\
             [wind]\nspeed_mps = {wind_mps:?}\nfrom_deg = 250.0\ngust_sigma_mps = {gust_mps:?}\n\
             gust_time_s = {gust_s:?}\n\
             [gnss]\naltitude_sigma_m = 2.0\naltitude_time_s = 250.0\naltitude_white_sigma_m = 0.3\n\
             [[runs]]\nname = \"x\"\ntruck = \"{}\"\nstart_time_s = {START_S:?}\n{mass}",
            self.seed,
            self.truck.name(),
        );
        let mut scenario = Scenario::parse(&text, Path::new(&self.name))?;
        let start_m = self.start_m(road);
        let profiles: Vec<Profile> = self
            .profiles
            .iter()
            .map(|profile| Profile {
                from_m: profile.from_m + start_m,
                ..profile.clone()
            })
            .collect();
        scenario.road = with_profiles(road, &profiles)?;
        if let Some(late_s) = self.gnss_late_s {
            scenario.latency_ms.gnss = 1e3 * late_s;
        }
        let shifted =
            |&(from, to, metres): &(f64, f64, f64)| (from + start_m, to + start_m, metres);
        scenario.gnss.steps = self.steps.iter().map(shifted).collect();
        scenario.gnss.ramps = self.ramps.iter().map(shifted).collect();
        let outages = self.outages.iter();
        scenario.gnss.outages_m = outages.map(|o| (o.0 + start_m, o.1 + start_m)).collect();
        let run = &mut scenario.runs[0];
        run.start_distance_m = start_m;
        run.length_m = LENGTH_M.min(road.length_m() - start_m - 1.0);
        let true_part = run.truck.mass_kg / f64::from(run.vehicle.model.vehicle.mass_kg);
        run.stops = self.stops.clone();
        for stop in &mut run.stops {
            stop.at_m += start_m;
            stop.mass_kg = stop.mass_kg.map(|mass_kg| mass_kg * true_part);
        }
        run.sections = self.sections.clone();
        for section in &mut run.sections {
            section.from_m += start_m;
            section.to_m += start_m;
        }
        Ok(scenario)
    }

    /// Returns the start of the stretch on the road, m.
    fn start_m(&self, road: &Road) -> f64 {
        let room_m = (road.length_m() - LENGTH_M - STRETCH_M).max(1.0);
        (STRETCH_M * self.seed as f64) % room_m
    }

    /// Simulates the drive.
    ///
    /// # Errors
    /// Returns an error if the truck gets stuck.
    pub fn driven(&self, road: &Road) -> Result<Driven> {
        Driven::simulated(&self.scenario(road)?)
    }

    /// Returns the same drive with everything reported, and without what is at fault. Its road,
    /// stops and sections of the driver's own choice stay.
    #[must_use]
    pub fn faultless(&self) -> Self {
        let plain = Self::new("", self.truck, self.seed);
        Self {
            mass_kg: self.mass_kg,
            stops: self
                .stops
                .iter()
                .map(|stop| Stop::new(stop.at_m, stop.seconds))
                .collect(),
            sections: self
                .sections
                .iter()
                .map(|section| Section {
                    set_speed_mps: section.set_speed_mps,
                    retarder: section.retarder,
                    ..Section::new(section.from_m, section.to_m)
                })
                .filter(|section| *section != Section::new(section.from_m, section.to_m))
                .collect(),
            profiles: self.profiles.clone(),
            ..plain
        }
    }
}
