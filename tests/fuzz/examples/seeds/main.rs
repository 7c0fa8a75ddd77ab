//! Writes the seeds of the fuzz targets that are not text:
//!
//! ```text
//! cargo run -p fuzz-targets --example seeds
//! ```
//!
//! The names of the seeds say what they are. Seeds of the text readers are written by hand.

mod events;
mod logs;
mod persistent_states;
mod sessions;
mod traffic;

use events::encoded;
use logs::{blf, compressed, extract, few_frames, packed, write_table};
use persistent_states::of_persistent_state;
use sessions::{encoded_packets, of_transport};
use std::path::Path;
use std::{fs, io};
use test_kit::mdf::{MDF_FORMS, mdf};
use test_kit::mdf_signals::{MDF_SIGNAL_FORMS, few_records, mdf_signals};
use test_kit::osm::Packing;
use test_kit::pcap::pcap_forms;
use traffic::{of_decode, of_estimator};

fn main() -> io::Result<()> {
    let corpus = Path::new(env!("CARGO_MANIFEST_DIR")).join("corpus");
    for (name, events) in of_estimator() {
        write(&corpus, "estimator", name, &encoded(&events))?;
    }
    for (name, events) in of_decode() {
        write(&corpus, "decode", name, &encoded(&events))?;
    }
    for (name, packets) in of_transport() {
        write(&corpus, "transport", name, &encoded_packets(&packets))?;
    }
    for (name, bytes) in of_persistent_state() {
        write(&corpus, "persistent_state", name, &bytes)?;
    }
    for (target, from, to) in [
        ("candump", "short_form", "gzip"),
        ("signal_table", "some_columns", "gzip"),
    ] {
        let text = fs::read(corpus.join(target).join(from))?;
        write(&corpus, target, to, &compressed(&text)?)?;
    }
    for (k, (blocks, data)) in MDF_FORMS.into_iter().enumerate() {
        let name = format!("form_{k}");
        write(&corpus, "mdf", &name, &mdf(&few_frames(), blocks, data))?;
    }
    for (k, form) in pcap_forms().into_iter().enumerate() {
        write(
            &corpus,
            "pcap",
            &format!("form_{k}"),
            &form.file(&few_frames()),
        )?;
    }
    for (k, (blocks, layout)) in MDF_SIGNAL_FORMS.into_iter().enumerate() {
        let name = format!("signals_{k}");
        let file = mdf_signals(&few_records(), blocks, layout);
        write(&corpus, "mdf", &name, &file)?;
    }
    for (name, method) in [("plain", 0), ("zlib", 2)] {
        write(&corpus, "blf", name, &blf(&few_frames(), method)?)?;
    }
    for (name, bytes) in packed(&fs::read(corpus.join("candump").join("short_form"))?)? {
        write(&corpus, "packed", name, &bytes)?;
    }
    let folder = tempfile::tempdir()?;
    let table = folder.path().join("table.parquet");
    write_table(&table);
    write(&corpus, "parquet_table", "some_columns", &fs::read(table)?)?;
    for (name, packing) in [("raw", Packing::Raw), ("zlib", Packing::Zlib)] {
        write(&corpus, "osm_pbf", name, &extract(packing))?;
    }
    Ok(())
}

fn write(corpus: &Path, target: &str, name: &str, bytes: &[u8]) -> io::Result<()> {
    let folder = corpus.join(target);
    fs::create_dir_all(&folder)?;
    fs::write(folder.join(name), bytes)
}
