//! The persistent state: accepted bytes are written back unchanged, and start an estimator.

use crate::truck;
use crc::{CRC_32_ISO_HDLC, Crc};
use estimator_core::{Estimator, PersistentState, Tuning};

/// Checks an input.
pub fn persistent_state(input: &[u8]) {
    let Some((corrects, bytes)) = input.split_first() else {
        return;
    };
    let mut bytes = bytes.to_vec();
    if corrects & 1 != 0
        && let Some((content, checksum)) = bytes.split_last_chunk_mut()
    {
        // With a right checksum the content is checked, too.
        *checksum = Crc::<u32>::new(&CRC_32_ISO_HDLC)
            .checksum(content)
            .to_le_bytes();
    }
    if let Ok(kept) = PersistentState::from_bytes(&bytes) {
        assert_eq!(kept.to_bytes().as_slice(), bytes);
        if let Ok(estimator) = Estimator::<f32>::restore(truck(), Tuning::default(), &kept) {
            assert!(estimator.live().is_none());
        }
    }
}
