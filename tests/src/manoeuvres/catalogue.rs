//! The manoeuvres and faults by name.

use super::drives::{BenchTruck, Plan, When};
use super::road::Profile;
use super::signals::Edit;
use host_sim::simulator::manoeuvre_file::{Section, Stop};

/// Where manoeuvres begin, m from the start of the drive.
pub const ONSET_M: f64 = 15_000.0;
/// The end of every drive, m.
pub const END_M: f64 = 1e6;

/// Returns every manoeuvre for both trucks, those without a fault first.
#[must_use]
pub fn catalogue(seed: u64) -> Vec<Plan> {
    let of = |truck| {
        let mut makers = Vec::new();
        makers.extend(without_fault(truck, seed));
        makers.extend(standing(truck, seed));
        makers.extend(descents(truck, seed));
        makers.extend(driveline(truck, seed));
        makers.extend(torque(truck, seed));
        makers.extend(surroundings(truck, seed));
        makers.extend(speed(truck, seed));
        makers.extend(receiver(truck, seed));
        makers
    };
    let mut plans: Vec<Plan> = BenchTruck::ALL.into_iter().flat_map(of).collect();
    plans.sort_by_key(|plan| !plan.faults.is_empty());
    plans
}

/// Makes plans of one truck and seed.
struct Maker(BenchTruck, u64);

impl Maker {
    fn plan(&self, name: impl Into<String>, shape: impl FnOnce(&mut Plan)) -> Plan {
        let mut plan = Plan::new(name, self.0, self.1);
        shape(&mut plan);
        plan
    }

    /// An edit of frames, which is the fault.
    fn edit(&self, name: impl Into<String>, when: When, edit: Edit) -> Plan {
        self.plan(name, |plan| add_edit(plan, when, edit))
    }

    fn section(&self, name: impl Into<String>, section: Section) -> Plan {
        self.plan(name, |plan| add_section(plan, section))
    }
}

/// Adds an edit of frames, which is the fault.
pub fn add_edit(plan: &mut Plan, when: When, edit: Edit) {
    plan.edits.push((when, edit));
    plan.faults.push(when);
}

/// Adds a section, which is the fault.
pub fn add_section(plan: &mut Plan, section: Section) {
    plan.faults.push(When::Way(section.from_m, section.to_m));
    plan.sections.push(section);
}

/// Adds a stop, which is the fault.
pub fn add_stop(plan: &mut Plan, stop: Stop) {
    plan.faults.push(When::Stop(plan.stops.len()));
    plan.stops.push(stop);
}

/// Adds a stop at which the load changes, and which no signal reports.
pub fn add_load_change(plan: &mut Plan, stop: Stop, mass_kg: f64) {
    add_stop(
        plan,
        Stop {
            mass_kg: Some(mass_kg),
            ..stop
        },
    );
    plan.edits.push((When::Always, Edit::MassUntold));
}

/// Returns the loaded and the empty mass of a truck, kg.
#[must_use]
pub const fn masses_kg(truck: BenchTruck) -> (f64, f64) {
    match truck {
        BenchTruck::A => (39_000.0, 15_000.0),
        BenchTruck::B => (24_000.0, 12_000.0),
    }
}

fn without_fault(truck: BenchTruck, seed: u64) -> Vec<Plan> {
    let make = Maker(truck, seed);
    vec![
        make.plan("no fault", |_| {}),
        make.plan("no fault: mass not told", |plan| {
            plan.edits.push((When::Always, Edit::MassUntold));
        }),
        make.plan("no fault: stop of 60 s", |plan| {
            plan.stops.push(Stop::new(ONSET_M, 60.0));
        }),
        make.plan("no fault: retarder told, descent of 6 %", |plan| {
            plan.profiles.push(descent(6.0, 2_000.0));
            plan.sections.push(retarder());
        }),
    ]
}

