#![no_std]
#![no_main]

peers::image!(peers::dense::adskalman::<3>(&mut peers::BoardMeter));
