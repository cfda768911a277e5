#!/usr/bin/env bash
# The questionnaire, the pages of results and the viewer in headless Chromium. Needs Node with npm, and a chromium on the PATH (or CHROMIUM=path).
# Without them nothing is tested, which is said loudly; BROWSER_REQUIRED=1 makes that an error.
set -euo pipefail
cd "$(dirname "$0")/.."

CHROMIUM=${CHROMIUM:-$(command -v chromium || command -v chromium-browser || command -v google-chrome || true)}
skip() {
  echo "SKIPPED: $1 - no page was tested in a browser" >&2
  exit "${BROWSER_REQUIRED:-0}"
}
[ -n "$CHROMIUM" ] || skip "NO CHROMIUM"
{ command -v node && command -v npm; } >/dev/null || skip "NO NODE OR NO NPM"
MODULES=${CARGO_TARGET_DIR:-$PWD/target}/browser
mkdir -p "$MODULES"
[ -f "$MODULES/package.json" ] || echo '{ "private": true }' >"$MODULES/package.json"
npm install --prefix "$MODULES" --silent --no-audit --no-fund --no-save playwright-core@1.64.1 axe-core@4.14.1 ||
  skip "NPM COULD NOT INSTALL playwright-core AND axe-core"
cargo build --release --locked --quiet --package isostudy
export ISOSTUDY=${CARGO_TARGET_DIR:-$PWD/target}/release/isostudy CHROMIUM MODULES
# The viewer is tested where three.js can be had.
scripts/fetch-three.sh >/dev/null || true
# Two files at a time, where Node can: browsers wait more than they work.
mapfile -t files < <(ls tests/browser/*.mjs | grep -v /walk.mjs)
mapfile -t options < <(node --help | grep -- --test-concurrency >/dev/null && echo --test-concurrency=2)
node --test "${options[@]}" "${files[@]}"
