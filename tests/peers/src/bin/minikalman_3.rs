#![no_std]
#![no_main]

peers::image!(peers::minikalman_filter::minikalman_3(
    &mut peers::BoardMeter
));
