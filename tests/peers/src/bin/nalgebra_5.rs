#![no_std]
#![no_main]

peers::image!(peers::dense::plain_nalgebra::<5>(&mut peers::BoardMeter));
