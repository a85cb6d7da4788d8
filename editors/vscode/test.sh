#!/usr/bin/env bash
# The extension in code-server with a browser, without a screen. It needs node 20 with npm, a C++ compiler, ripgrep and Chromium; skipped
# where one of them is missing. test.sh FOLDER leaves its pictures there.
set -euo pipefail
here=$(cd "$(dirname "$0")" && pwd)
FLANK=${FLANK:-$here/../../target/debug/flank}
server=${CODE_SERVER:-$here/../../target/code-server}
for program in npm g++ rg chromium; do
    if ! command -v "$program" >/dev/null; then
        echo "skipped 1 check: the extension in VS Code, there is no $program"
        exit 0
    fi
done
if [ ! -d /usr/include/node ] || ! "$here/install-code-server.sh" "$server" >/dev/null 2>&1; then
    echo "skipped 1 check: the extension in VS Code, code-server could not be installed"
    exit 0
fi
cd "$here"
node test/patterns.mjs
[ -d node_modules/playwright-core ] || npm ci --no-audit --no-fund --silent
npm run --silent package >/dev/null
folder=${1:-$(mktemp -d)}
[ $# -gt 0 ] || trap 'rm -rf "$folder"' EXIT
mkdir -p "$folder/work"
printf '' >"$folder/work/flank.toml"
printf 'machine lathe {\n    axis C : rotary\n    axis Z : linear\n\n    frame bed\n    frame slide in bed = translate_z(Z)\n    frame work in bad = rotate_z(C)\n}\n' \
    >"$folder/work/lathe.chain"
cp test/thread.chain "$folder/work/thread.chain"
node "$server/node_modules/code-server/out/node/entry.js" --extensions-dir "$folder/extensions" --user-data-dir "$folder/data" \
    --install-extension "$here/flank.vsix" >/dev/null
timeout 240 node test/check.mjs "$server/node_modules/code-server" "$(realpath "$FLANK")" "$folder" "$(command -v chromium)"
