#!/bin/sh
# Runs a fuzzer: run.sh TARGET SECONDS [libFuzzer arguments]
set -eu
target=$1
seconds=$2
shift 2
cd "$(dirname "$0")"
# who writes to a server that has ended gets an error, as in a program of Rust
trap '' PIPE
host=$(rustc -vV | sed -n 's/^host: //p')
mkdir -p "artifacts/$target" "corpus/$target"
exec nice -n 19 "target/$host/release/$target" "corpus/$target" -fork=1 -ignore_crashes=1 -ignore_timeouts=1 \
    -ignore_ooms=1 -timeout=5 -rss_limit_mb=2048 -dict=chain.dict -max_len=12000 -max_total_time="$seconds" \
    -artifact_prefix="artifacts/$target/" -print_final_stats=1 "$@"
