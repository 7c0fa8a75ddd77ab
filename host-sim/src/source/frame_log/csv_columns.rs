//! The columns of the CSV of several programs and loggers.

use super::line_problem::{LineProblem, Parsed, header_problem};

/// Largest number of columns before the data.
const MOST_COLUMNS: usize = 16;
/// What may stand between the columns.
const SEPARATORS: [u8; 3] = [b',', b';', b'\t'];

/// Who wrote a table.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(super) enum Dialect {
    /// SavvyCAN and GVRET.
    SavvyCan,
    PythonCan,
    /// The converter of CSS Electronics for logs of a CANedge.
    CanEdge,
    /// The loggers CL1000, CL2000 and CL3000 of CSS Electronics.
    Clx,
}

/// A column of any of them.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(super) enum Column {
    Time,
    Identifier,
    Extended,
    Remote,
    Error,
    FlexibleRate,
    /// 0 and 8 have identifiers of 11 bits, 1 and 9 of 29 bits.
    Type,
    Bus,
    Length,
    /// The code of the length, which remote frames have too.
    LengthCode,
    Data,
    Unused,
}

/// The columns up to the data.
pub(super) struct Columns {
    pub separator: u8,
    pub columns: Vec<Column>,
}

impl Columns {
    /// Reads the header of a table.
    ///
    /// # Errors
    /// Returns what it lacks.
    pub(super) fn of_header(line: &[u8], dialect: Dialect) -> Parsed<Self> {
        let count = |separator: &u8| line.iter().filter(|byte| *byte == separator).count();
        let separator = SEPARATORS.into_iter().max_by_key(count).unwrap_or(b',');
        let names = line.split(|byte| *byte == separator).take(MOST_COLUMNS);
        let mut columns: Vec<Column> = names.map(|name| column(name, dialect)).collect();
        let first_data = columns.iter().position(|it| *it == Column::Data);
        columns.truncate(first_data.map_or(MOST_COLUMNS, |at| at + 1));
        let has = |column| columns.contains(&column);
        let by_dialect = match dialect {
            Dialect::SavvyCan | Dialect::PythonCan => Column::Length,
            Dialect::CanEdge => Column::Extended,
            Dialect::Clx => Column::Data,
        };
        let needed = [Column::Time, Column::Identifier, by_dialect, Column::Data];
        if needed.into_iter().all(has) {
            return Ok(Self { separator, columns });
        }
        let is_lin = dialect == Dialect::CanEdge && !has(Column::Extended);
        Err(if is_lin { NO_CAN } else { MISSING })
    }
}

const MISSING: LineProblem = header_problem(
    "columns are missing",
    "`Time Stamp,ID,Extended,Dir,Bus,LEN,D1,…`, `timestamp,arbitration_id,extended,remote,error,dlc,data`, \
     `TimestampEpoch;BusChannel;ID;IDE;DLC;DataLength;Dir;EDL;BRS;DataBytes` or `Timestamp;Type;ID;Data`",
);
const NO_CAN: LineProblem = header_problem(
    "a table of frames of LIN, without a column IDE",
    "the table of the frames of CAN",
);

/// Returns true if a line is a header: rows begin with a number.
pub(super) fn is_header(line: &[u8]) -> bool {
    let line = line.trim_ascii_start();
    let line = line.strip_prefix(b",").unwrap_or(line);
    let starts = [&b"time stamp"[..], b"timestamp"];
    starts.into_iter().any(|start| {
        line.get(..start.len())
            .is_some_and(|name| name.eq_ignore_ascii_case(start))
    })
}

fn column(name: &[u8], dialect: Dialect) -> Column {
    match name.trim_ascii().to_ascii_lowercase().as_slice() {
        b"time stamp" | b"timestamp" | b"timestampepoch" => Column::Time,
        b"id" | b"arbitration_id" => Column::Identifier,
        b"extended" | b"ide" => Column::Extended,
        b"remote" | b"rtr" => Column::Remote,
        b"error" => Column::Error,
        b"edl" => Column::FlexibleRate,
        b"type" if dialect == Dialect::Clx => Column::Type,
        b"bus" | b"buschannel" => Column::Bus,
        b"dlc" if dialect == Dialect::CanEdge => Column::LengthCode,
        b"len" | b"dlc" | b"datalength" | b"length" => Column::Length,
        b"d1" | b"data" | b"databytes" => Column::Data,
        _ => Column::Unused,
    }
}
