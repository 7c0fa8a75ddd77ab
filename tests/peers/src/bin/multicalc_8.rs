#![no_std]
#![no_main]

peers::image!(peers::dense::multicalc::<8>(&mut peers::BoardMeter));
