// SPDX-License-Identifier: MIT
// The functions of gnomon.h by groups, each of which c_interface_in_c.c calls and checks: once as a program, and again
// and again in nothing_grows_test.cpp.
#ifndef GNOMON_TESTS_C_GROUPS_H
#define GNOMON_TESTS_C_GROUPS_H

#include <gnomon.h>

#ifdef __cplusplus
extern "C" {
#endif

// A square roof above three points.
typedef struct c_inputs {
    gnomon_device* device;
    gnomon_triangles* triangles;
    gnomon_points* points;
    gnomon_visibility* visibility;
    gnomon_light lights[2];
    gnomon_camera camera;
} c_inputs;

typedef struct c_group {
    const char* name;
    void (*run)(c_inputs* inputs);
    int opens_a_device;
} c_group;

extern const c_group c_groups[];
extern const size_t c_group_count;

void open_c_inputs(c_inputs* inputs);
void close_c_inputs(c_inputs* inputs);
int c_failures(void);  // of all groups so far

#ifdef __cplusplus
}
#endif

#endif
