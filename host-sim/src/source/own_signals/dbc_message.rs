//! Messages and signals of a `.dbc` file, with the place of each number worked out.

use super::dbc_attributes::Attributes;
use super::dbc_statement::SignalStatement;
use super::dbc_text::EXTENDED;
use super::message_parts::MessageParts;
use estimator_core::signal::Pgn;
use estimator_core::signal::own_message::{FrameMatch, Multiplexer};
use estimator_core::signal::raw_field::{self, NumberKind, RawField};

/// Source address of identifiers that stand for those of any sender (J1939-81: the null address).
const NULL_ADDRESS: u8 = 254;
/// Bytes of a classic CAN frame.
const FRAME_BYTES: usize = 8;
/// Multiplexers of multiplexers; deeper ones would be a circle.
const DEEPEST: usize = 8;

/// A message.
#[derive(Debug)]
pub struct DbcMessage {
    /// Its name; the long one, where the file has it.
    pub name: String,
    /// The name in the statement.
    pub short_name: String,
    /// Its frames: those of a parameter group if the file says so, or if the source address in its
    /// identifier is that of no sender.
    pub frames: FrameMatch,
    /// Its signals.
    pub signals: Vec<DbcSignal>,
}

/// A signal of a message.
#[derive(Debug)]
pub struct DbcSignal {
    /// Its name; the long one, where the file has it.
    pub name: String,
    /// The name in the statement.
    pub short_name: String,
    /// Its place in the payload; or, why it cannot be read.
    pub field: Result<RawField, String>,
    /// Its multiplexers, all of which select it.
    pub multiplexers: Vec<Switch>,
    /// From the raw number to `unit`.
    pub factor: f64,
    /// Added after `factor`.
    pub offset: f64,
    /// Its unit, as the file writes it.
    pub unit: String,
    /// Least and greatest value; both zero if the file does not say.
    pub range: (f64, f64),
}

/// The numbers of a multiplexer that select a signal.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct Switch {
    /// The number that switches.
    pub field: RawField,
    /// Pairs of the least and the greatest selecting number.
    pub ranges: Vec<(u64, u64)>,
}

impl Switch {
    /// Returns whether the signal is in `payload`.
    #[must_use]
    pub fn selects(&self, payload: &[u8]) -> bool {
        let switch = Multiplexer {
            field: self.field,
            ranges: &self.ranges,
        };
        switch.selects(payload)
    }
}

impl DbcMessage {
    /// Returns the parameter group of a 29-bit identifier.
    #[must_use]
    pub const fn pgn(&self) -> Option<u32> {
        match self.frames {
            FrameMatch::Standard(_) => None,
            FrameMatch::Extended(id) => Some(Pgn::from_raw(id).number),
            FrameMatch::Group(pgn) => Some(pgn),
        }
    }

    /// Creates the message of a file.
    pub(super) fn new(parts: &MessageParts, attributes: &Attributes) -> Self {
        let long = attributes.messages.get(&parts.number);
        let signals = parts.signals.iter();
        Self {
            name: long_or(long, &parts.name),
            short_name: parts.name.clone(),
            frames: frames_of(parts.number, attributes.is_j1939(parts.number)),
            signals: signals
                .map(|(name, signal)| {
                    let key = (parts.number, name.clone());
                    let long = long_or(attributes.signals.get(&key), name);
                    DbcSignal::new(parts, name, long, signal)
                })
                .collect(),
        }
    }

    /// Returns whether this is its name, the long or the short one.
    #[must_use]
    pub fn is_named(&self, name: &str) -> bool {
        self.name == name || self.short_name == name
    }
}

/// Returns a long name, unless it is empty.
fn long_or(long: Option<&String>, name: &str) -> String {
    match long {
        Some(long) if !long.is_empty() => long.clone(),
        _ => name.to_owned(),
    }
}

fn frames_of(number: u32, is_j1939: bool) -> FrameMatch {
    match u16::try_from(number) {
        Ok(id) => FrameMatch::Standard(id),
        Err(_) => {
            let id = number & !EXTENDED;
            let pgn = Pgn::from_raw(id);
            if is_j1939 || pgn.source == NULL_ADDRESS {
                FrameMatch::Group(pgn.number)
            } else {
                FrameMatch::Extended(id)
            }
        }
    }
}

