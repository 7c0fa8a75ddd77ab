//! CAN frames.

/// A CAN frame for tests.
#[derive(Clone, Debug, PartialEq)]
pub struct TestFrame {
    pub id: embedded_can::Id,
    pub data: Vec<u8>,
    pub remote: bool,
}

impl TestFrame {
    /// Creates a data frame of a parameter group from a source address.
    pub fn of_pgn(pgn: u32, source: u8, data: &[u8]) -> Self {
        let id = (6 << 26) | (pgn << 8) | u32::from(source);
        Self {
            id: embedded_can::ExtendedId::new(id).unwrap().into(),
            data: data.to_vec(),
            remote: false,
        }
    }
}

impl embedded_can::Frame for TestFrame {
    fn new(id: impl Into<embedded_can::Id>, data: &[u8]) -> Option<Self> {
        Some(Self {
            id: id.into(),
            data: data.to_vec(),
            remote: false,
        })
    }
    fn new_remote(id: impl Into<embedded_can::Id>, _dlc: usize) -> Option<Self> {
        Some(Self {
            id: id.into(),
            data: Vec::new(),
            remote: true,
        })
    }
    fn is_extended(&self) -> bool {
        matches!(self.id, embedded_can::Id::Extended(_))
    }
    fn is_remote_frame(&self) -> bool {
        self.remote
    }
    fn id(&self) -> embedded_can::Id {
        self.id
    }
    fn dlc(&self) -> usize {
        self.data.len()
    }
    fn data(&self) -> &[u8] {
        &self.data
    }
}

/// Parameter groups of the transport protocol (SAE J1939-21).
pub const TRANSPORT_MANAGEMENT: u32 = 60_416;
pub const TRANSPORT_DATA: u32 = 60_160;
/// The destination of a broadcast.
pub const TO_ALL: u8 = 255;

/// Returns the frames of a payload that its sender transmits by transport protocol: a broadcast, or
/// a session to one receiver.
pub fn session_of(pgn: u32, source: u8, destination: u8, payload: &[u8]) -> Vec<TestFrame> {
    let to = u32::from(destination);
    let [low, high] = (payload.len() as u16).to_le_bytes();
    let [pgn0, pgn1, pgn2, _] = pgn.to_le_bytes();
    let packets = payload.len().div_ceil(7) as u8;
    let control = if destination == TO_ALL { 32 } else { 16 };
    let announcement = [control, low, high, packets, 0xff, pgn0, pgn1, pgn2];
    let mut frames = vec![TestFrame::of_pgn(
        TRANSPORT_MANAGEMENT | to,
        source,
        &announcement,
    )];
    for (number, part) in (1..).zip(payload.chunks(7)) {
        let mut bytes = vec![number];
        bytes.extend_from_slice(part);
        bytes.resize(8, 0xff);
        frames.push(TestFrame::of_pgn(TRANSPORT_DATA | to, source, &bytes));
    }
    frames
}

/// Returns the frames of a payload: itself, those of a fast packet, or for a group of J1939 those of a
/// broadcast session.
pub fn frames_of(pgn: u32, source: u8, sequence: u8, payload: &[u8]) -> Vec<TestFrame> {
    if payload.len() <= 8 {
        return vec![TestFrame::of_pgn(pgn, source, payload)];
    }
    if pgn < 0x1_0000 {
        return session_of(pgn, source, TO_ALL, payload);
    }
    let mut bytes = vec![sequence << 5, payload.len() as u8];
    bytes.extend_from_slice(&payload[..6]);
    let mut frames = vec![TestFrame::of_pgn(pgn, source, &bytes)];
    for (k, part) in payload[6..].chunks(7).enumerate() {
        let mut bytes = vec![(sequence << 5) | (k as u8 + 1)];
        bytes.extend_from_slice(part);
        bytes.resize(8, 0xff);
        frames.push(TestFrame::of_pgn(pgn, source, &bytes));
    }
    frames
}
