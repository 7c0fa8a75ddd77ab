use estimator_core::*;
use host_sim::files::vehicle::VehicleFile;
use host_sim::source::input::{LogInput, for_each_input};
fn main() {
    let a: Vec<String> = std::env::args().collect();
    let v = VehicleFile::read(a[1].as_ref()).unwrap();
    let tuning = match a.get(6) {
        Some(t) => host_sim::files::tuning::read_or_default(Some(t.as_ref())).unwrap(),
        None => Tuning::default(),
    };
    let mut e = Estimator::<f64>::new(v.model.clone(), tuning).unwrap();
    let (from, to): (f64, f64) = (a[3].parse().unwrap(), a[4].parse().unwrap());
    let every: u32 = a[5].parse().unwrap();
    for_each_input(a[2].as_ref(), |_| (), |i| {
        if let LogInput::Frame(f) = i { e.on_frame(f.time, &f.frame); }
        while e.step().is_some() {
            while e.next_cell().is_some() {}
            let l = e.live().unwrap();
            let d = l.end.distance_m();
            if d >= from && d <= to && l.end.cell % every == 0 {
                let s = e.sample().unwrap();
                let c = l.end.condition;
                println!("{d:.1} v {:.2} valid {} F {:.0} slope {:.2}±{:.2} bias {:.3}±{:.3} scale {:.3}±{:.3} z {:?}", l.end.speed_mps, u8::from(c.is_valid()), s.forces.traction_n, l.estimate.grade_percent.value, l.estimate.grade_percent.sigma, l.estimate.bias_percent.value, l.estimate.bias_percent.sigma, l.estimate.scale.value, l.estimate.scale.sigma, l.estimate.altitude_m.map(|z| z.value));
            }
        }
    }).unwrap();
    println!("{:?} {:?}", e.noise(), e.counters());
}
