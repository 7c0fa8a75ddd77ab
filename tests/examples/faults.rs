//! draft
use cross_tests::faults::catalogue::catalogue;
use cross_tests::faults::matrix::Subject;
use host_sim::events::events;
fn main() {
    let only = std::env::args().nth(1);
    for (truck, seed) in [("A", 1), ("B", 1)] {
        let subject = Subject::new(truck, seed).unwrap();
        let clean = subject.clean();
        let clean_events = events(&clean.counters);
        eprintln!("{truck} clean {clean_events:?}");
        for fault in catalogue() {
            if only.as_ref().is_some_and(|o| !fault.name.contains(o)) {
                continue;
            }
            let o = subject.with(&fault);
            let c = subject.phases_of(&clean.rows, &fault);
            let p = &o.phases;
            let f = |e: [f64; 3]| format!("{:.3}/{:.3}/{:.3}", e[0], e[1], e[2]);
            let g = |e: [f64; 3]| format!("{:.1}/{:.1}/{:.1}", e[0], e[1], e[2]);
            let moved: Vec<String> = events(&o.counters)
                .into_iter()
                .filter_map(|(n, v)| {
                    let b = clean_events.iter().find(|x| x.0 == n).map_or(0, |x| x.1);
                    (v != b).then(|| format!("{n} {:+}", v as i64 - b as i64))
                })
                .collect();
            println!(
                "{truck} {:45} during {} (clean {}) nees {} (whole {}) after {} (clean {}) sound {} way {:+.0} m cells {:+} | {}",
                fault.name,
                f(p.during.rmse_percent),
                f(c.during.rmse_percent),
                g(p.during.normalised),
                g(p.whole.normalised),
                f(p.after.rmse_percent),
                f(c.after.rmse_percent),
                o.is_sound,
                o.way_m - clean.rows.last().unwrap().distance_m,
                o.cells as i64 - clean.rows.len() as i64,
                moved.join(", ")
            );
        }
    }
}
