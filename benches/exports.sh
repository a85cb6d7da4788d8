#!/usr/bin/env bash
# Files of a large grid, whole processes: `benches/exports.sh [points on a side] [flank] [repetitions]`. Of each format the time from
# the start of the process to the written file (the fastest repetition), the processors' time, the peak of resident memory, and the file's
# size. Needs GNU time.
set -euo pipefail
cd "$(dirname "$0")/.."
side=${1:-1000}
flank=${2:-target/release/flank}
repetitions=${3:-3}
work=$(mktemp -d)
trap 'rm -rf "$work"' EXIT

printf '%-8s %8s %8s %11s %9s\n' format s 'CPU s' 'memory MiB' 'file MB'
for format in csv json parquet stl obj 3mf vtp step; do
    what=(--format "$format")
    # the points of a face are its own; the smallest file beside it
    [ $format = step ] && what=(--format stl --step)
    for _ in $(seq "$repetitions"); do
        /usr/bin/time -f '%e %U %S %M' -a -o "$work/$format.times" "$flank" solve benches/spiral_bevel.chain --job flank \
            --set "rows=$side" --set "columns=$side" "${what[@]}" --no-picture --out "$work" >/dev/null 2>&1
    done
    read -r seconds user system kibibytes <<<"$(sort -g "$work/$format.times" | head -n 1)"
    bytes=$(stat -c %s "$work/flank.$format")
    awk -v f=$format -v s="$seconds" -v u="$user" -v y="$system" -v k="$kibibytes" -v b="$bytes" \
        'BEGIN { printf "%-8s %8.2f %8.2f %11.0f %9.1f\n", f, s, u + y, k / 1024, b / 1e6 }'
done
