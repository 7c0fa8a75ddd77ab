//! A live drive on a map: the grade with it, and the road ahead.

#![cfg(target_os = "linux")]

use estimator_core::roadmap::{MapCounters, PackedMap};
use estimator_core::{Tuning, Uncertain};
use host_sim::files::flash_image;
use host_sim::live::Session;
use host_sim::live::panel::{header, json, line, panel};
use host_sim::live::road_view::{Fork, RoadState, RoadView};
use host_sim::live::view::LiveView;
use host_sim::map::{MapRow, WayRows, packed_map};
use host_sim::recorder::{LongRun, Recorder, RunSummary};
use host_sim::simulator::SimulatedRun;
use host_sim::source::can_frame::{CanFrame, TimedFrame};
use host_sim::source::socketcan::{Received, ReceivedItem};
use test_kit::simulated::{A, MILD, run};

/// Returns the map that a drive makes.
fn map_of(drive: &SimulatedRun) -> PackedMap<'static> {
    let mut recorder = recorder(drive);
    drive
        .frames
        .iter()
        .for_each(|frame| recorder.on_frame(frame));
    let rows = recorder.finish().unwrap().rows;
    let rows = rows.iter().filter_map(|row| {
        Some(MapRow {
            distance_m: row.distance_m,
            latitude_deg: row.latitude_deg?,
            longitude_deg: row.longitude_deg?,
            altitude_m: row.altitude_m,
            grade_percent: row.grade_percent,
            grade_sigma_percent: 0.04,
            runs: 3,
        })
    });
    let way = WayRows {
        name: None,
        rows: rows.collect(),
    };
    PackedMap::open(packed_map(&[way]).unwrap().leak()).unwrap()
}

fn recorder(drive: &SimulatedRun) -> Recorder<f32> {
    Recorder::new(drive.vehicle.model.clone(), Tuning::default()).unwrap()
}

/// Returns the view after this part of the drive.
fn view_at(drive: &SimulatedRun, map: Option<PackedMap<'static>>, part: f64) -> LiveView {
    driven(session(drive).with_map(map), drive, part).view(None)
}

fn session(drive: &SimulatedRun) -> Session {
    Session::begin(recorder(drive), &["can0".to_owned()], false, None).unwrap()
}

/// Returns a session after this part of the drive.
fn driven(mut session: Session, drive: &SimulatedRun, part: f64) -> Session {
    let frames = (drive.frames.len() as f64 * part) as usize;
    for timed in &drive.frames[..frames] {
        let item = ReceivedItem::Frame(timed.frame);
        let received = Received {
            interface: 0,
            time: timed.time,
            item,
        };
        session.take(&received).unwrap();
    }
    session
}

#[test]
fn the_view_has_the_map_and_the_road_ahead() {
    let drive = run(&[MILD, A]);
    let map = map_of(&drive);
    let without = view_at(&drive, None, 0.5);
    assert!(without.road.is_none() && json(&without)["map"].is_null());
    let view = view_at(&drive, Some(map), 0.5);
    let road = view.road.as_ref().unwrap();
    assert_eq!(road.state, RoadState::On);
    // The filter does not see the map; what is shown is combined with it.
    let own = without.live.unwrap().estimate.grade_percent;
    assert_eq!(road.own_percent, Some(own));
    let shown = view.live.unwrap().estimate.grade_percent;
    assert!(shown.sigma < own.sigma);
    let map_percent = road.map_percent.unwrap();
    let low = own.value.min(map_percent.value);
    assert!((low..=own.value.max(map_percent.value)).contains(&shown.value));
    assert_eq!(road.ahead_percent.len(), 81);
    assert!(road.ahead_percent.iter().all(Option::is_some));

    let value = json(&view);
    assert_eq!(value["map"]["state"], "on");
    assert_eq!(value["map"]["ahead"].as_array().unwrap().len(), 81);
    assert_eq!(value["map"]["ahead"][80]["ahead_m"], 2_000.0);
    assert_eq!(
        value["grade_percent"]["value"],
        serde_json::json!(shown.value)
    );
    let line = line(&view);
    let words: Vec<&str> = line.split_whitespace().rev().take(2).collect();
    assert_eq!(words, [format!("{:+.3}", map_percent.value).as_str(), "on"]);
    assert_eq!(line.len(), header().len());
}

