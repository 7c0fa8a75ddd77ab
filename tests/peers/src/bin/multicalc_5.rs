#![no_std]
#![no_main]

peers::image!(peers::dense::multicalc::<5>(&mut peers::BoardMeter));
