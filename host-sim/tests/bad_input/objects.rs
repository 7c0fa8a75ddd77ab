//! Object storage that cannot be used: each error names the object and what to do, and nothing is
//! written.

use assert_cmd::cargo::cargo_bin;
use std::fs;
use std::io::{Read, Write};
use std::net::{TcpListener, TcpStream};
use std::process::Command;
use std::thread;
use tempfile::tempdir;

const ACCESS: [(&str, &str); 3] = [
    ("AWS_ACCESS_KEY_ID", "id"),
    ("AWS_SECRET_ACCESS_KEY", "key"),
    ("AWS_ALLOW_HTTP", "true"),
];

/// Runs the program with this environment and returns its messages. It must end with 1, and leave
/// nothing but its inputs.
fn refused(environment: &[(&str, &str)], arguments: &[&str]) -> String {
    let folder = tempdir().unwrap();
    let temporary = folder.path().join("tmp");
    fs::create_dir(&temporary).unwrap();
    let mut command = Command::new(cargo_bin("roadgrade"));
    for (name, _) in std::env::vars().filter(|(name, _)| name.starts_with("AWS_")) {
        command.env_remove(name);
    }
    let output = command
        .envs(environment.iter().copied())
        .env("TMPDIR", &temporary)
        .args(arguments)
        .current_dir(&folder)
        .output()
        .unwrap();
    let messages = String::from_utf8(output.stderr).unwrap();
    assert_eq!(output.status.code(), Some(1), "{arguments:?}: {messages}");
    assert_eq!(fs::read_dir(&temporary).unwrap().count(), 0, "{messages}");
    assert_eq!(fs::read_dir(&folder).unwrap().count(), 1, "{messages}");
    assert!(!messages.contains("panicked"), "{messages}");
    messages
}

/// Returns an address at which no server listens.
fn nobody() -> String {
    let listener = TcpListener::bind("127.0.0.1:0").unwrap();
    format!("http://{}", listener.local_addr().unwrap())
}

/// Starts a server that gives the same reply to every request, and returns its address.
fn server(reply: &'static str) -> String {
    let listener = TcpListener::bind("127.0.0.1:0").unwrap();
    let address = format!("http://{}", listener.local_addr().unwrap());
    thread::spawn(move || {
        for stream in listener.incoming() {
            answer(&mut stream.unwrap(), reply);
        }
    });
    address
}

fn answer(stream: &mut TcpStream, reply: &str) {
    let mut request = Vec::new();
    let mut byte = [0];
    while !request.ends_with(b"\r\n\r\n") && stream.read(&mut byte).unwrap_or(0) == 1 {
        request.push(byte[0]);
    }
    let _ = stream.write_all(reply.as_bytes());
}

fn at(endpoint: &str) -> Vec<(&str, &str)> {
    let mut environment = ACCESS.to_vec();
    environment.push(("AWS_ENDPOINT_URL", endpoint));
    environment
}

const INSPECT: [&str; 2] = ["inspect", "s3://fleet/runs/a.log"];

#[test]
fn a_server_that_is_not_there_is_named() {
    let endpoint = nobody();
    let messages = refused(&at(&endpoint), &INSPECT);
    assert!(
        messages.contains("s3://fleet/runs/a.log: the server cannot be reached"),
        "{messages}"
    );
    assert!(messages.contains("AWS_ENDPOINT_URL"), "{messages}");
}

#[test]
fn a_connection_that_is_cut_is_an_error_without_output() {
    let endpoint = server(
        "HTTP/1.1 200 OK\r\nContent-Length: 1000\r\nLast-Modified: Mon, 02 Nov 2026 08:00:00 GMT\r\n\r\nonly this",
    );
    let fuse = ["fuse", "--out", "map.csv", "s3://fleet/runs/a.csv"];
    let messages = refused(&at(&endpoint), &fuse);
    assert!(messages.contains("s3://fleet/runs/a.csv: "), "{messages}");
    assert!(messages.contains("run again"), "{messages}");
}

#[test]
fn without_credentials_it_is_said_how_to_give_them() {
    let endpoint = nobody();
    let environment = [
        ("AWS_ENDPOINT_URL", &*endpoint),
        ("AWS_METADATA_ENDPOINT", &endpoint),
        ("AWS_ALLOW_HTTP", "true"),
    ];
    let messages = refused(&environment, &INSPECT);
    let expected = "s3://fleet/runs/a.log: there are no credentials; set AWS_ACCESS_KEY_ID";
    assert!(messages.contains(expected), "{messages}");
    let without_secret = [environment[0], environment[2], ACCESS[0]];
    let messages = refused(&without_secret, &INSPECT);
    assert!(messages.contains(expected), "{messages}");
}

#[test]
fn refused_access_names_the_reply() {
    let reply = "<Error><Code>InvalidAccessKeyId</Code></Error>";
    let reply = format!(
        "HTTP/1.1 403 Forbidden\r\nConnection: close\r\nContent-Length: {}\r\n\r\n{reply}",
        reply.len()
    );
    let endpoint = server(reply.leak());
    let messages = refused(
        &at(&endpoint),
        &["fuse", "--out", "map.csv", "s3://fleet/runs/"],
    );
    let expected =
        "s3://fleet/runs/: the server refuses access (InvalidAccessKeyId); check AWS_ACCESS_KEY_ID";
    assert!(messages.contains(expected), "{messages}");
}

#[test]
fn a_missing_object_is_named_as_the_command_line_has_it() {
    let endpoint =
        server("HTTP/1.1 404 Not Found\r\nConnection: close\r\nContent-Length: 0\r\n\r\n");
    let messages = refused(&at(&endpoint), &INSPECT);
    assert!(
        messages.contains("s3://fleet/runs/a.log: there is no such object"),
        "{messages}"
    );
}

#[test]
fn plain_http_is_allowed_only_if_asked_for() {
    let endpoint = nobody();
    let environment = [("AWS_ENDPOINT_URL", &*endpoint), ACCESS[0], ACCESS[1]];
    let messages = refused(&environment, &INSPECT);
    assert!(messages.contains("AWS_ALLOW_HTTP=true"), "{messages}");
}

#[test]
fn addresses_and_commands_that_cannot_be_are_refused() {
    for (arguments, expected) in [
        (
            &["inspect", "s3://"][..],
            "s3://: has no bucket; expected s3://BUCKET/KEY",
        ),
        (
            &["inspect", "s3://../a.log"],
            "s3://../a.log: has no bucket",
        ),
        (
            &["inspect", "s3://fleet//a.log"],
            "has a key that no file can have",
        ),
        (
            &["inspect", "s3://fleet/../a.log"],
            "has a key that no file can have",
        ),
        (
            &["inspect", "s3://fleet/runs/"],
            "is a folder; expected an object",
        ),
        (
            &[
                "simulate",
                "--scenario",
                "s3://fleet/a.toml",
                "--out",
                "drives",
            ],
            "s3://fleet/a.toml: `simulate` takes files only; expected a path",
        ),
    ] {
        let messages = refused(&ACCESS, arguments);
        assert!(messages.contains(expected), "{arguments:?}: {messages}");
    }
}
