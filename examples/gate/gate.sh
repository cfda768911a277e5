#!/bin/sh
# A gate for a build server: is the build of this commit slower than that of another?
#
# usage: examples/gate/gate.sh OLD NEW STUDY [OUT]     two programs, a study, and a folder for results
# Ends as `isostudy bench ab`: 0 passed, 1 slower, 2 wrong usage or input, 3 could not have told 5 %.
# Where the times cannot tell, as beside other work, the CPU times of the same samples decide. They do not show threads that wait.
# On 1 and on 3 it measures once more, since an hour may be a bad one. Twice the same is the answer.
set -u
[ $# -ge 3 ] || { echo "usage: $0 OLD NEW STUDY [OUT]" >&2; exit 2; }
old=$1 new=$2 study=$3 out=${4:-results/gate}

once() {
    "$new" bench ab "$old" "$new" "$study" --out "$out/$1" --force --must-tell 5%
    status=$?
    if [ $status -eq 3 ]; then
        echo "gate: times cannot tell; CPU times decide" >&2
        # Nothing is measured again.
        "$new" bench ab "$old" "$new" "$study" --out "$out/$1" --must-tell 5% --by cpu-time
        status=$?
    fi
    return $status
}

once first
status=$?
case $status in
    0 | 2) exit $status ;;
esac
echo "gate: ended with $status; measured once more" >&2
once second
