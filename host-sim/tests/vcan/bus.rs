//! Virtual interfaces.

use std::fs;
use std::process::Command;
use std::thread;
use std::time::{Duration, Instant};

/// Longest wait for another process. It only bounds the time of a hanging test.
pub const PATIENCE: Duration = Duration::from_secs(60);

/// A virtual interface that is up. It is removed when the value is dropped.
pub struct Vcan(pub &'static str);

impl Vcan {
    pub fn new(name: &'static str) -> Self {
        let vcan = Self(name);
        vcan.add();
        vcan
    }

    pub fn add(&self) {
        ip(&["link", "add", "dev", self.0, "type", "vcan"]);
        self.up();
    }

    pub fn up(&self) {
        ip(&["link", "set", self.0, "up"]);
    }

    pub fn down(&self) {
        ip(&["link", "set", self.0, "down"]);
    }

    pub fn remove(&self) {
        ip(&["link", "del", "dev", self.0]);
    }

    /// Returns the number of frames that the kernel dropped between the interface and the sockets.
    pub fn rx_dropped(&self) -> u64 {
        let file = format!("/sys/class/net/{}/statistics/rx_dropped", self.0);
        fs::read_to_string(file).unwrap().trim().parse().unwrap()
    }

    /// Waits until candump listens, to all frames or to some.
    pub fn wait_for_candump(&self) {
        wait_until("candump listens", || {
            ["all", "fil"].iter().any(|list| {
                let list = format!("/proc/net/can/rcvlist_{list}");
                let listeners = fs::read_to_string(list).unwrap();
                listeners
                    .lines()
                    .any(|line| line.trim_start().starts_with(self.0))
            })
        });
    }
}

impl Drop for Vcan {
    fn drop(&mut self) {
        // A test may have removed it.
        let _ = Command::new("ip")
            .args(["link", "del", "dev", self.0])
            .output();
    }
}

pub fn ip(args: &[&str]) {
    let output = Command::new("ip").args(args).output().unwrap();
    assert!(output.status.success(), "ip {args:?}: {output:?}");
}

pub fn wait_until(what: &str, mut is_so: impl FnMut() -> bool) {
    let begun = Instant::now();
    while !is_so() {
        assert!(begun.elapsed() < PATIENCE, "timeout: not yet {what}");
        thread::sleep(Duration::from_millis(10));
    }
}
