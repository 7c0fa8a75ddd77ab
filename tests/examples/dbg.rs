use cross_tests::faults::catalogue::catalogue;
use cross_tests::faults::drive::drive;
use estimator_core::{Estimator, Tuning};
fn main() {
    let run = drive("B", 1).unwrap();
    let f = catalogue().into_iter().find(|f| f.name.contains("there before")).unwrap();
    let mut e = Estimator::<f32>::new(run.vehicle.parameters.clone(), Tuning::default()).unwrap();
    let mut n = 0;
    for t in f.heard(&run.frames) {
        e.on_frame(t.time, &t.frame);
        while let Some(s) = e.step() {
            n += 1;
            if (30..75).contains(&n) {
                let l = e.live().unwrap(); let sm = e.sample().unwrap();
                println!("{n} {s:?} v {:.2} sp {:?} F {:.0} m {:.0} scale {:.3}±{:.3} bias {:.2}±{:.2} grade {:.2}±{:.2} alt {:?} fix {:?} inv {} steps {}", l.estimate.speed_mps, sm.speed.map(|s| (s.mean_mps, s.count)), sm.load.traction_n, sm.load.mass_kg, l.estimate.scale.value, l.estimate.scale.sigma, l.estimate.bias_percent.value, l.estimate.bias_percent.sigma, l.estimate.grade_percent.value, l.estimate.grade_percent.sigma, l.estimate.altitude_m.map(|a| a.value), sm.altitude.map(|a| (a.altitude_m, a.continuity)), sm.place.condition.is_valid(), e.counters().speed_steps);
            }
        }
    }
}
