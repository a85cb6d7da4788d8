#!/usr/bin/env bash
# Draws all pictures of the documentation and writes the gallery; with --check, only says which of them are not what they would be.
set -euo pipefail
cd "$(dirname "$0")/.."

cargo build --quiet --workspace --bin flank
flank=${CARGO_TARGET_DIR:-target}/debug/flank
out=$(mktemp -d)
trap 'rm -rf "$out"' EXIT
mkdir "$out/images" "$out/new"

# Leaves the pictures of one call in $out/new, under the names that `flank plot` gives them; fails where the kind does not fit the job.
try() {
    local ending=0
    "$flank" plot "$@" --no-origin --format png --size 800x600 --out "$out/new" >"$out/told" 2>&1 || ending=$?
    [ $ending -eq 0 ] || [ $ending -eq 3 ]
}
plot() { try "$@" || { cat "$out/told" >&2; exit 1; }; }

# picture NAME SPEC --what KIND …: draws one picture into images/NAME.png
picture() {
    local name=$1
    shift
    plot "$@"
    mv "$out"/new/*.png "$out/images/$name.png"
}

# sentence SPEC: the first sentence of its head, on one line
sentence() {
    awk '!/^\/\/!/ { exit } { sub("^//! *", ""); printf "%s%s", gap, $0; gap = " " } /\.$/ { exit }' "$1"
}

# The gallery: each job of the library, in its folder's section, with the first sentence of its file.
{
    echo "# Gallery"
    echo
    echo "Every job of the library. \`docs/pictures.sh\` draws the pictures and writes this page with \`flank plot\`; what else it draws is on"
    echo "the page about [pictures](pictures.md)."
    section=
    for spec in $(grep -l '^job ' specs/*/*.chain); do
        folder=$(basename "$(dirname "$spec")")
        if [ "$folder" != "$section" ]; then
            section=$folder
            printf '\n## %s\n' "${folder//_/ }"
        fi
        jobs=$(sed -n 's/^job \([A-Za-z0-9_]*\).*/\1/p' "$spec")
        for job in $jobs; do
            # the gear; what end mills leave, and what single edges leave, is what there is to see of their work; else the surfaces
            kinds="gear surface"
            if grep -q '^ *mill .* of ' "$spec"; then kinds="milling gear surface"; fi
            if grep -q '^ *cut ' "$spec"; then kinds="gear left surface"; fi
            for kind in $kinds; do
                if try "$spec" --job "$job" --what "$kind"; then break; fi
            done
            file=$out/new/$job.$kind.png
            # a job that others are made of asks for no points
            if [ ! -e "$file" ]; then continue; fi
            mv "$file" "$out/images/$job.png"
            of=$([ "$jobs" = "$job" ] || echo " --job $job")
            printf '\n### %s\n\n%s\n\n' "$job" "$(sentence "$spec")"
            printf '![%s](images/%s.png)\n\n' "${job//_/ }" "$job"
            printf '    flank plot %s%s --what %s\n' "$spec" "$of" "$kind"
        done
    done
} >"$out/gallery.md"

# What the pages show beside it.
hob=specs/hobbing/real_hob.chain
wheel=specs/hobbing/worm_wheel.chain
pinion=specs/bevel/pinion_19x62.chain
ease_off=specs/bevel/ease_off_19x62.chain
flanks=(--surface upper.flank --reference conjugate_upper.flank)
picture real_hob_run_out $hob --what left --set run_out="0.02 mm"
picture worm_wheel_ease_off $wheel --what deviation "${flanks[@]}"
picture worm_wheel_ease_off_shifted $wheel --what deviation "${flanks[@]}" --set oversize="2 mm" --set m.swivel="0 deg"
picture ease_off_19x62 $ease_off --what deviation --surface pinion.concave --reference conjugate.concave
picture hypoid_pinion_body specs/bodies/hypoid_pair_body.chain --what gear --surface pinion_concave
picture traces specs/hobbing/crowned_gear.chain --what traces
picture topography $ease_off --what topography --surface pinion.concave --reference conjugate.concave
picture sensitivity $pinion --what sensitivity
picture curvature $pinion --what curvature
picture contact_lines $pinion --what contact-lines
picture residual $pinion --what residual
picture contact_pattern specs/pairs/bevel_19x62.chain --what pattern
picture contact_error specs/pairs/bevel_19x62.chain --what error
picture section specs/hobbing/spur_gear.chain --what section
picture section_bevel $pinion --what section
picture machine $pinion --what machine
picture machine_hobbing specs/hobbing/helical_gear.chain --what machine
picture motion specs/hobbing/crowned_gear.chain --what motion

rm -r "$out/new" "$out/told"
if [ "${1:-}" = --check ]; then
    stale=0
    for file in "$out"/images/*.png "$out/gallery.md"; do
        cmp "$file" "docs/${file#"$out"/}" || stale=1
    done
    if [ $stale = 1 ]; then
        echo "pictures are not current: run docs/pictures.sh and look at them" >&2
        exit 1
    fi
else
    mv "$out"/images/*.png docs/images
    mv "$out/gallery.md" docs/gallery.md
fi
