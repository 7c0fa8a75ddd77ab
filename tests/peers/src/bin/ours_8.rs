#![no_std]
#![no_main]

peers::image!(peers::ours::ours(&mut peers::BoardMeter));
