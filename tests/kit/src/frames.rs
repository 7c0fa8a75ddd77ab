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

/// Returns the frames of a payload: itself, or its fast-packet frames.
pub fn frames_of(pgn: u32, source: u8, sequence: u8, payload: &[u8]) -> Vec<TestFrame> {
    if payload.len() <= 8 {
        return vec![TestFrame::of_pgn(pgn, source, payload)];
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
