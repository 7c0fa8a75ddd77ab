//! Sessions of the transport protocol.

use arbitrary::{Arbitrary, Unstructured};
use fuzz_targets::sessions::Packet;

/// Returns sessions of the engine, and of others beside it.
pub fn of_transport() -> Vec<(&'static str, Vec<Packet>)> {
    let engine = session(0, true, 3);
    let others: Vec<Packet> = [
        session(1, true, 3),
        session(2, true, 9),
        session(4, false, 0),
    ]
    .concat();
    let mixed = engine.iter().zip(&others).flat_map(|(a, b)| [*a, *b]);
    vec![
        ("a_broadcast", engine.clone()),
        ("a_session_to_one", session(4, false, 0)),
        ("another_group", session(0, true, 15)),
        ("sessions_of_two", mixed.collect()),
        ("a_packet_is_missing", [&engine[..3], &engine[4..]].concat()),
        (
            "every_packet_twice",
            engine.iter().flat_map(|of| [*of, *of]).collect(),
        ),
        (
            "two_in_a_row",
            [engine.clone(), session(0, true, 9)].concat(),
        ),
    ]
}

/// Returns a session of 39 bytes. `number` chooses control byte and group.
fn session(source: u8, to_all: bool, number: u8) -> Vec<Packet> {
    let announcement = Packet {
        source,
        to_all,
        wait_ms: 60,
        is_data: false,
        number,
        length: 39,
        more_packets: 0,
        size: 8,
        data: [0; 7],
    };
    let parts = (1..=6).map(|number| Packet {
        is_data: true,
        number,
        data: [number, source, 2, 3, 4, 5, 6],
        ..announcement
    });
    [announcement].into_iter().chain(parts).collect()
}

/// Returns the bytes of which `arbitrary` makes these packets.
///
/// # Panics
/// Panics if `arbitrary` makes other packets of them.
pub fn encoded_packets(packets: &[Packet]) -> Vec<u8> {
    let mut bytes = Vec::new();
    for packet in packets {
        // Another packet follows.
        bytes.extend([1, packet.source, u8::from(packet.to_all)]);
        bytes.extend(packet.wait_ms.to_le_bytes());
        bytes.extend([u8::from(packet.is_data), packet.number]);
        bytes.extend(packet.length.to_le_bytes());
        bytes.extend([packet.more_packets, packet.size]);
        bytes.extend(packet.data);
    }
    let decoded = Vec::<Packet>::arbitrary_take_rest(Unstructured::new(&bytes)).expect("packets");
    assert_eq!(format!("{decoded:?}"), format!("{packets:?}"));
    bytes
}
