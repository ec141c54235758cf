# SPDX-License-Identifier: MIT
# Devices that nobody here owns: tests of exactness on a sound driver under a layer that lies about it, included by
# tests/CMakeLists.txt. The golden record is the judge, and the oracle in oclgrind_cases: the bits are the same under
# every lie, or one sentence refuses the device. (AddressSanitizer insists on being loaded before the layer's library.)
if(GNOMON_SANITIZE)
  return()
endif()
add_library(gnomon_lying_layer MODULE drivers/lying_layer.cpp)
target_compile_features(gnomon_lying_layer PRIVATE cxx_std_20)
set_target_properties(gnomon_lying_layer PROPERTIES CXX_VISIBILITY_PRESET hidden)
target_include_directories(gnomon_lying_layer PRIVATE ${OpenCL_INCLUDE_DIRS})
target_link_libraries(gnomon_lying_layer PRIVATE gnomon_build_flags)
# PoCL compiles a kernel anew for each size of work-groups, and the first run of a lie waits for that.
set(lie_seconds 900)

# gnomon_lie(NAME LIES COMMAND [ARGUMENT...]): the program must succeed. Its kernels are compiled anew: exhaustive.
function(gnomon_lie name lies program)
  gnomon_check(lie_${name} TIMEOUT ${lie_seconds} LABELS drivers exhaustive
               COMMAND "${CMAKE_CURRENT_LIST_DIR}/under_lies.sh" "$<TARGET_FILE:gnomon_lying_layer>" "${lies}" -
                       "$<TARGET_FILE:${program}>" ${ARGN})
endfunction()

# gnomon_refused_lie(NAME LIES SENTENCE [ARGUMENT...]): gnomon must refuse with this sentence.
function(gnomon_refused_lie name lies sentence)
  if(NOT ARGN)
    set(ARGN render --size 64x64 --output "${CMAKE_CURRENT_BINARY_DIR}/lie_${name}.png")
  endif()
  if(GNOMON_COMMAND)
    gnomon_check(lie_${name} TIMEOUT ${lie_seconds} LABELS drivers
                 COMMAND "${CMAKE_CURRENT_LIST_DIR}/under_lies.sh" "$<TARGET_FILE:gnomon_lying_layer>" "${lies}"
                         "${sentence}" "$<TARGET_FILE:gnomon_command>" ${ARGN})
  endif()
endfunction()

# Pairs: a name and its lies. `type=gpu` chooses the kernels for GPUs.
set(small_devices
  local_16_kib type=gpu,local_memory=16384
  local_32_kib type=gpu,local_memory=32768
  groups_of_64 type=gpu,work_group=64,local_memory=16384
  groups_of_128 type=gpu,work_group=128,multiple=64
  kernels_of_32_items type=gpu,kernel_work_group=32
  kernels_of_5_items type=gpu,kernel_work_group=5
  one_compute_unit compute_units=1
  one_compute_unit_of_a_gpu type=gpu,compute_units=1
  buffers_of_128_mib allocation=134217728
  no_double no_fp64
  no_double_nor_long_atomics type=gpu,no_fp64,no_int64_atomics
  inexact_division no_exact_divide
  inexact_division_of_a_gpu type=gpu,no_exact_divide
  memory_of_its_own unified=0
  shared_memory type=gpu,unified=1
  no_clock no_clock
  no_clock_of_a_gpu type=gpu,no_clock)
while(small_devices)
  list(POP_FRONT small_devices name lies)
  gnomon_lie(${name} ${lies} oclgrind_cases)
  if(TARGET golden_test)
    gnomon_lie(${name}_golden ${lies} golden_test
      --gtest_filter=*/sundial_default_sun:*/degenerate_main_sun:*/lattice_main_lamp_samples_8:*/pillars_point_light_main_lamp)
  endif()
