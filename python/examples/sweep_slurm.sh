#!/bin/sh
# The chunks of a study as an array of jobs, ten chunks for each:
#     sbatch --array=0-9 sweep_slurm.sh study
#SBATCH --ntasks=1 --cpus-per-task=4
study=${1:-study}
each=${CHUNKS_OF_A_TASK:-10}
first=$((SLURM_ARRAY_TASK_ID * each))
exec flank sweep run "$study" --chunks "$first..$((first + each - 1))" --threads "${SLURM_CPUS_PER_TASK:-1}"