impl DbcSignal {
    fn new(
        parts: &MessageParts,
        name: &str,
        long: String,
        signal: &Result<SignalStatement, String>,
    ) -> Self {
        let mut found = Self {
            name: long,
            short_name: name.to_owned(),
            field: Err(String::new()),
            multiplexers: Vec::new(),
            factor: 1.0,
            offset: 0.0,
            unit: String::new(),
            range: (0.0, 0.0),
        };
        match signal {
            Ok(signal) => {
                let selected = switches(parts, name, signal, &mut found.multiplexers, DEEPEST);
                let field = kind_of(parts, name, signal).and_then(|kind| field_of(signal, kind));
                found.field = selected.and(field);
                (found.factor, found.offset) = (signal.factor, signal.offset);
                found.unit.clone_from(&signal.unit);
                found.range = signal.range;
            }
            Err(problem) => found.field = Err(problem.clone()),
        }
        found
    }

    /// Returns whether this is its name, the long or the short one.
    #[must_use]
    pub fn is_named(&self, name: &str) -> bool {
        self.name == name || self.short_name == name
    }

    /// Reads the number from `payload`, in `unit`; `None` if the payload ends before it, or while a
    /// multiplexer selects another signal.
    #[must_use]
    pub fn read(&self, payload: &[u8]) -> Option<f64> {
        let raw = self.field.as_ref().ok()?.read(payload)?;
        let is_selected = self
            .multiplexers
            .iter()
            .all(|switch| switch.selects(payload));
        is_selected.then(|| raw.to_f64() * self.factor + self.offset)
    }
}

fn kind_of(
    parts: &MessageParts,
    name: &str,
    signal: &SignalStatement,
) -> Result<NumberKind, String> {
    match parts.kinds.get(name) {
        Some(kind) => kind.clone(),
        None if signal.is_signed => Ok(NumberKind::Signed),
        None => Ok(NumberKind::Unsigned),
    }
}

/// Returns the place of a number; or, why there is none.
fn field_of(signal: &SignalStatement, kind: NumberKind) -> Result<RawField, String> {
    let order = if signal.is_motorola {
        raw_field::ByteOrder::Motorola
    } else {
        raw_field::ByteOrder::Intel
    };
    let (start_bit, bits) = (signal.start_bit, signal.bits);
    let field = match (u16::try_from(start_bit), u8::try_from(bits)) {
        (Ok(start_bit), Ok(bits)) => RawField::new(start_bit, bits, order, kind),
        _ => None,
    };
    let Some(field) = field else {
        let most = match kind {
            NumberKind::Float32 => "32 bits, for a floating-point number",
            NumberKind::Float64 => "64 bits, for a floating-point number",
            NumberKind::Unsigned | NumberKind::Signed => "1 to 64 bits",
        };
        return Err(format!(
            "has {bits} bits from bit {start_bit}; expected {most}"
        ));
    };
    if field.payload_bytes() > FRAME_BYTES {
        return Err(format!(
            "ends in byte {}; expected one within the {FRAME_BYTES} bytes of a classic CAN frame",
            field.payload_bytes()
        ));
    }
    Ok(field)
}

/// Collects the multiplexers of a signal: those that `SG_MUL_VAL_` lists, else the one of the message.
fn switches(
    parts: &MessageParts,
    name: &str,
    signal: &SignalStatement,
    found: &mut Vec<Switch>,
    deepest: usize,
) -> Result<(), String> {
    let mut others = parts.signals.iter();
    let (switch, ranges) = match (parts.switches.get(name), signal.role.selected_by) {
        (Some(listed), _) => {
            let (switch, ranges) = listed.clone()?;
            (others.find(|(name, _)| *name == switch), ranges)
        }
        (None, Some(selecting)) => {
            let is_switch = |(_, of): &&(String, Result<SignalStatement, String>)| {
                of.as_ref()
                    .is_ok_and(|of| of.role.is_switch && of.role.selected_by.is_none())
            };
            (others.find(is_switch), vec![(selecting, selecting)])
        }
        (None, None) => return Ok(()),
    };
    let Some((switch, statement)) = switch else {
        return Err("is multiplexed, and its message has no such multiplexer".to_owned());
    };
    if deepest == 0 {
        return Err("is multiplexed in a circle".to_owned());
    }
    let by = |problem: &str| format!("is multiplexed by `{switch}`, which {problem}");
    let statement = statement.as_ref().map_err(|problem| by(problem))?;
    // The numbers of a multiplexer are unsigned, whatever the file says.
    let field = field_of(statement, NumberKind::Unsigned).map_err(|problem| by(&problem))?;
    found.push(Switch { field, ranges });
    switches(parts, switch, statement, found, deepest - 1)
}
