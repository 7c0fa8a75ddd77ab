#![no_std]
#![no_main]

peers::image!(peers::dense::plain_nalgebra::<8>(&mut peers::BoardMeter));
