#!/usr/bin/env bash
# install-code-server.sh FOLDER: VS Code as a server, from npm alone: what its packages would fetch from elsewhere is built, or Debian's.
# Node 20; takes some minutes and 400 MB.
set -euo pipefail
folder=$1
mkdir -p "$folder"
cd "$folder"
[ -f ready ] && exit 0
[ -f package.json ] || echo '{ "private": true }' >package.json
npm install --no-audit --no-fund --silent --ignore-scripts code-server@4.100.3 node-gyp@11
gyp=$PWD/node_modules/.bin/node-gyp
server=$PWD/node_modules/code-server
cd "$server/lib/vscode"
npm install --no-audit --no-fund --silent --omit=dev --ignore-scripts
export npm_config_nodedir=/usr
for package in @parcel/watcher @vscode/spdlog native-watchdog node-pty @vscode/deviceid; do
    for place in "$server/lib/vscode/node_modules/$package" "$folder/node_modules/$package"; do
        if [ -f "$place/binding.gyp" ]; then (cd "$place" && "$gyp" rebuild --silent); fi
    done
done
for place in "$server/node_modules/argon2" "$folder/node_modules/argon2"; do
    if [ -f "$place/binding.gyp" ]; then
        (cd "$place" && "$gyp" rebuild --silent --module_name=argon2 "--module_path=$place/lib/binding/napi-v3")
    fi
done
mkdir -p "$server/lib/vscode/node_modules/@vscode/ripgrep/bin"
ln -sf "$(command -v rg)" "$server/lib/vscode/node_modules/@vscode/ripgrep/bin/rg"
touch "$folder/ready"