fn standing(truck: BenchTruck, seed: u64) -> Vec<Plan> {
    let make = Maker(truck, seed);
    let (loaded_kg, empty_kg) = masses_kg(truck);
    let mut plans = Vec::new();
    for reverse_m in [50.0, 60.0] {
        plans.push(
            make.plan(format!("reverses {reverse_m} m to a dock"), |plan| {
                let stop = Stop {
                    reverse_m,
                    ..Stop::new(ONSET_M, 120.0)
                };
                add_stop(plan, stop);
            }),
        );
    }
    for (from_kg, to_kg) in [(loaded_kg, empty_kg), (empty_kg, loaded_kg)] {
        for seconds in [20.0, 60.0, 300.0] {
            let name = format!(
                "{:.0} to {:.0} t, stop of {seconds} s",
                1e-3 * from_kg,
                1e-3 * to_kg
            );
            plans.push(make.plan(name, |plan| {
                plan.mass_kg = Some(from_kg);
                add_load_change(plan, Stop::new(ONSET_M, seconds), to_kg);
            }));
        }
    }
    let coupled_kg = empty_kg + 17_000.0;
    plans.push(make.plan("trailer coupled, 60 s", |plan| {
        plan.mass_kg = Some(empty_kg);
        add_load_change(plan, Stop::new(ONSET_M, 60.0), coupled_kg);
    }));
    plans.push(make.plan("trailer coupled, 600 s, ignition off", |plan| {
        plan.mass_kg = Some(empty_kg);
        add_load_change(plan, Stop::new(ONSET_M, 600.0), coupled_kg);
        plan.edits.push((When::Stop(0), Edit::Silence));
    }));
    plans.push(make.plan("trailer dropped, 600 s, ignition off", |plan| {
        plan.mass_kg = Some(coupled_kg);
        add_load_change(plan, Stop::new(ONSET_M, 600.0), empty_kg);
        plan.edits.push((When::Stop(0), Edit::Silence));
    }));
    plans.push(make.plan("ferry of 4 km in 900 s", |plan| {
        let stop = Stop {
            carried_m: 4_000.0,
            ..Stop::new(ONSET_M, 900.0)
        };
        add_stop(plan, stop);
    }));
    plans.push(make.plan("ferry of 4 km in 900 s, ignition off", |plan| {
        let stop = Stop {
            carried_m: 4_000.0,
            ..Stop::new(ONSET_M, 900.0)
        };
        add_stop(plan, stop);
        plan.edits.push((When::Stop(0), Edit::Silence));
    }));
    plans.push(make.plan("lift axle raised at a stop", |plan| {
        plan.stops.push(Stop::new(ONSET_M, 30.0));
        let section = Section {
            rolling_factor: 0.9,
            ..Section::new(ONSET_M, END_M)
        };
        add_section(plan, section);
    }));
    plans
}

/// Returns a descent at the onset: steepness in % and length in m.
#[must_use]
pub fn descent(percent: f64, length_m: f64) -> Profile {
    Profile {
        from_m: ONSET_M,
        corners: vec![(0.0, -percent), (length_m, -percent)],
    }
}

/// Returns the section of a whole drive with a retarder.
#[must_use]
pub const fn retarder() -> Section {
    Section {
        retarder: true,
        ..Section::new(0.0, END_M)
    }
}

fn descents(truck: BenchTruck, seed: u64) -> Vec<Plan> {
    let make = Maker(truck, seed);
    let mut plans = Vec::new();
    for (percent, length_m) in [(5.0, 3_000.0), (6.0, 2_000.0), (8.0, 1_000.0)] {
        for with_retarder in [false, true] {
            let what = if with_retarder { "retarder" } else { "brakes" };
            let km = 1e-3 * length_m;
            let name = format!("{what} not told, {percent} % over {km} km");
            plans.push(make.plan(name, |plan| {
                plan.profiles.push(descent(percent, length_m));
                if with_retarder {
                    plan.sections.push(retarder());
                }
                plan.edits.push((When::Always, Edit::BrakesUntold));
                plan.faults.push(When::Way(ONSET_M, ONSET_M + length_m));
            }));
        }
    }
    for percent in [14.0, 17.0] {
        plans.push(
            make.plan(format!("crest of {percent} %, retarder told"), |plan| {
                let half = 0.5 * percent;
                plan.profiles.push(Profile {
                    from_m: ONSET_M,
                    corners: vec![(0.0, half), (300.0, half), (700.0, -half), (1_000.0, -half)],
                });
                plan.sections.push(retarder());
                plan.faults.push(When::Way(ONSET_M, ONSET_M + 1_000.0));
            }),
        );
    }
    plans.push(make.plan("anti-lock brakes at a stop", |plan| {
        plan.stops.push(Stop::new(ONSET_M, 30.0));
        add_edit(
            plan,
            When::Way(ONSET_M - 380.0, ONSET_M - 20.0),
            Edit::AntiLock,
        );
    }));
    plans
}

fn driveline(truck: BenchTruck, seed: u64) -> Vec<Plan> {
    let make = Maker(truck, seed);
    let mut plans = Vec::new();
    for off in [-1, 1] {
        for seconds in [60.0, 120.0, 300.0] {
            plans.push(make.edit(
                format!("gear {off:+} told for {seconds} s"),
                When::Seconds(ONSET_M, seconds),
                Edit::GearOff(off),
            ));
        }
    }
    plans.push(make.section(
        "power take-off of 300 Nm",
        Section {
            pto_nm: 300.0,
            ..Section::new(ONSET_M, END_M)
        },
    ));
    for ratio in [2.0, 3.0, 4.0] {
        plans.push(make.plan(format!("low range {ratio} for 5 km"), |plan| {
            // The range is changed at a standstill.
            plan.stops.push(Stop::new(ONSET_M - 50.0, 15.0));
            plan.stops.push(Stop::new(ONSET_M + 5_000.0 - 20.0, 15.0));
            let section = Section {
                range_ratio: ratio,
                set_speed_mps: Some(22.2 / ratio),
                ..Section::new(ONSET_M, ONSET_M + 5_000.0)
            };
            add_section(plan, section);
        }));
    }
    plans.push(make.edit(
        "wheel slip of 10 % for 1 km",
        When::Way(ONSET_M, ONSET_M + 1_000.0),
        Edit::Slip(0.1),
    ));
    plans
}

