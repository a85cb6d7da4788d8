#!/bin/sh
# The chunks of a study as an array of jobs, of any size: each takes its part of the chunks.
#     sbatch --array=0-9 sweep_slurm.sh study
# A task that is begun again alone takes all that is missing.
#SBATCH --ntasks=1 --cpus-per-task=4
study=${1:-study}
part=$((SLURM_ARRAY_TASK_ID - SLURM_ARRAY_TASK_MIN))
exec flank sweep run "$study" --part "$part/$SLURM_ARRAY_TASK_COUNT" --threads "${SLURM_CPUS_PER_TASK:-1}"
