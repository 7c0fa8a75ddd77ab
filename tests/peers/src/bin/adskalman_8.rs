#![no_std]
#![no_main]

peers::image!(peers::dense::adskalman::<8>(&mut peers::BoardMeter));
