//! The estimator on an STM32G474 (Nucleo-G474RE with two CAN transceivers).
//!
//! | pin        | what                                                                        |
//! |------------|-----------------------------------------------------------------------------|
//! | PA11, PA12 | FDCAN1 RX, TX: the vehicle's bus, 250 kbit/s; the estimate is sent here     |
//! | PB12, PB13 | FDCAN2 RX, TX: GNSS by NMEA 2000, 250 kbit/s                                |
//! | PC11       | with the feature `gnss-serial`, USART3 RX: NMEA 0183, 9600 baud, instead    |
//!
//! An interrupt puts the frames of the controllers into a queue ([`bus`]). The estimator reads them
//! in thread mode ([`work`]). It sends its estimate ten times a second, and stores the persistent
//! state in flash when the vehicle stands ([`store`]). With a map in flash, the
//! estimate is combined with it, and the road ahead is sent as PCC1 and as a profile. The watchdog resets the board if a turn of
//! this loop takes more than half a second.

#![no_std]
#![no_main]

mod bus;
#[cfg(feature = "gnss-serial")]
mod gnss;
mod inbox;
mod store;
mod work;

use defmt_rtt as _;
use embassy_executor::{InterruptExecutor, Spawner};
use embassy_stm32::can::{self, CanConfigurator};
use embassy_stm32::interrupt;
use embassy_stm32::interrupt::{InterruptExt, Priority};
use embassy_stm32::peripherals::{FDCAN1, FDCAN2};
use embassy_stm32::rcc::{
    Hse, HseMode, Pll, PllMul, PllPreDiv, PllQDiv, PllRDiv, PllSource, Sysclk, mux,
};
use embassy_stm32::time::Hertz;
#[cfg(feature = "gnss-serial")]
use embassy_stm32::usart::UartRx;
use embassy_stm32::wdg::IndependentWatchdog;
use embassy_stm32::{Config, bind_interrupts};
use panic_probe as _;

/// Longest time for a turn of the estimator's loop.
const WATCHDOG_US: u32 = 500_000;

bind_interrupts!(struct Irqs {
    FDCAN1_IT0 => can::IT0InterruptHandler<FDCAN1>;
    FDCAN1_IT1 => can::IT1InterruptHandler<FDCAN1>;
    FDCAN2_IT0 => can::IT0InterruptHandler<FDCAN2>;
    FDCAN2_IT1 => can::IT1InterruptHandler<FDCAN2>;
});

#[cfg(feature = "gnss-serial")]
bind_interrupts!(struct SerialIrqs {
    USART3 => embassy_stm32::usart::InterruptHandler<embassy_stm32::peripherals::USART3>;
    DMA1_CHANNEL1 => embassy_stm32::dma::InterruptHandler<embassy_stm32::peripherals::DMA1_CH1>;
});

/// Runs the receiving tasks, which must not wait for the estimator.
static RECEIVING: InterruptExecutor = InterruptExecutor::new();

/// Runs [`RECEIVING`], on an interrupt that no peripheral here uses.
#[embassy_stm32::interrupt]
#[allow(unsafe_code)]
fn UART4() {
    // SAFETY: called only from the interrupt that was passed to `start`.
    unsafe { RECEIVING.on_interrupt() }
}

#[embassy_executor::main]
async fn main(_spawner: Spawner) {
    let p = embassy_stm32::init(clocks());
    let watchdog = IndependentWatchdog::new(p.IWDG, WATCHDOG_US);
    let mut store = store::FlashStore::new(p.FLASH);
    let estimator = work::estimator(&mut store).await;
    let on_map = work::on_map();

    let (sender, receiver) = inbox::open();
    interrupt::UART4.set_priority(Priority::P6);
    let receiving = RECEIVING.start(interrupt::UART4);
    let can = CanConfigurator::new(p.FDCAN1, p.PA11, p.PA12, Irqs);
    let (outgoing, incoming, vehicle_bus) = bus::configure(can).split();
    receiving.spawn(defmt::unwrap!(bus::receive(incoming, sender)));
    #[cfg(not(feature = "gnss-serial"))]
    {
        let can = CanConfigurator::new(p.FDCAN2, p.PB12, p.PB13, Irqs);
        let (_, incoming, _) = bus::configure(can).split();
        receiving.spawn(defmt::unwrap!(bus::receive(incoming, sender)));
    }
    #[cfg(feature = "gnss-serial")]
    {
        let mut config = embassy_stm32::usart::Config::default();
        config.baudrate = 9_600;
        let line = UartRx::new(p.USART3, p.PC11, p.DMA1_CH1, SerialIrqs, config);
        receiving.spawn(defmt::unwrap!(gnss::receive(defmt::unwrap!(line), sender)));
    }

    work::run(
        estimator,
        on_map,
        receiver,
        outgoing,
        vehicle_bus,
        store,
        watchdog,
    )
    .await
}

/// Returns a clock of 170 MHz from the crystal of the board. The internal oscillator is not
/// accurate enough for CAN.
fn clocks() -> Config {
    let mut config = Config::default();
    config.rcc.hse = Some(Hse {
        freq: Hertz(24_000_000),
        mode: HseMode::Oscillator,
    });
    config.rcc.pll = Some(Pll {
        source: PllSource::HSE,
        prediv: PllPreDiv::DIV6,
        mul: PllMul::MUL85,
        divp: None,
        divq: Some(PllQDiv::DIV8),
        divr: Some(PllRDiv::DIV2),
    });
    config.rcc.mux.fdcansel = mux::Fdcansel::HSE;
    config.rcc.boost = true;
    config.rcc.sys = Sysclk::PLL1_R;
    config
}
