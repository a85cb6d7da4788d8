#!/usr/bin/env bash
# Instructions that a point of a grid takes, counted by valgrind, against `benches/instructions.txt`: a rise of more than 3 % fails.
# `benches/instructions.sh --accept` writes today's counts there; the commit that does so says why.
# Counted are repetitions after the first one, in the dev profile, in which the crates that count are optimised as well.
set -euo pipefail
cd "$(dirname "$0")/.."
counts=benches/instructions.txt
most=3 # per cent

if ! command -v valgrind >/dev/null && ! { apt-get update -qq && apt-get install -y -qq valgrind; } >/dev/null 2>&1; then
    echo "skipped: $(grep -c '^[a-z]* [0-9]' $counts) counts of instructions, there is no valgrind" >&2
    exit 0
fi
compiler=$(rustc --version | cut -d ' ' -f 1,2)
if [ "${1:-}" != --accept ] && ! grep -qx "# $compiler" $counts; then
    echo "skipped: $(grep -c '^[a-z]* [0-9]' $counts) counts of instructions, they are of another compiler than $compiler" >&2
    exit 0
fi
cargo build --quiet -p flank-benches --example adapter

run() { # job rows columns repetitions
    valgrind --tool=callgrind --callgrind-out-file=/dev/null target/debug/examples/adapter \
        --job "$1" --n1 "$2" --n2 "$3" --threads 1 --reps "$4" 2>&1 >/dev/null | sed -n 's/.*Collected : //p'
}

fresh=$(mktemp)
trap 'rm -f "$fresh"' EXIT
printf '# %s\n# job rows columns instructions-a-point\n' "$compiler" >"$fresh"
failed=0
while read -r job rows columns before; do
    now=$((($(run "$job" "$rows" "$columns" 6) - $(run "$job" "$rows" "$columns" 1)) / 5 / (rows * columns)))
    echo "$job $rows $columns $now" >>"$fresh"
    if [ $((100 * now)) -gt $(((100 + most) * before)) ]; then
        echo "$job $rows x $columns: $now instructions a point, they were $before" >&2
        failed=1
    fi
done < <(grep -v '^#' $counts)
if [ "${1:-}" = --accept ]; then
    cp "$fresh" $counts
    exit 0
fi
exit $failed
