#!/bin/sh
# Puts the parts of three.js that the viewer of meshes needs, with its licence (MIT), into the git-ignored cache/three/.
# Each file is verified by SHA-256, and none that fails is kept. A study goes on without them: it then has no viewer.
#
# Usage: scripts/fetch-three.sh [PATH]
#   PATH   a three-0.184.0.tgz that you have already, as `npm pack three@0.184.0` makes it
# THREE_CACHE  the folder to fill (default cache/three beside this script's parent)
#
# stdout: the folder. Exit 0 all files are there, 1 they are not, 2 usage.
set -eu

# The last version with minified builds.
PACKAGE=three@0.184.0
# SHA-256, and the path in the package. The folder is flat: names are unique.
FILES='8b378ebe60e2fe500158cb0ac71cb5e8b7d92953c2abcc63a0eb90499653b5bc LICENSE
36a60b0120335f89a80a0dab70292292b0ec414b3d05e83cd09a3ea428c6712a build/three.module.min.js
6486aa0d719cfa87ec88dc47223b59b1fb8417a1a407fc0e52467c943e2f8cc9 build/three.core.min.js
faabb4e8dfd9235ee4a9fd7c9a3d75f90f1689dbd4944bd6fd32117dacec5f93 examples/jsm/controls/OrbitControls.js
97642d720f16cc9a0c9844934198e4d0c023bea8e89576d0f7545d03b2d103d2 examples/jsm/loaders/GLTFLoader.js
d700b4c4584b9ff53a04692624d2363019f6d1df2978a207389168c6ae647a65 examples/jsm/utils/BufferGeometryUtils.js
b1632a703206c3d830de9fcbe515696770d04b71a15ee6b50afa6d2c3298c86f examples/jsm/utils/SkeletonUtils.js'

say() { printf 'fetch-three: %s\n' "$*" >&2; }
. "$(dirname -- "$0")/fetching.sh"

# complete: whether every file is there and is what it should be.
complete() {
    printf '%s\n' "$FILES" | while read -r digest path; do
        file=$cache/$(basename "$path")
        [ -f "$file" ] && [ "$(sha256 "$file")" = "$digest" ] || exit 1
    done
}

# keep TREE: copies the files out of an unpacked package; fails at the first that is a stranger.
keep() {
    printf '%s\n' "$FILES" | while read -r digest path; do
        from=$1/package/$path
        [ -f "$from" ] || { say "the package has no $path"; exit 1; }
        found=$(sha256 "$from")
        [ "$found" = "$digest" ] || { say "$path is another file: SHA-256 $found, wanted $digest"; exit 1; }
        cp "$from" "$work/candidate"
        mv -f "$work/candidate" "$cache/$(basename "$path")" # same file system, hence atomic
    done
}

from_path() {
    [ -f "$1" ] || { say "$1: no such file"; return 1; }
    mkdir -p "$work/given"
    tar -xzf "$1" -C "$work/given" 2>"$work/log" || { say "$1: $(tail -n 1 "$work/log")"; return 1; }
    keep "$work/given"
}

from_npm() {
    tree=$(unpack npm "$PACKAGE") && keep "$tree"
}

[ $# -le 1 ] || { say "usage: scripts/fetch-three.sh [PATH]"; exit 2; }
cache=${THREE_CACHE:-$(CDPATH='' cd -- "$(dirname -- "$0")/.." && pwd)/cache/three}
mkdir -p "$cache"
if complete; then
    printf '%s\n' "$cache"
    exit 0
fi

work=$(mktemp -d "$cache/.fetch-XXXXXX")
trap 'rm -rf "$work"' EXIT
trap 'exit 130' INT
trap 'exit 143' TERM HUP

if { [ $# -eq 1 ] && from_path "$1"; } || from_npm; then
    printf '%s\n' "$cache"
    exit 0
fi
cat >&2 <<END
fetch-three: three.js is missing, so a study has no viewer of its meshes; all else is made. Either of these helps:
  - give npm a registry that it can reach, and run make three
  - get three-0.184.0.tgz on another machine with npm pack $PACKAGE and run make three THREE=PATH
END
exit 1