#[test]
fn a_road_memory_learns_a_drive_and_knows_the_next() {
    let drive = run(&[MILD, A]);
    let folder = tempfile::tempdir().unwrap();
    let file = folder.path().join("roads.memory");
    let memory = flash_image::open(&file, None).unwrap();
    let first = driven(session(&drive).with_memory(Some(memory)), &drive, 1.0);
    let (run, _) = first.finish();
    let learned = run.unwrap().memory.expect("a memory").memory;
    flash_image::stage(&file, &learned)
        .unwrap()
        .commit()
        .unwrap();

    let without = driven(session(&drive), &drive, 0.5).view(None);
    // The controller of the vehicle may have been off between the drives, or not.
    let opened = flash_image::open(&file, None).unwrap();
    let [mut second, _] = [opened, learned].map(|memory| {
        let second = driven(session(&drive).with_memory(Some(memory)), &drive, 0.5);
        let known = second.memory().unwrap().counters().cells_fused;
        assert!(known > 400, "{known} cells");
        second
    });
    let view = second.view(None);
    let known = view.memory.unwrap().grade_percent.expect("a known road");
    let [with, without] = [&view, &without].map(|view| view.live.unwrap().estimate.grade_percent);
    assert!(with.sigma < without.sigma);
    let value = json(&view);
    assert_eq!(
        value["memory"]["grade_percent"]["value"],
        serde_json::json!(known.value)
    );
    assert!(value["memory"]["new_km"].as_f64().unwrap() < 0.1);
    assert!(value["memory"]["known_km"].as_f64().unwrap() > 1.0);
    assert_eq!(
        value["grade_percent"]["value"],
        serde_json::json!(with.value)
    );
    assert!(panel(&view).contains("km known before, 0.0 km new"));
}

/// PCC1 of another device is compared with our grade, and does not change it.
#[test]
fn the_grade_of_another_device_is_compared() {
    let drive = run(&[MILD, A]);
    let finish = |pcc1: Option<[u8; 8]>| {
        let mut recorder = recorder(&drive);
        for (number, timed) in drive.frames.iter().enumerate() {
            recorder.on_frame(timed);
            if let Some(data) = pcc1.filter(|_| number % 100 == 0) {
                let frame = CanFrame::extended(0x18F0_D32A, &data).unwrap();
                let time = timed.time;
                recorder.on_frame(&TimedFrame { time, frame });
            }
        }
        recorder.end().unwrap()
    };
    let summary = |mut run: LongRun| {
        let summary = RunSummary::new(&mut run).unwrap();
        (
            serde_json::to_value(&summary).unwrap(),
            summary.table().to_string(),
        )
    };
    let rows = |run: LongRun| run.in_memory().unwrap().rows;
    let with = |raw: u8| Some([0xFF, 0xFF, 0xFF, raw, 0xFF, 0xFF, 0xFF, 0xFF]);
    let (alone, text) = summary(finish(None));
    assert!(alone["roadway_grade"].is_null() && !text.contains("PCC1"));
    // "Not available" is nothing to compare with.
    assert!(summary(finish(with(0xFF))).0["roadway_grade"].is_null());
    let (value, text) = summary(finish(with(152)));
    assert!(text.contains("PCC1 less live grade"), "{text}");
    let found = &value["roadway_grade"];
    assert!(found["readings"].as_u64().unwrap() > 500);
    let mean_percent = found["mean_difference_percent"].as_f64().unwrap();
    // Always 3 %, on a road that has 0 % in the mean.
    assert!((mean_percent - 3.0).abs() < 0.5, "{mean_percent}");
    assert!(found["rms_difference_percent"].as_f64().unwrap() > mean_percent);
    assert_eq!(rows(finish(with(152))), rows(finish(None)));
}

