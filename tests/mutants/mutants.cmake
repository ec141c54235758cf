# SPDX-License-Identifier: MIT
# Faults planted in the kernels, one at a time: `mutants.py BUILD --turn git` runs ten of them, in turn, `--all` all.
set(here "${CMAKE_CURRENT_LIST_DIR}")
gnomon_check(mutants_are_of_the_kernels LABELS mutants quick COMMAND "${here}/mutants.py" "${PROJECT_BINARY_DIR}")
gnomon_check(mutants_are_noticed LABELS mutants exhaustive TIMEOUT 900
             COMMAND "${here}/mutants.py" "${PROJECT_BINARY_DIR}" --turn git)
