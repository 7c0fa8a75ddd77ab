#![no_std]
#![no_main]

peers::image!(peers::minikalman!(8));
