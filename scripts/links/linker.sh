#!/bin/sh
# The linker of scripts/links.sh: links as it is told, and then as often as $LINKS says in other orders, into $FOLDER.
set -eu
cc "$@"
[ -n "${FOLDER:-}" ] || exit 0
seed=1
while [ "$seed" -le "$LINKS" ]; do
    # The last of two outputs counts.
    cc "$@" -Wl,--shuffle-sections='.text*'="$seed" -o "$FOLDER/isostudy-$(printf %02d "$seed")"
    seed=$((seed + 1))
done
