#!/bin/sh
# A sweep as a Slurm job array, one case a task, and a job that gathers them.
#
#   sh configs/sweep_array.sh configs/half_bleach_sweep.toml [OUT]
#
# Run again after a failure: finished cases are kept. Under sbatch it is the task itself.
set -eu

if [ -n "${SLURM_ARRAY_TASK_ID:-}" ]; then
    exec sungaze sweep "$1" --out "$2" --index "$SLURM_ARRAY_TASK_ID" --threads "${SLURM_CPUS_PER_TASK:-1}" --quiet
fi

config=$1
out=${2:-out/$(basename "$config" .toml)}
last=$(($(sungaze sweep "$config" --list | wc -l) - 1))
array=$(sbatch --parsable --job-name sungaze --array "0-$last" --cpus-per-task 2 --time 30 "$0" "$config" "$out")
sbatch --job-name sungaze-merge --dependency "afterok:$array" --time 10 \
    --wrap "sungaze sweep '$config' --out '$out' --merge --quiet"
