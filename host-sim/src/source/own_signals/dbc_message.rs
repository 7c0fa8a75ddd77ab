//! Messages and signals of a `.dbc` file, with the place of each number worked out.

use can_dbc::{
    ByteOrder, Dbc, Message, MessageId, MultiplexIndicator, NumericValue, Signal,
    SignalExtendedValueType, ValueType,
};
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
    /// Its name.
    pub name: String,
    /// Its frames: those of a parameter group if the file says so, or if the source address in its
    /// identifier is that of no sender.
    pub frames: FrameMatch,
    /// Its signals.
    pub signals: Vec<DbcSignal>,
}

/// A signal of a message.
#[derive(Debug)]
pub struct DbcSignal {
    /// Its name.
    pub name: String,
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
    pub(super) fn new(dbc: &Dbc, message: &Message, is_j1939: bool) -> Self {
        Self {
            name: message.name.clone(),
            frames: frames_of(message, is_j1939),
            signals: message
                .signals
                .iter()
                .map(|signal| DbcSignal::new(dbc, message, signal))
                .collect(),
        }
    }
}

fn frames_of(message: &Message, is_j1939: bool) -> FrameMatch {
    match message.id {
        MessageId::Standard(id) => FrameMatch::Standard(id),
        MessageId::Extended(id) => {
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
    fn new(dbc: &Dbc, message: &Message, signal: &Signal) -> Self {
        let mut multiplexers = Vec::new();
        let selected = switches(dbc, message, &signal.name, &mut multiplexers, DEEPEST);
        let field = field_of(signal, kind_of(dbc, message, signal));
        Self {
            name: signal.name.clone(),
            field: selected.and(field),
            multiplexers,
            factor: signal.factor,
            offset: signal.offset,
            unit: signal.unit.clone(),
            range: (number(signal.min), number(signal.max)),
        }
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

fn number(value: NumericValue) -> f64 {
    match value {
        NumericValue::Uint(number) => number as f64,
        NumericValue::Int(number) => number as f64,
        NumericValue::Double(number) => number,
    }
}

fn kind_of(dbc: &Dbc, message: &Message, signal: &Signal) -> NumberKind {
    let listed = dbc
        .signal_extended_value_type_list
        .iter()
        .find(|listed| listed.message_id == message.id && listed.signal_name == signal.name);
    match (
        listed.map(|listed| listed.signal_extended_value_type),
        signal.value_type,
    ) {
        (Some(SignalExtendedValueType::IEEEfloat32Bit), _) => NumberKind::Float32,
        (Some(SignalExtendedValueType::IEEEdouble64bit), _) => NumberKind::Float64,
        (_, ValueType::Signed) => NumberKind::Signed,
        (_, ValueType::Unsigned) => NumberKind::Unsigned,
    }
}

/// Returns the place of a number; or, why there is none.
fn field_of(signal: &Signal, kind: NumberKind) -> Result<RawField, String> {
    let order = match signal.byte_order {
        ByteOrder::LittleEndian => raw_field::ByteOrder::Intel,
        ByteOrder::BigEndian => raw_field::ByteOrder::Motorola,
    };
    let (start_bit, bits) = (signal.start_bit, signal.size);
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
    dbc: &Dbc,
    message: &Message,
    name: &str,
    found: &mut Vec<Switch>,
    deepest: usize,
) -> Result<(), String> {
    let of_name = |name: &str| message.signals.iter().find(|signal| signal.name == name);
    let Some(signal) = of_name(name) else {
        return Err(format!(
            "is multiplexed by `{name}`, which its message lacks"
        ));
    };
    let listed = dbc
        .extended_multiplex
        .iter()
        .find(|listed| listed.message_id == message.id && listed.signal_name == name);
    let (switch, ranges) = match (listed, signal.multiplexer_indicator) {
        (Some(listed), _) => {
            let pair = |of: &can_dbc::ExtendedMultiplexMapping| (of.min_value, of.max_value);
            (
                of_name(&listed.multiplexor_signal_name),
                listed.mappings.iter().map(pair).collect(),
            )
        }
        (
            None,
            MultiplexIndicator::MultiplexedSignal(selecting)
            | MultiplexIndicator::MultiplexorAndMultiplexedSignal(selecting),
        ) => {
            let is_switch =
                |of: &&Signal| of.multiplexer_indicator == MultiplexIndicator::Multiplexor;
            (
                message.signals.iter().find(is_switch),
                vec![(selecting, selecting)],
            )
        }
        (None, MultiplexIndicator::Plain | MultiplexIndicator::Multiplexor) => return Ok(()),
    };
    let Some(switch) = switch else {
        return Err("is multiplexed, and its message has no such multiplexer".to_owned());
    };
    if deepest == 0 {
        return Err("is multiplexed in a circle".to_owned());
    }
    // The numbers of a multiplexer are unsigned, whatever the file says.
    let field = field_of(switch, NumberKind::Unsigned)
        .map_err(|problem| format!("is multiplexed by `{}`, which {problem}", switch.name))?;
    found.push(Switch { field, ranges });
    switches(dbc, message, &switch.name, found, deepest - 1)
}
