#![no_std]
#![no_main]

peers::image!(peers::dense::adskalman::<5>(&mut peers::BoardMeter));
