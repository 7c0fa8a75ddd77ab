//! SUMS.csv: the sums behind a map, so that runs can be added without the earlier ones.
//!
//! The road comes first, or the ways of a network in order. It has one row per cell, with its
//! position and the sums of the runs without a session. The sessions follow, with one row per cell
//! that a run of the session covers. In the store of a network each row names its way. Numbers are
//! written exactly. The first line has the version, the number of rows, the number of runs and the
//! checksum of all that follows it. The identities of the runs follow the rows. A store without a
//! checksum, of an earlier release, is read, and gets one when it is written.

use crate::map::fusion::cell_sums::CellSums;
use crate::map::fusion::grade_map::GradeMap;
use crate::map::geometry::grid::GRID_M;
use crate::map::geometry::network::Network;

use super::checksum::Checksum;
use super::run_list::RunList;
use super::store_row::{StoreRow, StoredWay};
use super::way_file::WayColumns;
use crate::error::{Error, Result};
use crate::files::csv::read_checked_with;
use crate::files::kind::{self, Kind};
use crate::files::output::Staged;
use crate::files::row_check::Flaw;
use crate::map::geometry::plane::chord_m;
use crate::map::geometry::road_line::RoadPoint;
use crate::platform::file_number;
use std::fs::File;
use std::io::{BufRead, BufReader, Read, Write};
use std::path::Path;

/// Prefix of a file of this kind; the number is its version.
const MARK: &str = "# roadgrade sums 2, rows: ";
/// Text before the number of runs.
const RUNS_MARK: &str = ", runs: ";
/// Text before the checksum.
const CHECKSUM_MARK: &str = ", xxh3: ";
/// Maximum length of the first line, bytes.
const LONGEST_MARK: u64 = 160;
/// Lines before the first row: first line and header.
const LINES_BEFORE: u64 = 2;
/// Tolerance between cells of the same road, m: coordinates are rounded in files.
const SAME_PLACE_M: f64 = 0.5;

/// A stored map.
#[derive(Clone, Debug)]
pub struct MapStore {
    /// One way for a single road.
    pub ways: Vec<StoredWay>,
    rows: Vec<StoreRow>,
    /// The runs in the map.
    pub runs: RunList,
    /// False for a store of an earlier release.
    pub has_checksum: bool,
}

impl MapStore {
    /// Returns the cells of a single road; `None` for a network.
    #[must_use]
    pub fn road(&self) -> Option<&[RoadPoint]> {
        match &self.ways[..] {
            [StoredWay { name: None, cells }] => Some(cells),
            _ => None,
        }
    }

    /// Returns the stored map, on a network for which [`MapStore::is_of`] is true.
    #[must_use]
    pub fn resume<'a>(&self, network: &'a Network) -> GradeMap<'a> {
        let mut map = GradeMap::new(network);
        for rows in self.rows.chunk_by(StoreRow::is_beside) {
            if rows.iter().all(|row| row.runs == 0) {
                continue;
            }
            let Ok(way) = network
                .ways()
                .binary_search_by(|way| way.name.cmp(&rows[0].way_name()))
            else {
                continue;
            };
            let cells = map.cells_of(rows[0].session.as_deref(), way);
            let first = network.first_number(way);
            for row in rows {
                let index = usize::try_from(number_of(row.distance_m) - first).ok();
                if let Some(cell) = index.and_then(|index| cells.get_mut(index)) {
                    cell.merge(&row.sums());
                }
            }
        }
        map
    }

    /// Returns true if the store belongs to this network.
    #[must_use]
    pub fn is_of(&self, network: &Network) -> bool {
        network.ways().len() == self.ways.len()
            && network.ways().iter().zip(&self.ways).all(|(given, way)| {
                given.name == way.name && is_same_line(&given.line.on_grid(), &way.cells)
            })
    }
}

fn is_same_line(given: &[RoadPoint], stored: &[RoadPoint]) -> bool {
    let place = |point: &RoadPoint| (point.latitude_deg, point.longitude_deg, 0.0);
    given.len() == stored.len()
        && given.iter().zip(stored).all(|(a, b)| {
            a.distance_m == b.distance_m && chord_m(place(a), place(b)) < SAME_PLACE_M
        })
}

/// Writes the sums of a map to a file that appears when it is committed. A single road must have
/// one point per cell; see [`RoadLine::on_grid`](crate::map::RoadLine::on_grid).
///
/// # Errors
/// Returns the error of the file system, or an error for sums that could not be read again.
pub fn stage(path: &Path, map: &GradeMap, runs: &RunList) -> Result<Staged> {
    let ways = map.network().ways();
    let rows = || {
        map.sums().flat_map(|(session, way, cells)| {
            let points = ways[way].line.on_grid().into_iter();
            let none = std::iter::repeat(CellSums::default());
            points
                .zip(cells.iter().copied().chain(none))
                .filter(move |(_, sums)| session.is_none() || sums.estimates > 0)
                .map(move |(point, sums)| {
                    let name = ways[way].name.as_ref();
                    (name, StoreRow::new(session, name, &point, &sums))
                })
        })
    };
    let mut before = None;
    let mut count = 0;
    for (_, row) in rows() {
        // What is written must be readable, whatever it was made of.
        StoreRow::check(before.as_ref(), &row).map_err(|flaw| {
            let Flaw { problem, expected } = flaw;
            let problem = format!("not written: {problem}; expected {expected}");
            Error::content(path, problem)
        })?;
        before = Some(row);
        count += 1;
    }
    let write = |out: &mut dyn Write| {
        let mut writer = csv::Writer::from_writer(&mut *out);
        for (name, row) in rows() {
            match name {
                None => writer.serialize(row),
                name => writer.serialize((row, WayColumns::from(name))),
            }
            .map_err(std::io::Error::other)?;
        }
        writer.flush()?;
        drop(writer);
        runs.write(out)
    };
    let mut checksum = Checksum::default();
    write(&mut checksum).map_err(Error::io(path))?;
    crate::files::output::stage(path, |out| {
        let (runs, checksum) = (runs.len(), checksum.text());
        writeln!(
            out,
            "{MARK}{count}{RUNS_MARK}{runs}{CHECKSUM_MARK}{checksum}"
        )?;
        write(out)
    })
}

