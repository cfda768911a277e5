#!/usr/bin/env bash
# Builds the endless terrain for a browser and serves it at http://localhost:8000.
set -euo pipefail
cd "$(dirname "$0")/../.."
rustup target add wasm32-unknown-unknown
cargo build --release --locked --target wasm32-unknown-unknown -p isostudy-browser --lib
folder=$(cargo metadata --format-version 1 --no-deps --locked | python3 -c 'import json, sys; print(json.load(sys.stdin)["target_directory"])')
page=$(mktemp -d)
trap 'rm -r "$page"' EXIT
cp examples/browser/index.html "$page"
cp "$folder/wasm32-unknown-unknown/release/isostudy_browser.wasm" "$page/terrain.wasm"
python3 -m http.server --directory "$page" 8000
