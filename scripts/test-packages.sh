#!/usr/bin/env bash
# Packages every crate of the library from a clean clone of the last commit, builds each from its package alone, and compiles the
# code of the front page, the README, docs/engine.md and docs/versions.md in an empty crate that depends on the packages.
set -euo pipefail
cd "$(dirname "$0")/.."

library=(isostudy-cells isostudy-mesh isostudy-field isostudy-trilinear isostudy-extract isostudy-ffi)
# From the fields of the manifests that a registry wants, and that `cargo package` only warns of.
wanted=(description license readme documentation keywords categories rust_version)

target=$(cargo metadata --format-version 1 --no-deps --locked | python3 -c 'import json, sys; print(json.load(sys.stdin)["target_directory"])')
work=$target/packages
rm -rf "$work/clone" "$work/build/package"
mkdir -p "$work/build"
# Cargo takes packages of one version for the same: those of the last run would be built again.
rm -rf "${CARGO_HOME:-$HOME/.cargo}"/registry/src/*/isostudy-*-0.1.0
find "$work/build" -depth -path '*/.fingerprint/isostudy-*' -type d -exec rm -r {} +
# Where no other manifest is above.
outside=$(mktemp -d)
trap 'rm -r "$outside"' EXIT
git clone --quiet --no-hardlinks . "$work/clone"
cd "$work/clone"

cargo metadata --format-version 1 --no-deps --locked | python3 -c '
import json, sys
library, wanted = (names.split() for names in sys.argv[1:])
packages = {package["name"]: package for package in json.load(sys.stdin)["packages"]}
missing = [f"{name} has no {field}" for name in library for field in wanted if not packages[name][field]]
unpublished = [
    f"{name} depends on {needed['"'name'"']}, which is not published with it"
    for name in library
    for needed in packages[name]["dependencies"]
    if needed.get("path") and needed["name"] not in library
]
sys.exit("\n".join(missing + unpublished) or None)
' "${library[*]}" "${wanted[*]}"

selected=("${library[@]/#/--package=}")
# Each is built from its package alone, against the packages of the others.
cargo package "${selected[@]}" --target-dir "$work/build" 2>&1 | tee "$work/package.log"
# Tests, benchmarks and examples of times are left out by `include`.
if grep '^warning' "$work/package.log" | grep -qv 'warning: ignoring'; then
  echo "cargo package has warnings" >&2
  exit 1
fi

version=$(cargo metadata --format-version 1 --no-deps --locked | python3 -c '
import json, sys
print(next(p["version"] for p in json.load(sys.stdin)["packages"] if p["name"] == "isostudy-extract"))')
for name in "${library[@]}"; do
  tar -xzf "$work/build/package/$name-$version.crate" -C "$outside"
  for file in README.md LICENSE-MIT LICENSE-APACHE; do test -s "$outside/$name-$version/$file"; done
done
extract=$outside/isostudy-extract-$version
for file in docs/engine.md docs/lod.md examples/endless.rs examples/dig.rs examples/browser/src/ground.rs; do
  test -s "$extract/$file"
done
test -s "$outside/isostudy-ffi-$version/include/isostudy.h"

# A game's first step: an empty crate, and one `cargo add`.
cargo new --quiet --lib --vcs none "$outside/empty"
cd "$outside/empty"
{
  echo '[patch.crates-io]'
  for name in "${library[@]}"; do echo "$name = { path = \"$outside/$name-$version\" }"; done
} >>Cargo.toml
cargo add --quiet --path "$extract"
sed -n 's|^//! \{0,1\}||p' "$extract/src/lib.rs" >src/front.md
{
  echo '#![doc = include_str!("front.md")]'
  for page in README docs/engine docs/versions; do
    echo "#[doc = include_str!(\"$extract/$page.md\")]"
    echo "pub mod ${page##*/} {}" | tr '[:upper:]' '[:lower:]'
  done
} >src/lib.rs
cargo test --quiet --doc --target-dir "$work/build"

# The whole documentation, and the programs that a game reads. `cargo doc` stops at the first link that leads nowhere.
cd "$extract"
printf '[patch.crates-io]\n' >>Cargo.toml
for name in "${library[@]}"; do
  test "$name" = isostudy-extract || echo "$name = { path = \"$outside/$name-$version\" }"
done >>Cargo.toml
RUSTDOCFLAGS="-D warnings" cargo doc --quiet --no-deps --target-dir "$work/build"
cargo check --quiet --examples --target-dir "$work/build"

if command -v cargo-semver-checks >/dev/null; then
  before=$(git -C "$work/clone" describe --tags --abbrev=0 --match 'library-*' 2>/dev/null || true)
  cd "$work/clone"
  test -z "$before" || cargo semver-checks --baseline-rev "$before" "${selected[@]}"
else
  echo "CARGO-SEMVER-CHECKS IS NOT INSTALLED: the interface was not compared with the last version" >&2
fi
echo "the library's ${#library[@]} packages build, and the code of their pages compiles"
