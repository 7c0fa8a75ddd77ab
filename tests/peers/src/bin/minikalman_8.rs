#![no_std]
#![no_main]

peers::image!(peers::minikalman_filter::minikalman_8(
    &mut peers::BoardMeter
));
