#!/usr/bin/env bash
# flank beside hand-written C++ on the common job, run in turns: `benches/compare.sh [repetitions]`. Needs g++.
# Prints nanoseconds a point (the fastest repetition) and flank's share of the hand-written program's time.
set -euo pipefail
cd "$(dirname "$0")/.."
repetitions=${1:-15}
work=$(mktemp -d)
trap 'rm -rf "$work"' EXIT

g++ -std=c++17 -O3 -march=native -ffp-contract=fast -fno-math-errno benches/peers/spiral_bevel.cpp -o "$work/peer"
cargo build --quiet --release -p flank-benches --example adapter
flank=target/release/examples/adapter

# the fastest of the times that a run prints, in nanoseconds a point
fastest() { # points command…
    local points=$1
    shift
    "$@" | sed 's/.*"solve_s":\[\([^]]*\)\].*/\1/' | tr ',' '\n' | sort -g | head -n 1 | awk -v n="$points" '{ printf "%.2f", $1 * 1e9 / n }'
}

printf '%-10s %8s %10s %10s %8s\n' grid threads peer flank share
for size in "31 61" "501 501"; do
    read -r rows columns <<<"$size"
    for threads in 1 2; do
        arguments=(--job flank --n1 "$rows" --n2 "$columns" --reps "$repetitions")
        points=$((rows * columns))
        before=$(fastest $points "$work/peer" "${arguments[@]}" --out "$work/peer.bin")
        ours=$(fastest $points "$flank" "${arguments[@]}" --threads $threads --out "$work/flank.bin")
        after=$(fastest $points "$work/peer" "${arguments[@]}")
        awk -v a="$before" -v b="$after" -v f="$ours" -v g="${rows}x$columns" -v t="$threads" \
            'BEGIN { p = (a + b) / 2; printf "%-10s %8d %10.1f %10.1f %8.2f\n", g, t, p, f, f / p }'
    done
done
