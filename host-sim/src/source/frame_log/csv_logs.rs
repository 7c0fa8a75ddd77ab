//! The CSV of SavvyCAN and GVRET, of python-can, and of the loggers of CSS Electronics.
//!
//! ```text
//! Time Stamp,ID,Extended,Dir,Bus,LEN,D1,D2,D3,D4,D5,D6,D7,D8
//! 166064000,0CF00400,true,Rx,0,8,60,7D,84,48,14,00,F0,84,
//! timestamp,arbitration_id,extended,remote,error,dlc,data
//! 0.001,0xcf00400,1,0,0,8,YH2ESBQA8IQ=
//! TimestampEpoch;BusChannel;ID;IDE;DLC;DataLength;Dir;EDL;BRS;DataBytes
//! 1795341601.500000;1;CF00400;1;8;8;0;0;0;607D84481400F084
//! Timestamp;Type;ID;Data
//! 22T100001500;1;cf00400;607d84481400f084
//! ```
//!
//! * Times of SavvyCAN are microseconds, those of python-can and CANedge seconds, those of the loggers
//!   CL1000 to CL3000 as their header says.
//! * Buses of SavvyCAN are counted from 0, those of CANedge from 1. Older versions of SavvyCAN have no
//!   column `Dir`.
//! * Data of python-can are in base64 (RFC 4648).
//! * A row with more than 8 bytes, or with `EDL`, is a CAN FD frame.

use super::clx_time::ClxClock;
use super::csv_columns::{Column, Columns, Dialect, is_header};
use super::csv_row::{MOST_BYTES, NO_ROW, Row, base64_data, byte_fields, digit_pairs};
use super::line_problem::Parsed;
use super::text::{LineFormat, TextLine};
use crate::source::can_frame::CanFrame;
use crate::source::interfaces::Interfaces;
use embedded_can::Frame;

/// Rows under a header.
pub(super) struct CsvLog {
    dialect: Dialect,
    columns: Option<Columns>,
    clock: ClxClock,
}

impl CsvLog {
    pub(super) fn of(dialect: Dialect) -> Self {
        Self {
            dialect,
            columns: None,
            clock: ClxClock::default(),
        }
    }

    fn row(
        &self,
        columns: &Columns,
        line: &[u8],
        micros: Option<i64>,
        interfaces: &mut Interfaces,
    ) -> Parsed<TextLine> {
        let dialect = self.dialect;
        let fields = line.split(|byte| *byte == columns.separator);
        let mut fields = fields.map(<[u8]>::trim_ascii);
        let mut row = Row::default();
        for column in &columns.columns {
            if *column == Column::Data {
                break;
            }
            let field = fields.next().ok_or(NO_ROW)?;
            match (column, micros) {
                (Column::Time, Some(micros)) => row.micros = micros,
                _ => row.take(*column, field, dialect)?,
            }
        }
        if row.is_error {
            return Ok(TextLine::BusError);
        }
        if row.is_flexible_rate || row.length.is_some_and(|length| length > MOST_BYTES) {
            return Ok(TextLine::FlexibleRate);
        }
        let id = row.id(dialect)?;
        let (frame, is_closed) = if row.is_remote {
            let length = row.length.unwrap_or_default().max(row.code);
            (CanFrame::new_remote(id, length), false)
        } else {
            let length = row.length;
            let data = match dialect {
                Dialect::SavvyCan => Some(byte_fields(&mut fields, length.ok_or(NO_ROW)?)?),
                Dialect::PythonCan => Some(base64_data(fields.next(), length.ok_or(NO_ROW)?)?),
                Dialect::CanEdge | Dialect::Clx => digit_pairs(fields.next(), length)?,
            };
            let Some(data) = data else {
                return Ok(TextLine::FlexibleRate);
            };
            let bytes = data.bytes.get(..data.count).unwrap_or_default();
            (CanFrame::new(id, bytes), data.is_closed)
        };
        let channel = match (dialect, row.bus) {
            (Dialect::CanEdge, Some(channel)) => channel,
            (_, bus) => bus.unwrap_or_default().saturating_add(1),
        };
        Ok(TextLine::Frame {
            micros: row.micros,
            interface: interfaces.channel(channel),
            frame: frame.ok_or(NO_ROW)?,
            is_closed,
        })
    }

    /// Returns the time of a row of a logger, which needs the times before it.
    fn clx_micros(&mut self, line: &[u8]) -> Parsed<Option<i64>> {
        let Some(columns) = self.columns.as_ref() else {
            return Ok(None);
        };
        if self.dialect != Dialect::Clx {
            return Ok(None);
        }
        let at = columns.columns.iter().position(|it| *it == Column::Time);
        let mut fields = line.split(|byte| *byte == columns.separator);
        let field = at.and_then(|at| fields.nth(at)).ok_or(NO_ROW)?;
        self.clock.micros(field.trim_ascii()).map(Some)
    }
}

impl LineFormat for CsvLog {
    fn parse(&mut self, line: &[u8], interfaces: &mut Interfaces) -> Parsed<TextLine> {
        let line = line.trim_ascii();
        if line.is_empty() {
            return Ok(TextLine::Blank);
        }
        if let [b'#', comment @ ..] = line {
            if self.dialect == Dialect::Clx {
                self.clock.header(comment);
            }
            return Ok(TextLine::Other);
        }
        // Logs behind one another have a header each.
        if self.columns.is_none() || is_header(line) {
            self.columns = Some(Columns::of_header(line, self.dialect)?);
            return Ok(TextLine::Other);
        }
        let micros = self.clx_micros(line)?;
        match &self.columns {
            Some(columns) => self.row(columns, line, micros, interfaces),
            None => Err(NO_ROW),
        }
    }
}
