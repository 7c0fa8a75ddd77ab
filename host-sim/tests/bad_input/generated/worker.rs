//! Processes that run cases. An abort, a hang or a lack of memory ends the process, and a new one
//! goes on behind that case.

use super::case::{self, End, files_below};
use super::commands::Case;
use rayon::prelude::*;
use std::fs::{self, File};
use std::ops::Range;
use std::path::Path;
use std::process::{Command, ExitStatus};
use std::sync::mpsc;
use std::time::{Duration, Instant};
use tempfile::TempDir;
use wait4::Wait4;

/// Cases of one process.
const BLOCK: usize = 500;
/// Longest time of a case.
const LONGEST: Duration = Duration::from_secs(10);
/// Address space of a process: what a command may use, the test itself, and the stacks of threads.
const ADDRESSES: &str = "--as=805306368";
/// Stack of the main thread of a program.
const STACK_BYTES: usize = 8 << 20;
/// Lines of the output of a process: the case that begins, and what is wrong with it.
const BEGIN: &str = "@@begin ";
const WRONG: &str = "@@wrong ";
const DONE: &str = "@@done";
const TIME: &str = "@@time ";

/// What was found.
#[derive(Default)]
pub struct Found {
    pub cases: usize,
    /// Cases that end with a result.
    pub done: usize,
    /// What is wrong, with seeds and command lines.
    pub wrong: Vec<String>,
    /// Peak of resident memory of a process that runs hundreds of cases.
    pub peak_kb: u64,
    pub longest: Duration,
}

impl Found {
    pub fn summary(&self) -> String {
        format!(
            "bad inputs: {} cases, {} of them done, {} wrong, at most {} MB and {:.1} s",
            self.cases,
            self.done,
            self.wrong.len(),
            self.peak_kb / 1024,
            self.longest.as_secs_f64()
        )
    }

    fn and(mut self, other: Self) -> Self {
        self.cases += other.cases;
        self.done += other.done;
        self.wrong.extend(other.wrong);
        self.peak_kb = self.peak_kb.max(other.peak_kb);
        self.longest = self.longest.max(other.longest);
        self
    }
}

/// Runs all cases, in as many processes at once as there are processors.
pub fn run_all(good: &Path, seeds: Range<u64>) -> Found {
    let blocks: Vec<Range<u64>> = seeds
        .clone()
        .step_by(BLOCK)
        .map(|first| first..seeds.end.min(first + BLOCK as u64))
        .collect();
    let found = blocks.into_par_iter().map(|seeds| run_block(good, seeds));
    found.reduce(Found::default, Found::and)
}

/// Runs cases in a process, and in another one where it ends too early.
fn run_block(good: &Path, mut seeds: Range<u64>) -> Found {
    let mut found = Found::default();
    while !seeds.is_empty() {
        let folder = TempDir::new().unwrap();
        let log = folder.path().join("log");
        let (status, peak_kb) = start(good, &seeds, folder.path(), &log);
        let output = fs::read(&log).unwrap();
        let last = found.read(&String::from_utf8_lossy(&output));
        found.peak_kb = found.peak_kb.max(peak_kb);
        let Some(last) = last else {
            panic!("no case began: {}", String::from_utf8_lossy(&output));
        };
        if status.success() {
            break;
        }
        found.wrong.push(format!("seed {last}: {status}"));
        seeds.start = last + 1;
    }
    found
}

/// Runs the worker; returns its status and its peak of memory.
fn start(good: &Path, seeds: &Range<u64>, folder: &Path, log: &Path) -> (ExitStatus, u64) {
    let output = File::create(log).unwrap();
    let child = Command::new("prlimit")
        .arg(ADDRESSES)
        .arg(std::env::current_exe().unwrap())
        .args(["--exact", "generated::worker", "--ignored", "--nocapture"])
        .env("BAD_INPUT_WORK", format!("{} {}", seeds.start, seeds.end))
        .env("BAD_INPUT_GOOD", good)
        .env("RAYON_NUM_THREADS", "2")
        .env("TMPDIR", folder)
        .stdout(output.try_clone().unwrap())
        .stderr(output)
        .spawn()
        .expect("prlimit, of util-linux");
    let used = child.wait4().unwrap();
    (used.status, used.rusage.maxrss / 1024)
}

