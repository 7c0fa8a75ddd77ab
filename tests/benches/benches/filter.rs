//! A filter step: ours with all its states, peers of the same size and smaller.

use benches::{double, single};
use criterion::measurement::WallTime;
use criterion::{BenchmarkGroup, BenchmarkId, Criterion, criterion_group, criterion_main};

/// A filter on criterion's bench.
struct OnBench<'a, 'b> {
    group: &'a mut BenchmarkGroup<'b, WallTime>,
    name: &'static str,
    states: usize,
}

macro_rules! bench {
    ($name:ident, $precision:ident) => {
        impl $precision::model::Meter for OnBench<'_, '_> {
            fn measure<const N: usize>(
                &mut self,
                _: usize,
                mut step: impl FnMut([$precision::Real; 2]) -> [$precision::Real; N],
            ) {
                let mut number = 0;
                let id = BenchmarkId::new(self.name, self.states);
                self.group.bench_function(id, |bencher| {
                    bencher.iter(|| {
                        number += 1;
                        step($precision::model::measurements(number))
                    });
                });
            }
        }

        fn $name(criterion: &mut Criterion) {
            let mut group = criterion.benchmark_group(stringify!($name));
            for contender in $precision::contenders::<OnBench<'_, '_>>() {
                (contender.measure)(&mut OnBench {
                    group: &mut group,
                    name: contender.name,
                    states: contender.states,
                });
            }
        }
    };
}

bench!(step_f32, single);
bench!(step_f64, double);

criterion_group!(filter, step_f32, step_f64);
criterion_main!(filter);
