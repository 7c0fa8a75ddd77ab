//! The work of a host on a drive: 40 km of motorway, half an hour of a full bus.

use estimator_core::estimator::CellEstimator;
use estimator_core::sample::Sample;
use estimator_core::{Context, Decoder, Estimator, Model, Scalar, Tuning};
use flate2::Compression;
use flate2::write::GzEncoder;
use host_sim::error::Result;
use host_sim::files::run::{self, RunRow};
use host_sim::map::{GradeMap, Network, RoadLine, RoadPoint, SessionRun, place, road_of_run};
use host_sim::recorder::{Recorder, estimate_log};
use host_sim::simulator::scenario::Scenario;
use host_sim::simulator::simulate;
use host_sim::smooth::{Known, smooth_run};
use host_sim::source::can_frame::TimedFrame;
use host_sim::source::candump_writer::write_frame;
use host_sim::source::frame_log::FrameLog;
use host_sim::source::read_options::ReadOptions;
use std::fs::{self, File};
use std::hint::black_box;
use std::io::{BufWriter, Write};
use std::path::{Path, PathBuf};
use tempfile::TempDir;

/// Bytes that are copied to measure the speed of memory; more than any cache holds.
const COPIED: usize = 256 << 20;
/// Number of runs that are fused.
const RUNS: usize = 8;

/// A drive, in memory and on disk.
pub struct Work {
    folder: TempDir,
    frames: Vec<TimedFrame>,
    model: Model,
    samples: Vec<Sample>,
    rows: Vec<RunRow>,
    road: Vec<RoadPoint>,
}

/// One kind of work on a drive.
pub struct Job<'a> {
    /// Its name.
    pub name: &'static str,
    /// Unit of work.
    pub unit: &'static str,
    /// Number of units in one call of `run`.
    pub units: usize,
    /// Does it.
    pub run: Box<dyn FnMut() + 'a>,
}

impl Work {
    /// Simulates the drive.
    ///
    /// # Errors
    /// Returns the error of the file system.
    pub fn prepare() -> Result<Self> {
        let text = include_str!("../../../host-sim/scenarios/motorway.toml");
        let run = simulate(&Scenario::parse(text, Path::new("motorway"))?, 0)?;
        let model = run.vehicle.model.clone();
        let mut recorder = Recorder::<f32>::new(model.clone(), Tuning::default())
            .expect("the simulator checked the vehicle");
        for frame in &run.frames {
            recorder.on_frame(frame);
        }
        let (estimated, samples) = recorder.finish_with_samples()?;
        let work = Self {
            folder: TempDir::new().expect("room for a log"),
            frames: run.frames,
            model,
            samples,
            road: road_of_run(&estimated.rows).expect("the drive has positions"),
            rows: estimated.rows,
        };
        work.write().expect("room for a log");
        run::write(&work.run(), &work.rows)?;
        Ok(work)
    }

    fn write(&self) -> std::io::Result<()> {
        let mut log = BufWriter::new(File::create(self.log())?);
        for frame in &self.frames {
            write_frame(&mut log, frame, "can0")?;
        }
        log.flush()?;
        let mut packed = GzEncoder::new(File::create(self.packed_log())?, Compression::default());
        packed.write_all(&fs::read(self.log())?)?;
        packed.finish()?;
        Ok(())
    }

    /// Returns the log.
    #[must_use]
    pub fn log(&self) -> PathBuf {
        self.folder.path().join("drive.log")
    }

    fn packed_log(&self) -> PathBuf {
        self.folder.path().join("drive.log.gz")
    }

    fn run(&self) -> PathBuf {
        self.folder.path().join("run.parquet")
    }

    /// Returns number of frames in the log.
    #[must_use]
    pub fn frames(&self) -> usize {
        self.frames.len()
    }

