//! A filter step: ours with all its states, and peers of the same size and smaller.

use benches::stopwatch::{STEPS, Stopwatch};
use benches::{Contender, double, single};
use criterion::{BenchmarkId, Criterion, criterion_group, criterion_main};
use std::time::Duration;

fn filter(criterion: &mut Criterion) {
    bench(criterion, "step_f32", &single::contenders());
    bench(criterion, "step_f64", &double::contenders());
}

fn bench(criterion: &mut Criterion, name: &str, contenders: &[Contender<Stopwatch>]) {
    let mut group = criterion.benchmark_group(name);
    for contender in contenders {
        let id = BenchmarkId::new(contender.name, contender.states);
        group.bench_function(id, |bencher| {
            bencher.iter_custom(|steps| {
                let drives = steps.div_ceil(STEPS.into());
                let mut sum_ns = 0.0;
                for _ in 0..drives {
                    let mut watch = Stopwatch::new(STEPS);
                    (contender.measure)(&mut watch);
                    sum_ns += watch.step_ns;
                }
                Duration::from_nanos((sum_ns / drives as f64 * steps as f64) as u64)
            });
        });
    }
}

criterion_group!(benches, filter);
criterion_main!(benches);
