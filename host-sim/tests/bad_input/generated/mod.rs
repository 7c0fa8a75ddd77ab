//! Good files, damaged or mistaken at random, in every command: an error or a result, never a
//! panic, a hang, all memory, half a file or a number that is none.
//!
//! `BAD_INPUT_CASES` is the number of cases, `BAD_INPUT_SEED` the first seed; each case has its own,
//! which a failure names. `BAD_INPUT_KEEP` is a folder for the files of cases that fail.

mod case;
mod commands;
mod damage;
pub mod good;
mod worker;

fn setting(name: &str, default: u64) -> u64 {
    std::env::var(name).map_or(default, |text| text.parse().expect(name))
}

#[test]
fn bad_inputs_end_in_an_error_or_in_numbers() {
    let good = good::files();
    let first = setting("BAD_INPUT_SEED", 1);
    let cases = setting("BAD_INPUT_CASES", 2_000);
    let found = worker::run_all(good.path(), first..first + cases);
    println!("{}", found.summary());
    assert!(
        found.wrong.is_empty(),
        "{} of {cases}:\n{}",
        found.wrong.len(),
        found.wrong.join("\n")
    );
    assert!(
        found.peak_kb <= crate::shell::MEMORY_BYTES / 1024,
        "{} kB",
        found.peak_kb
    );
}

/// What is damaged must have been good.
#[test]
fn good_files_end_in_results() {
    let mut wrong = Vec::new();
    for command in commands::COMMANDS {
        let good = good::files();
        let words: Vec<&str> = command.split(' ').collect();
        let output = crate::shell::limited(good.path(), &words);
        let message = crate::shell::stderr(&output);
        let is_wrong = match command.contains("no_such_0") {
            true => !message.contains("no_such_0"),
            false => !output.status.success(),
        };
        if is_wrong {
            wrong.push(format!("{command}: {}: {message}", output.status));
        }
    }
    assert!(wrong.is_empty(), "{}", wrong.join("\n"));
}

/// Runs cases in a process of its own, which an abort or a hang may end.
#[test]
#[ignore = "part of the test beside"]
fn worker() {
    worker::run_here();
}
