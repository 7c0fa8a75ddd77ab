#![no_std]
#![no_main]

peers::image!(peers::dense::nothing(&mut peers::BoardMeter));