#[test]
fn the_road_ends_where_the_map_ends() {
    let drive = run(&[MILD, A]);
    let view = view_at(&drive, Some(map_of(&drive)), 0.8);
    let road = view.road.as_ref().unwrap();
    let known = road.ahead_percent.iter().flatten().count();
    assert!((20..60).contains(&known), "{known} steps are known");
    assert!(road.ahead_percent[known..].iter().all(Option::is_none));
    let ahead = json(&view)["map"]["ahead"].as_array().unwrap().len();
    assert_eq!(ahead, known);
}

/// A road that climbs by 3 % for a kilometre, and falls by 1 % behind.
fn hill() -> RoadView {
    let grade = |index: i32| Uncertain {
        value: if index < 40 { 3.0 } else { -1.0 },
        sigma: 0.04,
    };
    RoadView {
        state: RoadState::On,
        map_percent: Some(grade(0)),
        own_percent: Some(Uncertain {
            value: 2.9,
            sigma: 0.1,
        }),
        ahead_percent: (0..=80).map(|index| Some(grade(index))).collect(),
        forks: vec![Fork {
            from_m: 640.0,
            probability: 0.1,
        }],
        counters: MapCounters::default(),
    }
}

fn panel_of(road: RoadView) -> Vec<String> {
    let drive = run(&[MILD, A]);
    let mut view = view_at(&drive, None, 0.1);
    view.road = Some(road);
    let lines: Vec<String> = panel(&view).lines().map(str::to_owned).collect();
    let first = lines
        .iter()
        .position(|line| line.starts_with("map "))
        .unwrap();
    let last = lines
        .iter()
        .position(|line| line.starts_with("cells "))
        .unwrap();
    lines[first..last].to_vec()
}

#[test]
fn the_panel_draws_the_road_ahead() {
    let lines = panel_of(hill());
    println!("{}", lines.join("\n"));
    assert_eq!(
        lines[0],
        "map       on the map   map +3.00 % ± 0.04   without +2.90 % ± 0.10"
    );
    // Four lines of 80 steps: 30 m up, then 10 m down.
    let skyline: Vec<Vec<char>> = lines[1..5]
        .iter()
        .map(|line| line.chars().skip(13).collect())
        .collect();
    assert!(lines[1].starts_with("ahead  +30 m ") && lines[4].starts_with("        +0 m "));
    assert!(skyline.iter().all(|line| line.len() == 80));
    let height = |step: usize| skyline.iter().filter(|line| line[step] != ' ').count();
    assert_eq!((height(0), height(39), height(79)), (1, 4, 3));
    assert_eq!(skyline[0][39], '█');
    assert!((1..39).all(|step| height(step) >= height(step - 1)));
    assert!(
        lines[5]
            .trim_start()
            .starts_with("0 m       250 m     500 m")
    );
    assert!(
        lines[6]
            .trim_start()
            .starts_with("+3.0 %    +3.0 %    +3.0 %    +3.0 %    -1.0 %")
    );
    assert_eq!(lines[7], "fork      in 640 m, taken with 10 %");
    assert!(lines.iter().all(|line| line.chars().count() < 100));
}

#[test]
fn a_map_that_does_not_count_is_named_and_not_drawn() {
    for (state, words) in [
        (RoadState::LeftOut, "left out: it differs from the estimate"),
        (RoadState::Unclear, "place not clear"),
        (RoadState::Off, "not on the map"),
    ] {
        let road = RoadView {
            state,
            map_percent: None,
            own_percent: None,
            ahead_percent: Vec::new(),
            forks: Vec::new(),
            ..hill()
        };
        assert_eq!(panel_of(road), [format!("map       {words}")]);
    }
    // A gap of the map is empty, a flat road is not.
    let mut road = hill();
    road.ahead_percent = vec![Some(Uncertain::default()); 81];
    road.ahead_percent[20..41].fill(None);
    let lines = panel_of(road);
    let lowest: Vec<char> = lines[4].chars().skip(13).collect();
    assert_eq!((lowest[10], lowest[30], lowest[60]), ('▁', ' ', '▁'));
    assert!(lines[1].starts_with("ahead  +10 m "));
}