impl Found {
    /// Takes the output of a process; returns the last case that began.
    fn read(&mut self, output: &str) -> Option<u64> {
        let mut last = None;
        let mut begin = "";
        for line in output.lines() {
            if let Some(case) = line.strip_prefix(BEGIN) {
                begin = case;
                last = case.split(' ').next().and_then(|seed| seed.parse().ok());
                self.cases += 1;
            } else if let Some(seconds) = line.strip_prefix(TIME) {
                let seconds: f64 = seconds.parse().unwrap();
                self.longest = self.longest.max(Duration::from_secs_f64(seconds));
            } else if line == DONE {
                self.done += 1;
            } else if let Some(wrong) = line.strip_prefix(WRONG) {
                self.wrong.push(format!("seed {begin}: {wrong}"));
            } else if line.contains("panicked") || line.contains(is_no_text) {
                self.wrong.push(format!("seed {begin}: said {line:?}"));
            }
        }
        last
    }
}

/// Returns true for characters that a message must not have.
fn is_no_text(c: char) -> bool {
    c.is_control() && c != '\t'
}

/// Runs the cases that the parent asks for.
pub fn run_here() {
    let (Ok(work), Ok(good)) = (
        std::env::var("BAD_INPUT_WORK"),
        std::env::var("BAD_INPUT_GOOD"),
    ) else {
        return;
    };
    let (first, end) = work.split_once(' ').unwrap();
    let seeds: Range<u64> = first.parse().unwrap()..end.parse().unwrap();
    let watch = Watch::start();
    let cases = move || run_cases(Path::new(&good), seeds, &watch);
    let thread = std::thread::Builder::new().stack_size(STACK_BYTES);
    thread.spawn(cases).unwrap().join().unwrap();
}

fn run_cases(good: &Path, seeds: Range<u64>, watch: &Watch) {
    let files = files_below(good);
    for seed in seeds {
        let folder = TempDir::new().unwrap();
        let mut case = Case::draw(seed, &files);
        case::lay_out(&mut case, good, &files, folder.path());
        std::env::set_current_dir(folder.path()).unwrap();
        eprintln!("{BEGIN}{seed} {:?} {:?}", case.words, case.damaged);
        let begun = Instant::now();
        watch.begin();
        let result = case::run(&case);
        watch.end();
        match result {
            Ok(End::Done) => eprintln!("{DONE}"),
            Ok(End::Refused | End::WrongUsage) => {}
            Err(wrong) => {
                eprintln!("{WRONG}{}", wrong.escape_debug());
                keep(folder.path(), case.seed);
            }
        }
        eprintln!("{TIME}{:.3}", begun.elapsed().as_secs_f64());
    }
}

fn keep(folder: &Path, seed: u64) {
    let Ok(kept) = std::env::var("BAD_INPUT_KEEP") else {
        return;
    };
    let to = Path::new(&kept).join(seed.to_string());
    let copied = Command::new("cp").arg("-r").arg(folder).arg(to).status();
    assert!(copied.is_ok_and(|status| status.success()));
}

/// Ends the process if a case takes too long.
struct Watch(mpsc::Sender<bool>);

impl Watch {
    fn start() -> Self {
        let (sender, receiver) = mpsc::channel();
        std::thread::spawn(move || {
            while let Ok(is_begin) = receiver.recv() {
                if is_begin
                    && receiver.recv_timeout(LONGEST) == Err(mpsc::RecvTimeoutError::Timeout)
                {
                    eprintln!("{WRONG}more than {} s", LONGEST.as_secs());
                    std::process::exit(124);
                }
            }
        });
        Self(sender)
    }

    fn begin(&self) {
        self.0.send(true).unwrap();
    }

    fn end(&self) {
        self.0.send(false).unwrap();
    }
}
