# SPDX-License-Identifier: MIT
# Faults planted in the kernels, one at a time: ten in each run of CI, in turn.
set(here "${CMAKE_CURRENT_LIST_DIR}")
gnomon_check(mutants_are_of_the_kernels LABELS mutants quick COMMAND "${here}/mutants.py" "${PROJECT_BINARY_DIR}")
gnomon_check(mutants_in_turn TIMEOUT 1800 LABELS mutants exhaustive
             COMMAND "${here}/mutants.py" "${PROJECT_BINARY_DIR}" --turn git)
