#![no_std]
#![no_main]

peers::image!(peers::dense::kfilter::<8>(&mut peers::BoardMeter));
