//! Turns messages of a user's own `.dbc` file into a table of `signal::own_message`.
//!
//! A firmware with a bus of its own takes this file into its build script, and names the signals that
//! it wants; `examples/own_dbc` shows it whole. What is wrong ends the build with a message.

use can_dbc::{
    ByteOrder, Dbc, Message, MessageId, MultiplexIndicator, Signal, SignalExtendedValueType,
    ValueType,
};
use std::fmt::Write as _;

/// A signal of the file, and the one of ours that it becomes.
pub struct Mapping {
    /// Variant of `estimator_core::Signal`. Within a message they stand in its order.
    pub signal: &'static str,
    /// Name of the message in the file.
    pub message: &'static str,
    /// Name of its signal.
    pub source: &'static str,
    /// From the unit of the file to that of our signal.
    pub scale: f64,
    /// Added after `scale`.
    pub offset: f64,
    /// Raw numbers that mean "not available".
    pub invalid: &'static [i64],
    /// Raw numbers with a value of their own, in the unit of our signal.
    pub values: &'static [(i64, f64)],
}

/// Returns the Rust source of a static `name` with the messages that `mappings` name.
pub fn table(text: &str, name: &str, mappings: &[Mapping]) -> String {
    let dbc = Dbc::try_from(text).unwrap_or_else(|error| panic!("{error}"));
    let mut code = String::from(
        "const fn own_field(start_bit: u16, bits: u8, order: ByteOrder, kind: NumberKind) -> RawField {\n    \
         match RawField::new(start_bit, bits, order, kind) {\n        \
         Some(field) => field,\n        None => panic!(\"a number of impossible length\"),\n    }\n}\n\n",
    );
    let mut messages = Vec::new();
    for message in &dbc.messages {
        let own: Vec<String> = mappings
            .iter()
            .filter(|mapping| mapping.message == message.name)
            .map(|mapping| own_signal(&dbc, message, mapping))
            .collect();
        if !own.is_empty() {
            messages.push((message, own));
        }
    }
    for mapping in mappings {
        let is_known = dbc
            .messages
            .iter()
            .any(|message| message.name == mapping.message);
        assert!(is_known, "{}: no such message", mapping.message);
    }
    let count = messages.len();
    writeln!(code, "/// Messages of our own bus.").unwrap();
    writeln!(
        code,
        "pub static {name}: [OwnMessage<'static>; {count}] = ["
    )
    .unwrap();
    for (message, own) in messages {
        let frames = match message.id {
            MessageId::Standard(id) => format!("Standard({id:#x})"),
            MessageId::Extended(id) => format!("Extended({id:#x})"),
        };
        writeln!(
            code,
            "    OwnMessage {{ frames: FrameMatch::{frames}, signals: &["
        )
        .unwrap();
        for signal in own {
            writeln!(code, "        {signal},").unwrap();
        }
        writeln!(code, "    ] }},").unwrap();
    }
    writeln!(code, "];").unwrap();
    code
}

fn own_signal(dbc: &Dbc, message: &Message, mapping: &Mapping) -> String {
    let found = |name: &str| message.signals.iter().find(|signal| signal.name == name);
    let source = found(mapping.source)
        .unwrap_or_else(|| panic!("{}.{}: no such signal", message.name, mapping.source));
    format!(
        "OwnSignal {{ signal: Signal::{}, field: {}, multiplexers: &[{}], scale: {:e}, offset: {:e}, \
         invalid: &{:?}, values: &{:?}, has_j1939_codes: false }}",
        mapping.signal,
        field(message, source, kind(dbc, message, source)),
        multiplexer(message, source),
        source.factor * mapping.scale,
        source.offset * mapping.scale + mapping.offset,
        mapping.invalid,
        mapping.values,
    )
}

fn field(message: &Message, signal: &Signal, kind: &str) -> String {
    let order = match signal.byte_order {
        ByteOrder::LittleEndian => "Intel",
        ByteOrder::BigEndian => "Motorola",
    };
    let (start_bit, bits) = (signal.start_bit, signal.size);
    let is_in_frame = start_bit < 64 && bits <= 64;
    assert!(
        is_in_frame,
        "{}.{}: beyond a frame",
        message.name, signal.name
    );
    format!("own_field({start_bit}, {bits}, ByteOrder::{order}, NumberKind::{kind})")
}

fn kind(dbc: &Dbc, message: &Message, signal: &Signal) -> &'static str {
    let listed = dbc
        .signal_extended_value_type_list
        .iter()
        .find(|listed| listed.message_id == message.id && listed.signal_name == signal.name);
    match (
        listed.map(|listed| listed.signal_extended_value_type),
        signal.value_type,
    ) {
        (Some(SignalExtendedValueType::IEEEfloat32Bit), _) => "Float32",
        (Some(SignalExtendedValueType::IEEEdouble64bit), _) => "Float64",
        (_, ValueType::Signed) => "Signed",
        (_, ValueType::Unsigned) => "Unsigned",
    }
}

/// Returns the multiplexer of a signal; nothing for a signal that is always there.
fn multiplexer(message: &Message, signal: &Signal) -> String {
    let selecting = match signal.multiplexer_indicator {
        MultiplexIndicator::Plain | MultiplexIndicator::Multiplexor => return String::new(),
        MultiplexIndicator::MultiplexedSignal(selecting) => selecting,
        MultiplexIndicator::MultiplexorAndMultiplexedSignal(_) => {
            panic!(
                "{}.{}: a multiplexed multiplexer",
                message.name, signal.name
            )
        }
    };
    let is_switch = |of: &&Signal| of.multiplexer_indicator == MultiplexIndicator::Multiplexor;
    let switch = message.signals.iter().find(is_switch);
    let switch = switch.unwrap_or_else(|| panic!("{}: no multiplexer", message.name));
    format!(
        "Multiplexer {{ field: {}, ranges: &[({selecting}, {selecting})] }}",
        field(message, switch, "Unsigned")
    )
}
