//! The rules for imports: no cycle among the files of a crate, and one direction among its parts.
//! `docs/architecture.md` gives the reasons.

mod imports;

use cross_tests::image::root;
use imports::{Import, imports};
use petgraph::algo::tarjan_scc;
use petgraph::graphmap::DiGraphMap;
use std::collections::BTreeSet;

/// Crates whose files must not import each other in cycles.
const CRATES: [&str; 9] = [
    "estimator-core/src",
    "firmware/c/src",
    "firmware/src",
    "host-sim/browser/src",
    "host-sim/python/src",
    "host-sim/src",
    "tests/evidence/src",
    "tests/kit/src",
    "tests/src",
];

/// Parts of the core from top to bottom. None imports what stands above it.
const CORE: [&str; 25] = [
    "estimator",
    "broadcast",
    "persistent_state",
    "packed_vehicle",
    "roadmap",
    "inference",
    "filter",
    "intake",
    "sampler",
    "signal",
    "context",
    "model",
    "effect",
    "vehicle",
    "sample",
    "tuning",
    "counters",
    "cell",
    "delay",
    "scalar",
    "time",
    "maybe",
    "angle",
    "division",
    "word_record",
];

/// Parts of the host, and the parts that each may import. All may import `error`.
const HOST: [(&str, &[&str]); 21] = [
    (
        "cli",
        &[
            "comparison",
            "diagnose",
            "files",
            "identify",
            "inertial_judge",
            "inspect",
            "live",
            "logs_to_map",
            "map",
            "numeric",
            "recorder",
            "report",
            "score",
            "simulator",
            "smooth",
            "source",
            "study",
            "terminal",
        ],
    ),
    (
        "study",
        &[
            "comparison",
            "diagnose",
            "files",
            "inertial_judge",
            "map",
            "numeric",
            "recorder",
            "report",
            "score",
            "simulator",
            "smooth",
            "source",
            "terminal",
        ],
    ),
    (
        "diagnose",
        &[
            "files",
            "inertial_judge",
            "map",
            "numeric",
            "recorder",
            "report",
            "smooth",
            "source",
        ],
    ),
    (
        "logs_to_map",
        &["files", "identify", "map", "recorder", "report", "source"],
    ),
    ("identify", &["diagnose", "files", "numeric", "source"]),
    (
        "report",
        &[
            "files", "identify", "map", "numeric", "recorder", "score", "source",
        ],
    ),
    ("live", &["files", "recorder", "source", "terminal"]),
    // Not the simulator: measured data have a truth, too.
    (
        "score",
        &[
            "comparison",
            "files",
            "map",
            "numeric",
            "recorder",
            "source",
            "terminal",
        ],
    ),
    ("inertial_judge", &["numeric"]),
    ("inspect", &["numeric", "source"]),
    (
        "recorder",
        &["files", "numeric", "smooth", "source", "terminal"],
    ),
    ("simulator", &["files", "numeric", "source", "terminal"]),
    ("source", &["files", "numeric"]),
    ("map", &["files", "numeric", "platform", "terminal"]),
    ("comparison", &["numeric"]),
    ("files", &["numeric", "platform"]),
    ("terminal", &[]),
    ("numeric", &[]),
    ("smooth", &[]),
    ("platform", &[]),
    ("error", &["platform"]),
];

#[test]
fn no_files_import_each_other_in_a_cycle() {
    let mut problems = Vec::new();
    for folder in CRATES {
        let found = imports(&root().join(folder));
        let edges = found.iter().map(|import| (&*import.from, &*import.to));
        let graph: DiGraphMap<&str, ()> = DiGraphMap::from_edges(edges);
        for mut cycle in tarjan_scc(&graph).into_iter().filter(|of| of.len() > 1) {
            cycle.sort_unstable();
            let within =
                |import: &&Import| cycle.contains(&&*import.from) && cycle.contains(&&*import.to);
            let cycle_words = cycle.join(" ↔ ");
            problems.push(format!("{folder}: a cycle: {cycle_words}"));
            problems.extend(found.iter().filter(within).map(|of| in_words(folder, of)));
        }
    }
    assert!(problems.is_empty(), "{}", problems.join("\n"));
}

#[test]
fn no_part_of_the_core_imports_what_stands_above_it() {
    let folder = "estimator-core/src";
    let floor = |part: &str| CORE.iter().position(|of| *of == part);
    check(folder, |from, to| match (floor(from), floor(to)) {
        (Some(above), Some(below)) if above < below => None,
        (Some(_), Some(_)) => Some(format!("`{to}` stands above `{from}`")),
        (None, _) => Some(format!("`{from}` has no place in the order")),
        (_, None) => Some(format!("`{to}` has no place in the order")),
    });
}

