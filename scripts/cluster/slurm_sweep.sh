#!/bin/bash
# A study as an array of Slurm jobs on nodes that share a disk:
#
#     sbatch --array=1-64 --requeue scripts/cluster/slurm_sweep.sh STUDY.toml DIR
#
# and when the array is done, on any node:
#
#     freeplay sweep STUDY.toml --gather DIR
#
# A shard that is asked to stop, at its limit of time or because others go first, or whose disk is full,
# ends with 75; it goes to the queue again and goes on where it was. What it has done is kept.
#SBATCH --job-name=freeplay
#SBATCH --cpus-per-task=1
#SBATCH --mem=512M
#SBATCH --time=01:00:00
#SBATCH --signal=B:TERM@60
#SBATCH --open-mode=append

study=${1:?which study?}
folder=${2:?which folder?}
freeplay=${FREEPLAY:-freeplay}

# in the background, so that the signal reaches this shell at once, which hands it on
"$freeplay" sweep "$study" --shard "$SLURM_ARRAY_TASK_ID/$SLURM_ARRAY_TASK_COUNT" -o "$folder" \
    --jobs "${SLURM_CPUS_PER_TASK:-1}" --quiet &
shard=$!
trap 'kill -TERM "$shard" 2>/dev/null' TERM
wait "$shard"
code=$?
# a wait that a signal broke off tells the signal; the shard's own end is still to come
while kill -0 "$shard" 2>/dev/null; do
    wait "$shard"
    code=$?
done
if [ "$code" -eq 75 ] && command -v scontrol >/dev/null; then
    scontrol requeue "${SLURM_ARRAY_JOB_ID}_$SLURM_ARRAY_TASK_ID" && exit 0
fi
exit "$code"
