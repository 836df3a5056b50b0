#!/bin/bash
# A campaign as an array of Slurm: sbatch --array=1-8 slurm-array.sh CAMPAIGN.toml DIR
# Each task makes its part of the chunks; which tasks ran, were killed or ran twice does not show in the bytes.
# A task should hold minutes of work: starting one costs Slurm about half a second. Afterwards, once:
#   twinchute campaign CAMPAIGN.toml --out DIR --resume
#SBATCH --job-name=twinchute
#SBATCH --cpus-per-task=1
#SBATCH --time=04:00:00
set -eu
exec "${TWINCHUTE:-twinchute}" campaign "$1" --out "$2" --threads "${SLURM_CPUS_PER_TASK:-1}" --quiet \
    --shard "$((SLURM_ARRAY_TASK_ID - SLURM_ARRAY_TASK_MIN + 1))/$SLURM_ARRAY_TASK_COUNT"
