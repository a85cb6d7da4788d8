#!/bin/sh
# Makes the seed corpora from the specs, the fixtures of the tests, and the inputs that were found before.
set -eu
cd "$(dirname "$0")/.."
for target in parser layout meaning; do
    mkdir -p "fuzz/corpus/$target"
    find specs crates/chain-dsl/tests tests/language/fuzz_inputs -type f \( -name '*.chain' -o -name '*.txt' -o -name '*.input' \) |
        while read -r file; do
            cp "$file" "fuzz/corpus/$target/$(echo "$file" | tr / _)"
        done
    # each text of a file of mistakes alone, and each block of the language page
    awk -v folder="fuzz/corpus/$target" '/^\/\/---- /{n++} n{print > sprintf("%s/mistake-%04d", folder, n)}' \
        crates/chain-dsl/tests/*/mistakes/*.txt
    awk -v folder="fuzz/corpus/$target" '/^```chain/{n++; on=1; next} /^```/{on=0} on{print > sprintf("%s/page-%02d", folder, n)}' \
        docs/language.md
    cat specs/functions/bevel.chain specs/machines/cradle.chain specs/tools/face_mill.chain specs/bevel/pinion_19x62.chain |
        grep -v '^use ' > "fuzz/corpus/$target/whole-pinion"
    cat specs/machines/hobbing_6axis.chain specs/machines/rack_generating.chain specs/tools/rack.chain specs/hobbing/spur_gear.chain |
        grep -v '^use ' > "fuzz/corpus/$target/whole-spur-gear"
    cat specs/machines/hobbing_6axis.chain specs/tools/involute.chain specs/tools/hob_zi.chain specs/hobbing/helical_gear.chain |
        grep -v '^use ' > "fuzz/corpus/$target/whole-helical-gear"
done
mkdir -p fuzz/corpus/lsp
cp tests/language/conversations/*.lsp fuzz/corpus/lsp/
