#![no_std]
#![no_main]

peers::image!(peers::dense::kfilter::<5>(&mut peers::BoardMeter));
