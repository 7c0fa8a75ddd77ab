#![no_std]
#![no_main]

peers::image!(peers::minikalman_filter::minikalman_5(
    &mut peers::BoardMeter
));
