#!/usr/bin/env bash
# Compares include/isostudy.h with what cbindgen makes of the sources, then builds and runs crates/isostudy-ffi/tests/world.c in C, with
# valgrind where it is installed, and compiles the header as C++.
set -euo pipefail
cd "$(dirname "$0")/.."

crate=crates/isostudy-ffi
target=$(cargo metadata --format-version 1 --no-deps --locked | python3 -c 'import json, sys; print(json.load(sys.stdin)["target_directory"])')
work=$target/ffi
mkdir -p "$work"

# A registry's package by its version: it is a program of its own, and no dependency.
version=0.29.4
PATH=$target/tools/bin:$PATH
if [ "$(cbindgen --version 2>/dev/null)" != "cbindgen $version" ]; then
  # It reads a few files: what the optimiser would take is longer.
  CARGO_PROFILE_RELEASE_OPT_LEVEL=0 cargo install --quiet cbindgen --version "$version" --locked --root "$target/tools" ||
    echo "CBINDGEN $version COULD NOT BE INSTALLED: the header was not compared" >&2
fi
if command -v cbindgen >/dev/null; then
  (cd "$crate" && cbindgen --quiet --config cbindgen.toml --output "$work/isostudy.h")
  if ! diff -u "$crate/include/isostudy.h" "$work/isostudy.h"; then
    echo "$crate/include/isostudy.h is not that of the sources: copy $work/isostudy.h" >&2
    exit 1
  fi
fi

cargo build --release --locked -p isostudy-ffi
${CC:-cc} -std=c11 -O1 -g -Wall -Wextra -Wpedantic -Werror -I "$crate/include" "$crate/tests/world.c" \
  -L "$target/release" -Wl,-rpath,"$target/release" -lisostudy_ffi -lm -o "$work/world"
run=()
if command -v valgrind >/dev/null; then
  run=(valgrind --quiet --error-exitcode=1 --leak-check=full --show-leak-kinds=definite --errors-for-leak-kinds=definite)
else
  echo "VALGRIND IS NOT INSTALLED: reads and writes of memory were not checked" >&2
fi
"${run[@]}" "$work/world"
if command -v "${CXX:-c++}" >/dev/null; then
  echo '#include "isostudy.h"' | ${CXX:-c++} -std=c++17 -Wall -Wextra -Werror -I "$crate/include" -x c++ -c - -o "$work/header.o"
fi
