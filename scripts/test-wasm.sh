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

# A module for a page: how many bytes it may have, and how many after gzip, in units of 1000. One family of methods, and all of them.
small() {
  local name=$1 most_kb=$2 most_gzipped_kb=$3
  shift 3
  cargo build --quiet --release --manifest-path examples/small/Cargo.toml --target "$target" --target-dir "$folder/small-$name" "$@"
  local module=$folder/small-$name/$target/release/isostudy_small.wasm
  local bytes gzipped
  bytes=$(wc -c <"$module")
  gzipped=$(gzip -9 -c "$module" | wc -c)
  echo "wasm with $name: $bytes bytes, $gzipped gzipped; at most ${most_kb}000 and ${most_gzipped_kb}000"
  if ((bytes > 1000 * most_kb || gzipped > 1000 * most_gzipped_kb)); then
    echo "the module with $name is too large" >&2
    exit 1
  fi
  node scripts/test-small.mjs "$module"
}
# Chunks that make nothing but their own triangles, and normals of samples, cost 8 KB of the first.
small surface-nets 128 57
small all-families 600 250 --features all-families
