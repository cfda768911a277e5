#!/bin/sh
# What has become of a Slurm job, in the words of cluster-generic. It asks the scheduler, so that no accounting is needed. Where the
# scheduler does not answer, nothing is known, and the job may go on.
said=$(scontrol show job "$1" 2>&1) || case "$said" in
*"Invalid job id"*) echo failed && exit ;;
*) echo running && exit ;;
esac
case "$(echo "$said" | sed -n 's/.*JobState=\([A-Z_]*\).*/\1/p' | head -n 1)" in
COMPLETED) echo success ;;
PENDING | CONFIGURING | RUNNING | COMPLETING | SUSPENDED | REQUEUED | RESIZING | SIGNALING | STAGE_OUT) echo running ;;
*) echo failed ;;
esac
