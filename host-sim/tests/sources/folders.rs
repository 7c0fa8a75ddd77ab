//! Folders in the place of a log.

use test_kit::command::{folder, program, roadgrade};

#[test]
fn a_folder_means_the_logs_in_it() {
    let folder = folder();
    let below = folder.path().join("logs/monday");
    std::fs::create_dir_all(&below).unwrap();
    let table = "time_s,wheel_speed_mps\n0,1\n1,2\n";
    for (name, content) in [
        ("a.csv", table),
        (
            "b.log",
            "(0.000000) can0 18FEF100#FFFFFFFFFFFFFFFF\n(0.1) can0 18FEF100#FFFFFFFFFFFFFFFF\n",
        ),
        ("readme.txt", "a text\n"),
        ("truck.toml", "[vehicle]\nname = \"truck\"\n"),
        (
            "run.csv",
            "time_s,distance_m,live_grade_percent,altitude_m\n0,2.5,1,3\n",
        ),
    ] {
        std::fs::write(below.join(name), content).unwrap();
    }
    let run = |arguments: &[&str]| roadgrade(folder.path(), arguments);
    let done = run(&["inspect", "logs"]).success();
    let output = String::from_utf8_lossy(&done.get_output().stdout).into_owned();
    assert!(output.contains("a.csv: signal table, 2 rows"), "{output}");
    assert!(output.contains("b.log: candump log, 2 frames"), "{output}");
    let told = String::from_utf8_lossy(&done.get_output().stderr).into_owned();
    assert!(told.contains("3 skipped: no log"), "{told}");
    let several = run(&["inspect", "--json", "logs"]).failure().code(1);
    let told = String::from_utf8_lossy(&several.get_output().stderr).into_owned();
    assert!(told.contains("a folder of 2 logs"), "{told}");
    std::fs::remove_file(below.join("b.log")).unwrap();
    run(&["inspect", "--json", "logs"]).success();
    std::fs::remove_file(below.join("a.csv")).unwrap();
    run(&["inspect", "logs"]).failure().code(1);
    run(&["map", "--out", "out", "logs"]).failure().code(1);
}

#[test]
fn a_mapping_makes_the_tables_of_a_folder_logs() {
    let folder = folder();
    let at = folder.path();
    std::fs::create_dir(at.join("tables")).unwrap();
    let table = "when,kmh\n0,36\n1,37\n2,38\n";
    for name in ["a.csv", "b.csv"] {
        std::fs::write(at.join("tables").join(name), table).unwrap();
    }
    std::fs::write(at.join("tables/notes.csv"), "day,who\n1,me\n").unwrap();
    let mapping = "[columns.time_s]\ncolumn = \"when\"\nunit = \"s\"\n\
                   [columns.wheel_speed_mps]\ncolumn = \"kmh\"\nunit = \"km/h\"\n";
    std::fs::write(at.join("columns.toml"), mapping).unwrap();
    let run = |arguments: &[&str]| {
        let mut command = program();
        command.current_dir(at).arg("inspect").args(arguments);
        let output = command.assert().get_output().clone();
        let text = |bytes: Vec<u8>| String::from_utf8(bytes).unwrap();
        (text(output.stdout), text(output.stderr))
    };
    let (told, notes) = run(&["--columns", "columns.toml", "tables"]);
    for words in ["a.csv: signal table, 3 rows", "b.csv: signal table, 3 rows"] {
        assert!(told.contains(words), "{words}: {told}{notes}");
    }
    assert!(
        notes.contains("1 skipped: no log") && notes.contains("notes.csv"),
        "{notes}"
    );
    let (_, notes) = run(&["tables"]);
    assert!(notes.contains("no log in this folder"), "{notes}");
}
