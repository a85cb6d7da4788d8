//! Benchmarks: `cargo bench -p flank-benches`.
