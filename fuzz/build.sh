#!/bin/sh
# Builds the fuzzers with coverage counters on the stable toolchain. No build script is instrumented, since `--target` keeps
# the flags from them.
set -eu
cd "$(dirname "$0")"
passes="-Cpasses=sancov-module -Cllvm-args=-sanitizer-coverage-level=4 \
-Cllvm-args=-sanitizer-coverage-inline-8bit-counters -Cllvm-args=-sanitizer-coverage-pc-table \
-Cllvm-args=-sanitizer-coverage-trace-compares"
host=$(rustc -vV | sed -n 's/^host: //p')
RUSTFLAGS="$passes --cfg fuzzing" cargo build --release --target "$host" "$@"