/// Reads a map's sums.
///
/// # Errors
/// Returns an error that names the file, the line and the expected value.
pub fn read(path: &Path) -> Result<MapStore> {
    // Parts of the file are read one after the other. If another program replaces it meanwhile, they
    // are of two stores.
    let mut attempts = 0..3;
    loop {
        let before = number_of_file(path);
        let read = read_once(path);
        if number_of_file(path) == before || attempts.next().is_none() {
            return read;
        }
    }
}

/// Returns what tells a file from the one that replaces it.
fn number_of_file(path: &Path) -> Option<u64> {
    path.metadata().ok().as_ref().and_then(file_number)
}

fn read_once(path: &Path) -> Result<MapStore> {
    let mut reader = BufReader::new(File::open(path).map_err(Error::io(path))?);
    let first =
        FirstLine::read(path, &mut reader).map_err(|e| kind::explained(e, path, &[Kind::Sums]))?;
    let is_whole = match &first.checksum {
        Some(checksum) => *checksum == Checksum::of(reader).map_err(Error::io(path))?,
        None => true,
    };
    // A damaged store is refused in any case. The reader may find the line.
    let store = read_content(path, &first);
    match store {
        Ok(_) if !is_whole => Err(Error::content(
            path,
            "damaged: its content does not have the checksum of its first line",
        )),
        store => store,
    }
}

fn read_content(path: &Path, first: &FirstLine) -> Result<MapStore> {
    let promised = first.rows;
    let rows = read_checked_with(
        csv::ReaderBuilder::new().comment(Some(b'#')),
        path,
        promised.saturating_add(1),
        StoreRow::check,
    )?;
    if rows.len() != promised {
        return Err(Error::content(
            path,
            format!(
                "{} rows; expected the {promised} of its first line",
                rows.len()
            ),
        ));
    }
    let mut ways: Vec<StoredWay> = Vec::new();
    for rows in rows.chunk_by(StoreRow::is_beside) {
        // The check ensures that the first rows are those of the road.
        if rows[0].session.is_none() {
            ways.push(StoredWay {
                name: rows[0].way_name(),
                cells: rows.iter().filter_map(StoreRow::point).collect(),
            });
        }
    }
    if let Some(i) = rows.iter().position(|row| !row.is_on(&ways)) {
        return Err(Error::line(
            path,
            i as u64 + 1 + LINES_BEFORE,
            format!("distance_m is {}", rows[i].distance_m),
            format!("a cell of {}", extent(&ways, &rows[i])),
        ));
    }
    let runs = RunList::read(path, first.runs)?;
    Ok(MapStore {
        ways,
        rows,
        runs,
        has_checksum: first.checksum.is_some(),
    })
}

/// What the first line states.
struct FirstLine {
    rows: usize,
    runs: usize,
    /// `None` in a store of an earlier release.
    checksum: Option<String>,
}

impl FirstLine {
    /// Reads the line; the reader is then behind it.
    fn read(path: &Path, reader: &mut impl BufRead) -> Result<Self> {
        let mut first = Vec::new();
        reader
            .take(LONGEST_MARK)
            .read_until(b'\n', &mut first)
            .map_err(Error::io(path))?;
        Self::parse(&String::from_utf8_lossy(&first)).ok_or_else(|| {
            Error::line(
                path,
                1,
                "not a store of this version",
                format!("\"{MARK}\" and their numbers, as fuse --store writes it"),
            )
        })
    }

    fn parse(line: &str) -> Option<Self> {
        let (rows, rest) = line.strip_prefix(MARK)?.split_once(RUNS_MARK)?;
        let (runs, checksum) = match rest.split_once(CHECKSUM_MARK) {
            Some((runs, checksum)) => (runs, Some(checksum.strip_suffix('\n')?.to_owned())),
            None => (rest.trim_end(), None),
        };
        Some(Self {
            rows: rows.parse().ok()?,
            runs: runs.parse().ok()?,
            checksum,
        })
    }
}

/// Returns the road that a row should be on, as text.
fn extent(ways: &[StoredWay], row: &StoreRow) -> String {
    let name = row.way_name();
    let way = ways.iter().find(|way| way.name == name);
    match way.map(|way| way.cells.as_slice()) {
        Some([first, .., last]) => {
            format!("the road, {} to {}", first.distance_m, last.distance_m)
        }
        _ => "a way that the rows before list".to_owned(),
    }
}

fn number_of(distance_m: f64) -> i64 {
    (distance_m / GRID_M).round() as i64
}
