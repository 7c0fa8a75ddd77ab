//! Data that outlast a power cycle, in the last 16 KB of flash.
//!
//! | offset   | length | what                                                                     |
//! |----------|--------|--------------------------------------------------------------------------|
//! | 0x7_C000 | 2 KB   | the vehicle, flashed from a host, see [`estimator_core::packed_vehicle`]    |
//! | 0x7_D000 | 12 KB  | the persistent state, written in turns to all pages for even wear        |
//!
//! The data are in the second bank of the flash and the image is in the first, so that the image
//! runs while a page is erased. A map before the data is read between two erasures: the loop that
//! reads it waits for them.

use embassy_embedded_hal::adapter::BlockingAsync;
use embassy_stm32::Peri;
use embassy_stm32::flash::{Blocking, Flash};
use embassy_stm32::peripherals::FLASH;
use estimator_core::packed_vehicle::{self, PackedVehicleError, VEHICLE_BYTES};
use estimator_core::{Model, PersistentState};
use sequential_storage::cache::{Cache, Uncached};
use sequential_storage::map::{MapConfig, MapStorage};

const VEHICLE_OFFSET: u32 = 0x7_C000;
const KEPT_RANGE: core::ops::Range<u32> = 0x7_D000..0x8_0000;
/// Key of the only item.
const KEPT_KEY: u8 = 0;
/// Size of the item with its key, bytes.
const BUFFER: usize = 128;

type Storage = MapStorage<
    u8,
    BlockingAsync<Flash<'static, Blocking>>,
    Cache<Uncached, Uncached, Uncached, u8>,
>;

/// The flash behind the image.
pub struct FlashStore {
    model: Result<Model, PackedVehicleError>,
    states: Storage,
}

impl FlashStore {
    /// Reads the vehicle.
    pub fn new(flash: Peri<'static, FLASH>) -> Self {
        let mut flash = Flash::new_blocking(flash);
        let mut header = [0; VEHICLE_BYTES];
        let model = flash
            .blocking_read(VEHICLE_OFFSET, &mut header)
            .map_err(|_| PackedVehicleError::Length)
            .and_then(|()| packed_vehicle::decode(&header));
        let config = MapConfig::new(KEPT_RANGE);
        Self {
            model,
            states: MapStorage::new(BlockingAsync::new(flash), config, Cache::new_uncached()),
        }
    }

    /// Returns the flashed vehicle.
    ///
    /// # Errors
    /// None was flashed, or this release refuses it.
    pub fn model(&self) -> Result<&Model, PackedVehicleError> {
        self.model.as_ref().map_err(|error| *error)
    }

    /// Returns the persistent state of the last drive; `None` if there is no valid one.
    pub async fn persistent_state(&mut self) -> Option<PersistentState> {
        let mut buffer = [0; BUFFER];
        let bytes: &[u8] = self
            .states
            .fetch_item(&mut buffer, &KEPT_KEY)
            .await
            .ok()??;
        PersistentState::from_bytes(bytes).ok()
    }

    /// Stores the persistent state of this drive. Returns false if the flash refuses it.
    pub async fn save(&mut self, state: &PersistentState) -> bool {
        let mut buffer = [0; BUFFER];
        let bytes: [u8; PersistentState::LEN] = state.to_bytes();
        let stored = self
            .states
            .store_item(&mut buffer, &KEPT_KEY, &bytes.as_slice())
            .await;
        stored.is_ok()
    }
}
