#!/usr/bin/env bash
# Runs chunks and the terrain of examples/browser in Node, compiled for wasm32-unknown-unknown: what compiles there can still die at its first call.
set -euo pipefail
cd "$(dirname "$0")/.."

target=wasm32-unknown-unknown
if ! command -v node >/dev/null; then
  echo "NODE IS NOT INSTALLED: the library was not run as wasm" >&2
  exit 0
fi
if command -v rustup >/dev/null && ! rustup target add "$target" >/dev/null 2>&1; then
  echo "THE TARGET $target CANNOT BE HAD: the library was not run as wasm" >&2
  exit 0
fi
folder=$(cargo metadata --format-version 1 --no-deps --locked | node -pe 'JSON.parse(fs.readFileSync(0)).target_directory')
cargo build --release --locked --target "$target" -p isostudy-browser --lib --bins
node scripts/run-wasm.mjs "$folder/$target/release/one_chunk.wasm"
node scripts/test-terrain.mjs "$folder/$target/release/isostudy_browser.wasm"
