//! Commands in pages exist, with their options.

use super::{pages, place, root};
use cargo_metadata::MetadataCommand;
use clap::{Command, CommandFactory};
use host_sim::cli::Cli;

#[test]
fn commands_and_their_options_exist() {
    let mut problems = Vec::new();
    let mut count = 0;
    for page in pages() {
        let inline = page.code.iter().map(|(line, code)| (*line, code.clone()));
        let blocks = page.blocks.iter().flat_map(|(first, block)| {
            let lines = block.lines().map(str::to_owned);
            (*first..).zip(lines)
        });
        for (line, text) in inline.chain(blocks) {
            for command in commands(&text) {
                count += 1;
                if let Err(problem) = check(&command) {
                    problems.push(format!(
                        "{}: `{}`: {problem}",
                        place(&page.path, line),
                        text
                    ));
                }
            }
        }
    }
    assert!(count > 60, "{count} commands");
    assert!(problems.is_empty(), "{}", problems.join("\n"));
}

/// Where there are two programs, `cargo run -- COMMAND` at the root does not know which one is meant.
#[test]
fn cargo_run_at_the_root_finds_the_one_program() {
    let metadata = MetadataCommand::new()
        .manifest_path(root().join("Cargo.toml"))
        .no_deps()
        .exec()
        .unwrap();
    let programs: Vec<&str> = metadata
        .workspace_default_packages()
        .into_iter()
        .flat_map(|package| &package.targets)
        .filter(|target| target.is_bin())
        .map(|target| target.name.as_str())
        .collect();
    assert_eq!(programs, ["roadgrade"]);
}

/// Returns this project's commands in a line of shell, as words.
fn commands(line: &str) -> Vec<Vec<String>> {
    let code = line.split(" #").next().unwrap_or(line);
    let code = code.trim().trim_start_matches('(').trim_end_matches(')');
    code.split("&&")
        .flat_map(|part| part.split(['&', '|', ';']))
        .map(|part| part.split_whitespace().map(str::to_owned).collect())
        .filter(|words: &Vec<String>| match words.as_slice() {
            [program, argument, ..] if program == "roadgrade" => !argument.starts_with('…'),
            [cargo, run, _, ..] => cargo == "cargo" && run == "run",
            _ => false,
        })
        .collect()
}

fn check(words: &[String]) -> Result<(), String> {
    if words[0] == "roadgrade" {
        return check_roadgrade(&words[1..]);
    }
    let split = words.iter().position(|word| word == "--");
    let (cargo, arguments) = words.split_at(split.unwrap_or(words.len()));
    let arguments = arguments.get(1..).unwrap_or_default();
    let after = |option: &str| {
        let at = cargo.iter().position(|word| word == option)?;
        cargo.get(at + 1)
    };
    match (after("--example"), after("-p")) {
        (Some(example), package) => {
            let folder = match package.map(String::as_str) {
                Some("cross-tests") => "tests",
                Some(package) => package,
                None => return Err("expected the package of the example".to_owned()),
            };
            let source = [".rs", "/main.rs"].into_iter().find_map(|ending| {
                let file = root().join(format!("{folder}/examples/{example}{ending}"));
                std::fs::read_to_string(file).ok()
            });
            let source = source.ok_or("no such example")?;
            let options = arguments.iter().filter_map(|word| word.strip_prefix("--"));
            for option in options {
                // As a field of the options, or read by hand.
                let field = option.replace('-', "_");
                if !source.contains(&field) && !source.contains(option) {
                    return Err(format!("no option --{option}"));
                }
            }
            Ok(())
        }
        (None, None) if !arguments.is_empty() => check_roadgrade(arguments),
        (None, _) => Ok(()),
    }
}

fn check_roadgrade(arguments: &[String]) -> Result<(), String> {
    let cli = Cli::command();
    let mut command = &cli;
    let mut arguments = arguments.iter().peekable();
    while let Some(name) = arguments.peek() {
        if !command.has_subcommands() {
            break;
        }
        let name = name.trim_end_matches([',', ':']);
        if name.starts_with("--") || name == "COMMAND" {
            break;
        }
        command = command
            .find_subcommand(name)
            .ok_or(format!("no command {name}"))?;
        arguments.next();
    }
    let mut values_of_first = command
        .get_positionals()
        .next()
        .map(clap::Arg::get_possible_values);
    let mut after_option = false;
    for word in arguments {
        let option = word
            .trim_matches(['[', ']', ','])
            .split('=')
            .next()
            .unwrap_or(word);
        if let Some(long) = option.strip_prefix("--") {
            if !has_option(command, long) {
                return Err(format!("no option {option} of {}", command.get_name()));
            }
            after_option = true;
        } else if !after_option {
            let values = values_of_first.take().unwrap_or_default();
            let is_placeholder = word.chars().all(|of| of.is_uppercase() || of == '…');
            if !values.is_empty()
                && !is_placeholder
                && !values.iter().any(|of| of.get_name() == word)
            {
                return Err(format!("{word}: no such {}", command.get_name()));
            }
        } else {
            after_option = false;
        }
    }
    Ok(())
}

fn has_option(command: &Command, long: &str) -> bool {
    let mut options = command.get_arguments();
    ["help", "version"].contains(&long) || options.any(|option| option.get_long() == Some(long))
}

#[test]
fn a_wrong_command_is_found() {
    let check = |line: &str| check(&commands(line)[0]);
    assert_eq!(check("roadgrade demo --out x"), Ok(()));
    assert_eq!(
        check("cargo run --release -- study accuracy --out DIR"),
        Ok(())
    );
    assert_eq!(
        check("cargo run -p cross-tests --release --example docs -- --check"),
        Ok(())
    );
    assert!(check("roadgrade demmo").is_err());
    assert!(check("roadgrade demo --output x").is_err());
    assert!(check("roadgrade import i5 x").is_err());
    assert!(check("roadgrade study accurate --out DIR").is_err());
    assert!(check("cargo run --release -p cross-tests --example no -- x").is_err());
}