    /// Returns all kinds of work.
    #[must_use]
    pub fn jobs(&self) -> Vec<Job<'_>> {
        let (frames, cells) = (self.frames.len(), self.samples.len());
        let job = |name, unit, units, run| Job {
            name,
            unit,
            units,
            run,
        };
        let mut copies = (vec![1_u8; COPIED], vec![0_u8; COPIED]);
        vec![
            job(
                "log read",
                "frame",
                frames,
                self.boxed(|w| w.read(&w.log())),
            ),
            job(
                "log read, gzip",
                "frame",
                frames,
                self.boxed(|w| w.read(&w.packed_log())),
            ),
            job("frame decode", "frame", frames, self.boxed(Self::decode)),
            job(
                "log read and decode",
                "frame",
                frames,
                self.boxed(Self::read_and_decode),
            ),
            job(
                "estimate live and lagged",
                "frame",
                frames,
                self.boxed(Self::estimate),
            ),
            job(
                "estimate of a log",
                "frame",
                frames,
                self.boxed(Self::estimate_log),
            ),
            job(
                "filter step in a drive, f32",
                "cell",
                cells,
                self.boxed(Self::filter::<f32>),
            ),
            job(
                "filter step in a drive, f64",
                "cell",
                cells,
                self.boxed(Self::filter::<f64>),
            ),
            job(
                "whole-run smoothing",
                "cell",
                cells,
                self.boxed(Self::smooth),
            ),
            job(
                "simulate, estimate, fuse 10 km",
                "run",
                1,
                self.boxed(|_| simulate_and_fuse()),
            ),
            job(
                "fuse from Parquet",
                "cell",
                RUNS * self.rows.len(),
                self.boxed(Self::fuse),
            ),
            job(
                "copy of memory",
                "byte",
                COPIED,
                Box::new(move || {
                    copies.1.copy_from_slice(black_box(&copies.0));
                    black_box(&copies.1);
                }),
            ),
        ]
    }

    fn boxed<'a>(&'a self, run: impl Fn(&Self) + 'a) -> Box<dyn FnMut() + 'a> {
        Box::new(move || run(self))
    }

    fn read(&self, log: &Path) {
        let mut reader = FrameLog::open_candump(log).expect("it was written");
        while let Some(frame) = reader.next_frame().expect("a whole log") {
            black_box(&frame);
        }
    }

    fn decode(&self) {
        let mut decoder = Decoder::new();
        for timed in &self.frames {
            decoder.decode(&timed.frame, |_, _, reading| {
                black_box(&reading);
            });
        }
    }

    fn read_and_decode(&self) {
        let mut reader = FrameLog::open_candump(&self.log()).expect("it was written");
        let mut decoder = Decoder::new();
        while let Some(timed) = reader.next_frame().expect("a whole log") {
            decoder.decode(&timed.frame, |_, _, reading| {
                black_box(&reading);
            });
        }
    }

    fn estimate(&self) {
        let mut estimator = Estimator::<f32>::new(self.model.clone(), Tuning::default())
            .expect("the simulator checked the vehicle");
        for timed in &self.frames {
            estimator.on_frame(timed.time, &timed.frame);
            while estimator.step().is_some() {}
            while let Some(cell) = estimator.next_cell() {
                black_box(&cell);
            }
        }
    }

    fn estimate_log(&self) {
        let run = estimate_log::<f32>(
            &self.model,
            &Tuning::default(),
            None,
            &self.log(),
            &ReadOptions::default(),
            |_| (),
        );
        black_box(run.expect("a whole log").rows.count());
    }

    fn filter<S: Scalar>(&self) {
        let mut context = Context::new(self.model.clone(), Tuning::default())
            .expect("the simulator checked the vehicle");
        let mut estimator = CellEstimator::<S>::new().without_inference();
        for sample in &self.samples {
            black_box(estimator.push(&mut context, sample));
        }
    }

    fn smooth(&self) {
        let context = Context::new(self.model.clone(), Tuning::default())
            .expect("the simulator checked the vehicle");
        black_box(smooth_run(&context, Known::default(), &self.samples));
    }

    fn fuse(&self) {
        let road: Network = RoadLine::new(self.road.clone())
            .expect("the run is a road")
            .into();
        let mut map = GradeMap::new(&road);
        for _ in 0..RUNS {
            let (cells, _) = run::read_cells(&self.run()).expect("it was written");
            map.add_placed(None, &place(&road, &cells));
        }
        black_box(map.fused());
    }
}

/// Simulates, estimates and fuses one run of the demonstration.
fn simulate_and_fuse() {
    let run = simulate(&Scenario::builtin(), 0).expect("a scenario of our own");
    let mut recorder = Recorder::<f32>::new(run.vehicle.model.clone(), Tuning::default())
        .expect("the simulator checked the vehicle");
    for frame in &run.frames {
        recorder.on_frame(frame);
    }
    let rows = recorder.finish().expect("it fits into memory").rows;
    let road: Network = RoadLine::new(road_of_run(&rows).expect("it has positions"))
        .expect("a road")
        .into();
    let mut map = GradeMap::new(&road);
    map.add_run(&SessionRun {
        session: None,
        rows: &rows,
    });
    black_box(map.fused());
}