endwhile()
gnomon_lie(memory_of_its_own_is_copied unified=0 library_test --gtest_filter=SharedMemory.*)
gnomon_lie(shared_memory_is_used_in_place type=gpu,unified=1 library_test --gtest_filter=SharedMemory.*)
gnomon_lie(list_of_drivers_is_cut cut=OCL_ICD_FILENAMES library_test --gtest_filter=Devices.AListOfDriversStaysWhole)
gnomon_lie(groups_of_64_many_lights type=gpu,work_group=64,local_memory=16384 many_lights_test
  --gtest_filter=-*Exhaustive*)
# Those of its cases that reach every kernel once: groups of 32 are compiled anew, case by case.
gnomon_lie(kernels_of_32_items_many_lights type=gpu,kernel_work_group=32 many_lights_test
  --gtest_filter=ManyLights.EveryBit*:ManyLights.SidesAre*:ManyLights.SweepsChange*:ManyLights.MeansAre*:ManyLights.PointLights*)
# `auto` measures in a program's first run.
gnomon_lie(kernels_built_at_launch first_launch=700 many_lights_test --gtest_filter=*FirstLaunches*)
# A beam's group has an item for each child of a node.
gnomon_lie(kernels_of_5_items_many_lights type=gpu,kernel_work_group=5 many_lights_test
  --gtest_filter=ManyLights.SidesAreThoseOfOneLight)
set_tests_properties(lie_kernels_of_5_items_many_lights PROPERTIES
  PASS_REGULAR_EXPRESSION "beam_trace needs work-groups of 32 items, and the device allows it 5: use another device")

gnomon_refused_lie(opencl_c_1_1 opencl_c=1.1 "cannot be used: it lacks OpenCL C 1\\.2$")
gnomon_refused_lie(addresses_of_32_bits address_bits=32 "cannot be used: it lacks 64-bit addresses$")
gnomon_refused_lie(local_8_kib type=gpu,local_memory=8192 "cannot be used: it lacks 16 KiB of local memory$")
gnomon_refused_lie(lost_launch lost=6 "after a command that the device did not complete, failed with CL_EXEC_STATUS")
gnomon_refused_lie(lost_launch_of_a_gpu type=gpu,lost=12 "after a command that the device did not complete, failed")
# (On a CPU the first calls may be those that measure whether binaries are worth keeping; their failure does not matter.)
if(TEST lie_lost_launch_of_a_gpu)  # its kernels are compiled anew
  set_property(TEST lie_lost_launch_of_a_gpu APPEND PROPERTY LABELS exhaustive)
endif()
gnomon_refused_lie(refused_launch type=gpu,fail=EnqueueNDRangeKernel:1:-5 "out of device memory: launching kernel .*CL_OUT_OF_RES")
gnomon_refused_lie(refused_launch_of_a_gpu type=gpu,fail=EnqueueNDRangeKernel:3:-54
                   "launching kernel .*CL_INVALID_WORK_GROUP_SIZE")
gnomon_refused_lie(refused_program type=gpu,fail=BuildProgram:2:-11 "compiling kernels/.* failed with CL_BUILD_PROGRAM_FAILURE")
gnomon_refused_lie(lost_queue type=gpu,fail=Finish:1:-36 "waiting for the device failed with CL_INVALID_COMMAND_QUEUE")
gnomon_refused_lie(refused_reading fail=EnqueueReadBuffer:1:-5 "reading from the device failed with CL_OUT_OF_RESOURCES")

# `gnomon devices --check` tells a device that is right from one that is not.
if(GNOMON_COMMAND)
  gnomon_lie(checked compute_units=2 gnomon_command devices --check)
  gnomon_lie(checked_gpu type=gpu,work_group=64 gnomon_command devices --check)
  set_tests_properties(lie_checked lie_checked_gpu PROPERTIES PASS_REGULAR_EXPRESSION "RIGHT: [0-9,]+ answers, none wrong")
endif()
gnomon_refused_lie(checked_and_wrong wrong_bit=8000 "of the answers of the device .* are wrong: do not use it"
                   devices --check)
