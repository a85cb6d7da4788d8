#!/usr/bin/env bash
# Records what every command prints and writes, over every shipped spec and every documented error: stdout, stderr, exit code, and the
# hashes of the files. A change that keeps behaviour leaves the record as it is:
#   tests/record.sh target/release/flank before     …     tests/record.sh target/release/flank after     diff -r before after
set -euo pipefail
if [ $# -ne 2 ]; then
    echo "usage: tests/record.sh PROGRAM FOLDER" >&2
    exit 2
fi
program=$(realpath "$1")
rm -rf "$2"
mkdir -p "$2"
record=$(realpath "$2")
cd "$(dirname "$0")/.."
out=$(mktemp -d)
trap 'rm -rf "$out"' EXIT

# Times differ from run to run, and so does the folder.
without_times() {
    sed -E -e "s#$out#OUT#g" -e 's/in [0-9.]+ (us|ms|s)$/in TIME/' -e 's/"(seconds|milliseconds)": [0-9.e+-]+/"\1": TIME/'
}

# run NAME ARGUMENT…: one command, which may write into $out/files
run() {
    local name=$1 code=0
    shift
    rm -rf "$out/files"
    mkdir "$out/files"
    timeout 120 "$program" "$@" >"$out/stdout" 2>"$out/stderr" || code=$?
    {
        echo "flank $*" | without_times
        echo "exit code $code"
        (cd "$out/files" && find . -type f | LC_ALL=C sort | xargs -r sha256sum)
        echo "stdout:"
        without_times <"$out/stdout"
        echo "stderr:"
        without_times <"$out/stderr"
    } >"$record/$name.txt"
}

# each block of the language that a page shows as wrong
for page in docs/errors/*.md; do
    code=$(basename "$page" .md)
    run "explain.$code" explain "$code"
    awk -v name="$out/$code" '/^```chain,wrong/ { n++; on = 1; next } /^```/ { on = 0 } on { print > (name "." n ".chain") }' "$page"
    for block in "$out/$code".*.chain; do
        [ -e "$block" ] && run "error.$(basename "$block" .chain)" check "$block"
    done
done

for command in solve check convert derive plot report deviation measure explain import fmt view new schema completions man; do
    run "help.$command" "$command" --help
done
run help --help
run new new
run schema schema

to="--out $out/files"
for spec in specs/*/*.chain; do
    name=$(basename "$spec" .chain)
    run "$name.check" check --json "$spec"
    run "$name.fmt" fmt --check "$spec"
    grep -q '^job ' "$spec" || continue
    run "$name.solve" solve "$spec" $to
    run "$name.solve_all" solve "$spec" --json --no-picture --geometry --sensitivity --format json $to
    run "$name.limits" solve "$spec" --limits --no-picture $to
    run "$name.derive" derive "$spec"
    run "$name.cost" derive --cost "$spec"
    run "$name.measure" measure "$spec" $to
    run "$name.plot" plot "$spec" --format svg $to
    run "$name.report" report "$spec" --format md $to
    run "$name.view" view "$spec" --json $to
    run "$name.convert" convert "$spec" --to specs/machines/free_form.chain $to
done
run ease_off deviation specs/bevel/ease_off_19x62.chain pinion.concave --reference conjugate.concave $to
