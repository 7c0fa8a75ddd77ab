#![no_std]
#![no_main]

peers::image!(peers::dense::kfilter::<3>(&mut peers::BoardMeter));
