//! The work of a host on a drive.

use benches::work::Work;
use criterion::{Criterion, Throughput, criterion_group, criterion_main};

fn drive(criterion: &mut Criterion) {
    let work = Work::prepare().expect("room for a drive");
    let mut group = criterion.benchmark_group("drive");
    group.sample_size(20);
    for mut job in work.jobs() {
        group.throughput(Throughput::Elements(job.units as u64));
        group.bench_function(job.name, |bencher| bencher.iter(&mut job.run));
    }
}

criterion_group!(benches, drive);
criterion_main!(benches);
