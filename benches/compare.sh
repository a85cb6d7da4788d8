#!/usr/bin/env bash
# flank beside hand-written C++ and CasADi on the common job, beside hand-written C++ and SymPy on the second one, run in turns, and beside
# SciPy and CasADi on the contact of a pair: `benches/compare.sh [repetitions]`. Needs g++, and for CasADi (the flank alone), SymPy and SciPy
# python3 with venv and pip. Prints nanoseconds a point (the fastest repetition), shares of the hand-written program's time, and of the second
# job how far the positions of others are from flank's.
set -euo pipefail
cd "$(dirname "$0")/.."
repetitions=${1:-15}
work=$(mktemp -d)
trap 'rm -rf "$work"' EXIT

for peer in spiral_bevel helical_zi; do
    g++ -std=c++17 -O3 -march=native -ffp-contract=fast -fno-math-errno benches/peers/$peer.cpp -o "$work/$peer"
done
cargo build --quiet --release -p flank-benches --example adapter
flank=target/release/examples/adapter

casadi=
python=
if python3 -m venv "$work/venv" && "$work/venv/bin/pip" install --quiet casadi numpy scipy sympy; then
    python="$work/venv/bin/python"
    casadi="$python benches/peers/spiral_bevel_casadi.py"
else
    echo "without CasADi, SymPy and SciPy: they cannot be installed" >&2
fi

# the fastest of the times that a run prints, in nanoseconds a point
fastest() { # points command…
    local points=$1
    shift
    "$@" | sed 's/.*"solve_s":\[\([^]]*\)\].*/\1/' | tr ',' '\n' | sort -g | head -n 1 | awk -v n="$points" '{ printf "%.2f", $1 * 1e9 / n }'
}

printf '%-16s %8s %10s %10s %8s %10s %8s\n' job threads peer flank share casadi share
for case in "flank 31 61" "flank 501 501" "grid 501 501" "grid 1000 1000"; do
    read -r job rows columns <<<"$case"
    for threads in 1 2; do
        arguments=(--job "$job" --n1 "$rows" --n2 "$columns" --reps "$repetitions")
        points=$((rows * columns))
        before=$(fastest $points "$work/spiral_bevel" "${arguments[@]}")
        ours=$(fastest $points "$flank" "${arguments[@]}" --threads $threads)
        after=$(fastest $points "$work/spiral_bevel" "${arguments[@]}")
        theirs=
        if [ -n "$casadi" ] && [ $threads = 1 ] && [ "$job" = flank ]; then
            theirs=$(fastest $points $casadi --job flank --n1 "$rows" --n2 "$columns" --reps 3)
        fi
        awk -v a="$before" -v b="$after" -v f="$ours" -v c="$theirs" -v g="$job ${rows}x$columns" -v t="$threads" 'BEGIN {
            p = (a + b) / 2
            printf "%-16s %8d %10.1f %10.1f %8.2f", g, t, p, f, f / p
            printf(c == "" ? "\n" : " %10.1f %8.2f\n", c, c / p)
        }'
    done
done

# the second job: a helical gear by a ZI hob over two motions
sympy=
[ -n "$python" ] && $python benches/peers/helical_zi_sympy.py "$work/sympy" && sympy="$work/sympy"

# the largest distance along an axis between positions, mm; a point is ten numbers, of which four are its unknowns
apart() { # file file
    paste <(od -An -v -t f8 -w80 "$1") <(od -An -v -t f8 -w80 "$2") | awk '
        function off(a) { return a < 0 ? -a : a }
        { for (k = 5; k <= 7; k++) if (!(off($k - $(k + 10)) <= most)) most = off($k - $(k + 10)) }
        END { printf "%.1e", most }'
}

printf '\n%-18s %8s %8s %8s %8s %8s %8s %8s  %s\n' job newton flank share closed share sympy share 'off, mm'
for case in "31 61" "501 501"; do
    read -r rows columns <<<"$case"
    arguments=(--job helical --n1 "$rows" --n2 "$columns" --reps "$repetitions")
    points=$((rows * columns))
    before=$(fastest $points "$work/helical_zi" "${arguments[@]}" --out "$work/newton.bin")
    ours=$(fastest $points "$flank" "${arguments[@]}" --threads 1 --out "$work/flank.bin")
    closed=$(fastest $points "$work/helical_zi" "${arguments[@]}" --variant closed --out "$work/closed.bin")
    theirs=
    [ -z "$sympy" ] || theirs=$(fastest $points "$sympy" "${arguments[@]}" --out "$work/sympy.bin")
    after=$(fastest $points "$work/helical_zi" "${arguments[@]}")
    off=
    for other in newton closed ${sympy:+sympy}; do off+=" $other $(apart "$work/$other.bin" "$work/flank.bin")"; done
    awk -v a="$before" -v b="$after" -v f="$ours" -v c="$closed" -v s="$theirs" -v g="helical ${rows}x$columns" -v o="$off" 'BEGIN {
        p = (a + b) / 2
        printf "%-18s %8.1f %8.1f %8.2f %8.1f %8.2f", g, p, f, f / p, c, c / p
        printf(s == "" ? " %8s %8s" : " %8.1f %8.2f", s, s == "" ? "" : s / p)
        print " " o
    }'
done

# milliseconds for the contact of 101 positions; flank's is the line `path_101`
if [ -n "$python" ]; then
    for peer in scipy casadi; do
        awk -v p="$peer" -v t="$(fastest 101 $python benches/peers/contact.py --peer $peer)" 'BEGIN { printf "contact by %s: %.2f ms\n", p, t * 101 / 1e6 }'
    done
fi
cargo bench --quiet -p flank-benches --bench contact -- path_101
