#![no_std]
#![no_main]

peers::image!(peers::dense::multicalc::<3>(&mut peers::BoardMeter));
