# SPDX-License-Identifier: MIT
# Every order of steps of the protocols, by Spin. Without it the test says that it is skipped.
gnomon_check(protocols_hold LABELS protocols proofs COMMAND "${CMAKE_CURRENT_LIST_DIR}/check.py")
set_tests_properties(protocols_hold PROPERTIES SKIP_RETURN_CODE 77)
