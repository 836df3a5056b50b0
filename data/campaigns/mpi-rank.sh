#!/bin/bash
# A campaign on the ranks of MPI: mpirun -n 16 mpi-rank.sh CAMPAIGN.toml DIR   (or srun --mpi=pmix -n 16 ...)
# MPI starts the ranks and nothing else: no message is sent. A rank that is killed ends the job; start it again,
# or let --resume make what is missing:
#   twinchute campaign CAMPAIGN.toml --out DIR --resume
set -eu
rank=${OMPI_COMM_WORLD_RANK:-${PMIX_RANK:-${PMI_RANK:-${SLURM_PROCID:?not started by MPI}}}}
ranks=${OMPI_COMM_WORLD_SIZE:-${PMI_SIZE:-${SLURM_NTASKS:?not started by MPI}}}
exec "${TWINCHUTE:-twinchute}" campaign "$1" --out "$2" --threads 1 --quiet --shard "$((rank + 1))/$ranks"