fn torque(truck: BenchTruck, seed: u64) -> Vec<Plan> {
    let make = Maker(truck, seed);
    [
        ("torque every 2 s", Edit::TorqueEvery(2.0)),
        ("torque held for 2 s", Edit::TorqueHeld(2.0)),
        ("torque held for 5 s", Edit::TorqueHeld(5.0)),
        ("torque in steps of 5 %", Edit::TorqueSteps(5.0)),
        ("torque low-passed 1 s", Edit::TorqueLowPass(1.0)),
        ("torque 2 s late", Edit::TorqueLate(2.0)),
        (
            "torque wanders 5 %, 30 s",
            Edit::TorqueWander(0.05, 30.0, seed),
        ),
    ]
    .into_iter()
    .map(|(name, edit)| make.edit(name, When::Always, edit))
    .collect()
}

fn surroundings(truck: BenchTruck, seed: u64) -> Vec<Plan> {
    let make = Maker(truck, seed);
    let mut plans = Vec::new();
    for (name, wind) in [
        ("gusts 2 m/s in 8 m/s", (8.0, 2.0, 60.0)),
        ("gusts 2 m/s over 10 s in 8 m/s", (8.0, 2.0, 10.0)),
        ("gusts 1 m/s over 30 s in 5 m/s", (5.0, 1.0, 30.0)),
    ] {
        plans.push(make.plan(name, |plan| {
            plan.wind = wind;
            plan.faults.push(When::Always);
        }));
    }
    for rolling_factor in [2.0, 3.0] {
        plans.push(make.section(
            format!("rolling resistance x{rolling_factor} from 15 km"),
            Section {
                rolling_factor,
                ..Section::new(ONSET_M, END_M)
            },
        ));
    }
    for headwind_mps in [8.0, -8.0] {
        plans.push(make.section(
            format!("headwind {headwind_mps:+} m/s from 15 km"),
            Section {
                headwind_mps,
                ..Section::new(ONSET_M, END_M)
            },
        ));
    }
    plans
}

fn speed(truck: BenchTruck, seed: u64) -> Vec<Plan> {
    let make = Maker(truck, seed);
    vec![
        make.edit("speed x1.10", When::Always, Edit::SpeedFactor(1.1)),
        make.edit("speed x0.90", When::Always, Edit::SpeedFactor(0.9)),
        make.edit(
            "speed x1.10 for 5 km",
            When::Way(ONSET_M, ONSET_M + 5_000.0),
            Edit::SpeedFactor(1.1),
        ),
        make.edit(
            "speed in steps of 1 km/h",
            When::Always,
            Edit::SpeedSteps(1.0 / 3.6),
        ),
        make.edit(
            "speed low-passed 1 s",
            When::Always,
            Edit::SpeedLowPass(1.0),
        ),
    ]
}

fn receiver(truck: BenchTruck, seed: u64) -> Vec<Plan> {
    let make = Maker(truck, seed);
    let mut plans = Vec::new();
    for time_s in [10.0, 30.0] {
        plans.push(make.edit(
            format!("altitude low-passed {time_s} s"),
            When::Always,
            Edit::AltitudeLowPass(time_s),
        ));
    }
    for m_per_km in [2.0, -2.0] {
        plans.push(
            make.plan(format!("altitude drifts {m_per_km:+} m/km"), |plan| {
                plan.ramps.push((0.0, 50_000.0, 50.0 * m_per_km));
                plan.faults.push(When::Always);
            }),
        );
    }
    for late_s in [1.0, 2.0, 5.0] {
        plans.push(
            make.plan(format!("GNSS {late_s} s late, by place"), |plan| {
                plan.gnss_late_s = Some(late_s);
                plan.by_place = true;
                plan.faults.push(When::Always);
            }),
        );
    }
    plans.push(make.plan("tunnel of 3 km", |plan| {
        plan.outages.push((ONSET_M, ONSET_M + 3_000.0));
        plan.faults.push(When::Way(ONSET_M, ONSET_M + 3_000.0));
    }));
    plans.push(make.plan("multipath steps of 5-15 m", |plan| {
        for (index, metres) in [5.0, -8.0, 15.0, -12.0, 10.0, -5.0].into_iter().enumerate() {
            let from_m = ONSET_M + 600.0 * index as f64;
            plan.steps.push((from_m, from_m + 250.0, metres));
        }
        plan.faults.push(When::Way(ONSET_M, ONSET_M + 3_250.0));
    }));
    plans
}
