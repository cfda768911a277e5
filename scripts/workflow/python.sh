#!/bin/sh
# Prints the folder of programs of a Python that has Snakemake and HyperQueue, which it makes in target/workflow where they can be had by
# pip. It ends with 1 where they cannot.
set -eu
cd "$(dirname "$0")/../.."
env=target/workflow
if [ ! -e "$env/installed" ]; then
    {
        python3 -m venv "$env"
        "$env/bin/pip" install --quiet snakemake==9.27.1 snakemake-executor-plugin-cluster-generic==1.0.9 hyperqueue==0.27.0
        touch "$env/installed"
    } >/dev/null 2>&1 || {
        echo "Snakemake and HyperQueue cannot be installed by pip" >&2
        exit 1
    }
fi
realpath "$env/bin"
