# SPDX-License-Identifier: MIT
# The proofs of the filters' bounds, checked by machines. Without clang, Coq or Gappa the tests say that they are skipped.
set(here "${CMAKE_CURRENT_LIST_DIR}")
file(GLOB proofs CONFIGURE_DEPENDS "${here}/*.cl")
list(TRANSFORM proofs REPLACE "[.]cl$" ".v")
list(TRANSFORM proofs REPLACE "(det3_box)[.]v$" "\\1.g")

gnomon_check(proofs_are_of_the_kernels LABELS proofs quick COMMAND "${here}/expressions.py" ${proofs})
gnomon_check(proofs_by_coq LABELS proofs exhaustive COMMAND "${here}/check.py" coq "${PROJECT_BINARY_DIR}/proofs")
gnomon_check(proofs_by_gappa LABELS proofs quick COMMAND "${here}/check.py" gappa)
set_tests_properties(proofs_by_coq PROPERTIES PROCESSORS 2)  # its threads
foreach(shard RANGE 1 3)  # 40 s each
  gnomon_check(proofs_notice_faults_${shard} LABELS proofs exhaustive
               COMMAND "${here}/faults.sh" "${PROJECT_SOURCE_DIR}/kernels" ${shard} 3)
  list(APPEND notice_faults proofs_notice_faults_${shard})
endforeach()
set_tests_properties(proofs_are_of_the_kernels proofs_by_coq proofs_by_gappa ${notice_faults}
                     PROPERTIES SKIP_RETURN_CODE 77)
