#!/usr/bin/env bash
# Instructions that a point of a grid, of slow surfaces of the library, a part of a contact, a whole process and the index of names take,
# counted by valgrind, against `benches/instructions.txt`: a rise of more than 3 % fails. `benches/instructions.sh --accept` writes today's
# counts there; the commit that does so says why.
# Counted are repetitions after the first one, of grids after twelve, when the machine code of large ones has been laid out anew; and
# processes from their start to the written CSV file, in the dev profile: expressions and solver are optimised there, reading and writing
# are not.
set -euo pipefail
cd "$(dirname "$0")/.."
counts=benches/instructions.txt
most=3 # per cent

if ! command -v valgrind >/dev/null && ! { apt-get update -qq && apt-get install -y -qq valgrind; } >/dev/null 2>&1; then
    echo "skipped $(grep -vc '^#' $counts) counts of instructions: there is no valgrind" >&2
    exit 0
fi
compiler=$(rustc --version | cut -d ' ' -f 1,2)
if [ "${1:-}" != --accept ] && ! grep -qx "# $compiler" $counts; then
    echo "skipped $(grep -vc '^#' $counts) counts of instructions: they are of another compiler than $compiler" >&2
    exit 0
fi
# incremental builds have more and smaller units of code, 1 % more instructions
export CARGO_INCREMENTAL=0
cargo build --quiet -p flank-benches --examples
cargo build --quiet --workspace --bin flank

run() { # job rows columns repetitions
    valgrind --tool=callgrind --callgrind-out-file=/dev/null target/debug/examples/adapter \
        --job "$1" --n1 "$2" --n2 "$3" --threads 1 --reps "$4" 2>&1 >/dev/null | sed -n 's/.*Collected : //p'
}

rolling() { # job repetitions
    RAYON_NUM_THREADS=1 valgrind --tool=callgrind --callgrind-out-file=/dev/null target/debug/examples/rolling "$1" "$2" 2>&1 >/dev/null |
        sed -n 's/.*Collected : //p'
}

resampled() { # surface side repetitions
    RAYON_NUM_THREADS=1 valgrind --tool=callgrind --callgrind-out-file=/dev/null target/debug/examples/resampled_once "$@" 2>&1 >/dev/null |
        sed -n 's/.*Collected : //p'
}

process() { # name
    local counted=()
    case $1 in
        reading) set -- check specs/bevel/pinion_19x62.chain ;;
        # of these what the index of names takes: 4 % of the dev profile's instructions, 1 % of a release build's
        names)
            counted=(--toggle-collect='*::Index::of_files' --toggle-collect='*::Context::known_values')
            set -- check specs/bevel/pinion_19x62.chain
            ;;
        surface) set -- solve benches/spiral_bevel.chain --job flank ;;
        contact) set -- contact specs/pairs/bevel_19x62.chain ;;
        ease_off) set -- deviation specs/bevel/ease_off_19x62.chain pinion.concave --reference conjugate.concave ;;
        *) echo "no process is called $1" >&2; return 1 ;;
    esac
    [ "$1" = check ] || set -- "$@" --no-picture --out "$out"
    RAYON_NUM_THREADS=1 valgrind --tool=callgrind --callgrind-out-file=/dev/null "${counted[@]}" target/debug/flank "$@" 2>&1 >/dev/null |
        sed -n 's/.*Collected : //p'
}

fresh=$(mktemp)
out=$(mktemp -d)
trap 'rm -rf "$fresh" "$out"' EXIT
printf '# %s\n# job rows columns instructions-a-point, surface resampled side instructions-a-point, part contact - thousands, process - - thousands\n' "$compiler" >"$fresh"
failed=0
while read -r job rows columns before; do
    if [ "$rows" = - ]; then
        what=$job unit="thousand instructions"
        now=$(process "$job") || {
            echo "$job: flank fails under valgrind; if it meets an illegal instruction, \`cargo clean -p core-math-sys\` and build again" >&2
            exit 1
        }
        now=$((now / 1000))
    elif [ "$rows" = contact ]; then
        what="$job of a contact" unit="thousand instructions"
        # a process differs from the next by some 60,000 instructions: short parts are repeated more often
        more=$([ "$job" = vertex ] && echo 30 || echo 3)
        now=$((($(rolling "$job" $((more + 1))) - $(rolling "$job" 1)) / more / 1000))
    elif [ "$rows" = resampled ]; then
        what="$job, $columns x $columns" unit="instructions a point"
        now=$((($(resampled "$job" "$columns" 3) - $(resampled "$job" "$columns" 1)) / 2 / (columns * columns)))
    else
        what="$job $rows x $columns" unit="instructions a point"
        now=$((($(run "$job" "$rows" "$columns" 17) - $(run "$job" "$rows" "$columns" 12)) / 5 / (rows * columns)))
    fi
    echo "$job $rows $columns $now" >>"$fresh"
    if [ $((100 * now)) -gt $(((100 + most) * before)) ]; then
        echo "$what: $now $unit, they were $before" >&2
        failed=1
    fi
done < <(grep -v '^#' $counts)
if [ "${1:-}" = --accept ]; then
    cp "$fresh" $counts
    exit 0
fi
exit $failed