#[test]
fn parts_of_the_host_import_only_what_they_may() {
    check("host-sim/src", |from, to| {
        let Some((_, allowed)) = HOST.iter().find(|(name, _)| *name == from) else {
            return Some(format!("`{from}` is not in the table of parts"));
        };
        let is_allowed = to == "error" || allowed.contains(&to);
        (!is_allowed).then(|| format!("`{from}` may not import `{to}`"))
    });
}

#[test]
fn parts_of_the_orders_exist() {
    let exists = |folder: &str, part: &str| {
        let path = root().join(folder).join(part);
        path.is_dir() || path.with_extension("rs").is_file()
    };
    for part in CORE {
        assert!(exists("estimator-core/src", part), "{part}");
    }
    let known: BTreeSet<&str> = HOST.iter().map(|(name, _)| *name).collect();
    for (name, allowed) in HOST {
        assert!(exists("host-sim/src", name), "{name}");
        for other in allowed {
            assert!(known.contains(other), "{name}: {other}");
        }
    }
}

#[test]
fn known_imports_are_found() {
    let found = imports(&root().join("estimator-core/src"));
    let has = |from: &str, to: &str| found.iter().any(|of| of.from == from && of.to == to);
    // A `use`, a name that is exported again, a parent's.
    assert!(has("estimator.rs", "context.rs"));
    assert!(has("estimator/cell_estimator.rs", "inference/window.rs"));
    assert!(has("effect/headwind.rs", "effect/definition.rs"));
    // A path within a macro.
    assert!(has("tuning/mod.rs", "tuning/parameter.rs"));
    assert!(!has("effect/definition.rs", "effect/mod.rs"));
    assert!(found.iter().all(|import| import.line > 0), "{found:#?}");
}

/// Only the prediction, the updates and the prior write to a covariance; the inference opens a step
/// behind the window.
#[test]
fn few_files_write_to_a_covariance() {
    let folder = root().join("estimator-core/src");
    let writers = [
        "filter/adjoint.rs",
        "filter/covariance.rs",
        "filter/dynamics.rs",
        "filter/measurement/speed.rs",
        "filter/measurement/update.rs",
        "filter/noise.rs",
        "filter/prior.rs",
        "filter/slow_states.rs",
        "filter/state.rs",
        "inference/past_steps.rs",
    ];
    let mut found = BTreeSet::new();
    for entry in walkdir::WalkDir::new(&folder) {
        let path = entry.unwrap().into_path();
        if path.extension().is_none_or(|ending| ending != "rs") {
            continue;
        }
        let text = std::fs::read_to_string(&path).unwrap();
        let words: String = text.split_whitespace().collect();
        let calls = [
            "add",
            "add_square",
            "clear",
            "reduce",
            "scale",
            "shear",
            "subtract_cross",
        ];
        let writes = |call: &&str| {
            ["covariance", "information"]
                .iter()
                .any(|matrix| words.contains(&format!("{matrix}.{call}(")))
        };
        if calls.iter().any(writes) {
            let name = path.strip_prefix(&folder).unwrap();
            found.insert(name.to_string_lossy().into_owned());
        }
    }
    let others: Vec<&String> = found
        .iter()
        .filter(|name| !writers.contains(&name.as_str()))
        .collect();
    assert!(found.len() > 3, "{found:?}");
    assert!(others.is_empty(), "{others:?}");
}

/// Checks each import from one part of a crate to another one. `rule` returns what is wrong.
fn check(folder: &str, rule: impl Fn(&str, &str) -> Option<String>) {
    let found = imports(&root().join(folder));
    assert!(found.len() > 50, "{folder}: {} imports", found.len());
    let problems: Vec<String> = found
        .iter()
        .filter(|import| part(&import.from) != part(&import.to))
        .filter_map(|import| {
            let problem = rule(part(&import.from), part(&import.to))?;
            Some(format!("{}: {problem}", in_words(folder, import)))
        })
        .collect();
    assert!(problems.is_empty(), "{}", problems.join("\n"));
}

fn in_words(folder: &str, Import { from, line, to }: &Import) -> String {
    format!("{folder}/{from}:{line} imports {to}")
}

/// Returns the part of a crate that a file belongs to: its folder, or the file itself.
fn part(file: &str) -> &str {
    let first = file.split('/').next().unwrap_or(file);
    first.strip_suffix(".rs").unwrap_or(first)
}
