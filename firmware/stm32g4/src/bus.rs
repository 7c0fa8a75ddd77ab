//! CAN controllers: their configuration, and the reception of frames.

use crate::inbox::{InboxItem, InboxSender};
use embassy_stm32::can::filter::{ExtendedFilter, StandardFilter};
use embassy_stm32::can::{Can, CanConfigurator, CanRx, filter};
use embassy_time::{Duration, Timer};
use estimator_core::Instant;

/// Bit rate of J1939-11 and NMEA 2000.
const BITS_PER_SECOND: u32 = 250_000;
/// Pause after an error of the bus. The error may last, and handling it without a pause would leave
/// no time for anything else.
const AFTER_ERROR: Duration = Duration::from_millis(10);

/// Configures a controller to accept all frames with 29-bit identifiers, which J1939 and NMEA 2000
/// use. It recovers from bus-off by itself, as ISO 11898-1 allows: after 128 times eleven recessive
/// bits.
pub fn configure(mut can: CanConfigurator<'static>) -> Can<'static> {
    let properties = can.properties();
    properties.set_standard_filter(filter::StandardFilterSlot::_0, StandardFilter::reject_all());
    properties.set_extended_filter(
        filter::ExtendedFilterSlot::_0,
        ExtendedFilter::accept_all_into_fifo0(),
    );
    let config = can.config().set_automatic_bus_off_recovery(true);
    can.set_config(config);
    can.set_bitrate(BITS_PER_SECOND);
    can.into_normal_mode()
}

/// Puts the frames of a controller into the inbox, forever.
#[embassy_executor::task(pool_size = 2)]
pub async fn receive(mut can: CanRx<'static>, inbox: &'static InboxSender) {
    loop {
        match can.read().await {
            Ok(envelope) => {
                let (frame, time) = envelope.parts();
                let time = Instant::from_micros(time.as_micros());
                inbox.put(InboxItem::Frame(time, frame));
            }
            Err(error) => {
                defmt::debug!("bus error: {}", error);
                Timer::after(AFTER_ERROR).await;
            }
        }
    }
}
