#![no_std]
#![no_main]

peers::image!(peers::dense::plain_nalgebra::<3>(&mut peers::BoardMeter));
