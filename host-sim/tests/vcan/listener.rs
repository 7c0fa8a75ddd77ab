//! `roadgrade listen` while it runs.

use crate::bus::PATIENCE;
use crate::drive::VcanDrive;
use crate::roadgrade;
use serde_json::Value;
use std::io::{BufRead, BufReader, Read};
use std::process::{Child, Command, Stdio};
use std::sync::mpsc::{Receiver, channel};
use std::thread::{self, JoinHandle};

/// Returns the command `roadgrade listen` that writes live.csv and ends after this silence.
pub fn until_silent(drive: &VcanDrive, interface: &str, silence_s: &str) -> assert_cmd::Command {
    let mut command = roadgrade();
    command
        .args(["listen", "--can", interface])
        .args(["--end-after-silence", silence_s, "--vehicle"])
        .arg(drive.vehicle())
        .arg("--out")
        .arg(drive.file("live.csv"));
    command
}

/// A running listener.
pub struct Listener {
    child: Child,
    /// Its messages so far.
    pub said: Vec<String>,
    messages: Receiver<String>,
    results: JoinHandle<String>,
}

/// The output of a finished listener.
pub struct ListenerOutput {
    /// The last line of its JSON: summary and interfaces.
    pub end: Value,
    /// The lines before the last one.
    pub lines: Vec<Value>,
    pub said: Vec<String>,
}

impl ListenerOutput {
    pub fn frames(&self, interface: usize) -> u64 {
        self.end["interfaces"][interface]["frames"]
            .as_u64()
            .unwrap()
    }

    pub fn lost(&self, interface: usize) -> u64 {
        self.end["interfaces"][interface]["lost"].as_u64().unwrap()
    }

    pub fn event(&self, interface: usize, name: &str) -> u64 {
        let events = &self.end["interfaces"][interface]["events"];
        events[name].as_u64().unwrap_or(0)
    }

    /// Returns a counter of the core by its words.
    pub fn counted(&self, words: &str) -> u64 {
        let counts = self.end["summary"]["events"].as_array().unwrap();
        let count = counts.iter().find(|count| count[0] == words);
        count.map_or(0, |count| count[1].as_u64().unwrap())
    }
}

impl Listener {
    /// Starts a listener. Returns when its interfaces are open.
    pub fn start(drive: &VcanDrive, interfaces: &[&str], options: &[&str]) -> Self {
        let mut command = Command::new(env!("CARGO_BIN_EXE_roadgrade"));
        command
            .args(["listen", "--json", "--vehicle"])
            .arg(drive.vehicle());
        for interface in interfaces {
            command.args(["--can", interface]);
        }
        let mut child = command
            .args(options)
            .current_dir(drive.file("").as_path())
            .stdin(Stdio::null())
            .stdout(Stdio::piped())
            .stderr(Stdio::piped())
            .spawn()
            .unwrap();
        let (sink, messages) = channel();
        let stderr = BufReader::new(child.stderr.take().unwrap());
        thread::spawn(move || {
            for line in stderr.lines().map_while(Result::ok) {
                if sink.send(line).is_err() {
                    break;
                }
            }
        });
        let mut stdout = child.stdout.take().unwrap();
        let results = thread::spawn(move || {
            let mut text = String::new();
            stdout.read_to_string(&mut text).unwrap();
            text
        });
        let mut listener = Self {
            child,
            said: Vec::new(),
            messages,
            results,
        };
        listener.wait_for("listening on");
        listener
    }

    /// Waits until it prints a message with these words.
    pub fn wait_for(&mut self, words: &str) {
        loop {
            let Ok(message) = self.messages.recv_timeout(PATIENCE) else {
                panic!("timeout: no message with {words:?} among {:?}", self.said);
            };
            let is_it = message.contains(words);
            self.said.push(message);
            if is_it {
                return;
            }
        }
    }

    /// Sends a signal to the process.
    pub fn signal(&self, name: &str) {
        let id = self.child.id().to_string();
        let signal = format!("-{name}");
        assert!(
            Command::new("kill")
                .args([&signal, &id])
                .status()
                .unwrap()
                .success()
        );
    }

    /// Waits until it ends, and checks that it succeeds.
    pub fn finish(mut self) -> ListenerOutput {
        let status = self.child.wait().unwrap();
        self.said.extend(self.messages.iter());
        assert!(status.success(), "{status}: {:?}", self.said);
        let text = self.results.join().unwrap();
        let mut lines: Vec<Value> = text
            .lines()
            .map(|line| serde_json::from_str(line).unwrap())
            .collect();
        ListenerOutput {
            end: lines.pop().expect("a summary"),
            lines,
            said: self.said,
        }
    }
}
