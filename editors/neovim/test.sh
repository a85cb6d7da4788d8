#!/usr/bin/env bash
# Neovim without a screen: opens a spec, and finds, lays out and leads as an editor does. Skipped where there is no Neovim.
set -euo pipefail
here=$(cd "$(dirname "$0")" && pwd)
FLANK=${FLANK:-$here/../../target/debug/flank}
if ! command -v nvim >/dev/null; then
    echo "skipped 1 check: the server in Neovim, there is none"
    exit 0
fi
folder=$(mktemp -d)
trap 'rm -rf "$folder"' EXIT
printf '' >"$folder/flank.toml"
printf 'machine lathe {\naxis C: rotary\n    axis Z : linear\n    frame bed\n    frame slide in bed = translate_z(Z)\n    frame work in bad = rotate_z(C)\n}\n' \
    >"$folder/lathe.chain"
cp "$folder/lathe.chain" "$folder/before"
cp "$here/../vscode/test/thread.chain" "$folder/thread.chain"
export FLANK SPEC="$folder/lathe.chain" JOB="$folder/thread.chain"
timeout 30 nvim --headless -u "$here/flank.lua" -i NONE -c "luafile $here/test/check.lua"
# nothing is written that nobody saved
cmp "$folder/lathe.chain" "$folder/before"
