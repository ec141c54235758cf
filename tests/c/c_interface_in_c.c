// SPDX-License-Identifier: MIT
// gnomon.h in a C11 program: every function is called, and what it gives for a square roof above three points is known
// by hand. The answers' bits are compared with the C++ library's in c_interface_test.cpp.
#include "c_groups.h"

#include <stdio.h>
#include <stdlib.h>
#include <string.h>

static int failures = 0;

#define EXPECT(condition)                                                             \
    do {                                                                              \
        if (!(condition)) {                                                           \
            fprintf(stderr, "%s:%d: not true: %s\n", __FILE__, __LINE__, #condition); \
            ++failures;                                                               \
        }                                                                             \
    } while (0)

#define DONE(call)                                                                                                    \
    do {                                                                                                              \
        const gnomon_status status_ = (call);                                                                         \
        if (status_ != GNOMON_SUCCESS) {                                                                              \
            fprintf(stderr, "%s:%d: %s: %s\n", __FILE__, __LINE__, gnomon_status_name(status_), gnomon_last_error()); \
            exit(1);                                                                                                  \
        }                                                                                                             \
    } while (0)

// The layout of the structs is part of the interface: another one needs another version.
#define HAS_SIZE(type, size) _Static_assert(sizeof(void*) != 8 || sizeof(type) == (size), "the size of " #type)
HAS_SIZE(gnomon_status, 4);
HAS_SIZE(gnomon_light, 16);
HAS_SIZE(gnomon_camera, 96);
HAS_SIZE(gnomon_point_layout, 24);
HAS_SIZE(gnomon_world_lattice, 32);
HAS_SIZE(gnomon_stage, 32);
HAS_SIZE(gnomon_count, 16);
HAS_SIZE(gnomon_statistics, 48);
HAS_SIZE(gnomon_device_description, 128);
HAS_SIZE(gnomon_device_list, 16);
HAS_SIZE(gnomon_device_options, 24);
HAS_SIZE(gnomon_kernel_builds, 16);
HAS_SIZE(gnomon_setting_description, 24);
HAS_SIZE(gnomon_diagnostic_description, 16);
HAS_SIZE(gnomon_technique_description, 56);
HAS_SIZE(gnomon_technique_list, 16);
HAS_SIZE(gnomon_facing, 56);
HAS_SIZE(gnomon_run_options, 80);
HAS_SIZE(gnomon_light_visibility, 24);
HAS_SIZE(gnomon_light_table_buffers, 56);
HAS_SIZE(gnomon_light_table_arrays, 56);
HAS_SIZE(gnomon_samples_options, 32);
HAS_SIZE(gnomon_materials, 40);
HAS_SIZE(gnomon_cut_out_material, 32);
HAS_SIZE(gnomon_cut_outs, 64);
HAS_SIZE(gnomon_cut_out_buffers, 64);
HAS_SIZE(gnomon_host_scene, 32);
HAS_SIZE(gnomon_host_scene_options, 56);
HAS_SIZE(gnomon_sample_offset, 8);
HAS_SIZE(gnomon_triangle_signs, 80);
HAS_SIZE(gnomon_explanation, 176);
HAS_SIZE(gnomon_view_of_parts, 32);
HAS_SIZE(gnomon_setting, 16);

static const float roof[18] = {-1, 2, -1, 1, 2, -1, 1, 2, 1, -1, 2, -1, 1, 2, 1, -1, 2, 1};
static const float ground[9] = {0, 0, 0, 1, 0, 0, 1.001f, 0, 0};  // under the middle, under the edge, beside
static const float down[3] = {0, -1, 0}, above[3] = {0.5f, 9, 0.25f};

// Waits for an event of the caller's, and gives it back.
static void wait_for(cl_event event) {
    EXPECT(event != NULL);
    EXPECT(clWaitForEvents(1, &event) == CL_SUCCESS);
    EXPECT(clReleaseEvent(event) == CL_SUCCESS);
}

static void expect_shadows(const gnomon_visibility* visibility) {
    float lit[3] = {7, 7, 7};
    DONE(gnomon_visibility_read(visibility, lit));
    EXPECT(lit[0] == 0 && lit[1] == 0 && lit[2] == 1);
}

static void check_values(gnomon_light lights[2], gnomon_camera* camera) {
    const float eye[3] = {0, 5, 0}, target[3] = {0, 0, 0}, up[3] = {0, 0, 1};
    gnomon_sample_offset offsets[4];
    EXPECT(GNOMON_VERSION == GNOMON_VERSION_MAJOR * 10000 + GNOMON_VERSION_MINOR * 100 + GNOMON_VERSION_PATCH);
    EXPECT(strlen(gnomon_version()) >= 5);
    EXPECT(strcmp(gnomon_status_name(GNOMON_SUCCESS), "GNOMON_SUCCESS") == 0);
    DONE(gnomon_light_directional(down, &lights[0]));
    EXPECT(lights[0].xyzw[1] == 1 && lights[0].xyzw[3] == 0);
    DONE(gnomon_light_point(above, &lights[1]));
    EXPECT(lights[1].xyzw[1] == 9 && lights[1].xyzw[3] == 1);
    DONE(gnomon_camera_look_at(eye, target, up, 60, camera));
    EXPECT(camera->forward[1] == -1 && camera->eye[1] == 5);
    DONE(gnomon_sample_pattern(4, offsets));
    EXPECT(offsets[0].x == -8 && offsets[0].y == -24);  // Direct3D's
}

static void check_lattice(void) {
    const double world[6] = {4500000.1, 6000000, 0, 4500001.1, 6000000, 1}, normals[6] = {0, 0, 1, 0, 0, 2};
    gnomon_world_lattice lattice, other;
    float snapped[6], lifted[6], rebased[6];
    double back[3], move = 7;
    DONE(gnomon_world_lattice_fit(world, 2, &lattice));
    DONE(gnomon_world_lattice_around(world, 2, -10, &lattice));
    EXPECT(lattice.exponent == -10);
    DONE(gnomon_world_lattice_snap(&lattice, world, 2, snapped, &move));
    EXPECT(move > 0 && move <= 1.0 / 2048);
    DONE(gnomon_world_lattice_world_of(&lattice, snapped + 3, back));
    EXPECT(back[1] == 6000000 && back[2] == 1);
    DONE(gnomon_world_lattice_lift(&lattice, world, normals, 2, lifted));
    EXPECT(lifted[0] == snapped[0] && lifted[2] == snapped[2] + 3.0f / 1024);
    other = lattice;
    other.origin[1] -= 1024;
    DONE(gnomon_world_lattice_rebase(&lattice, snapped, 2, &other, rebased));
    EXPECT(rebased[0] == snapped[0] && rebased[1] == snapped[1] + 1);
    const double triangles[18] = {0, 0, 0, 8, 0, 0, 0, 8, 0, 1, 1, 0, 1, 1.0004, 0, 1.0004, 1, 0};
    gnomon_change changes[2];
    uint32_t touched[6];
    DONE(gnomon_world_lattice_around(triangles, 6, -10, &other));
    DONE(gnomon_world_lattice_changes(&other, triangles, 2, 1, changes));
    EXPECT(changes[0] == GNOMON_CHANGE_NONE && changes[1] == GNOMON_CHANGE_ZERO_AREA);
    DONE(gnomon_world_lattice_touched_triangles(&other, triangles, 2, touched));
    EXPECT(touched[0] == GNOMON_NO_RECEIVER && touched[2] == GNOMON_NO_RECEIVER && touched[3] == 0 && touched[5] == 0);
    EXPECT(gnomon_world_lattice_around(world, 2, 101, &lattice) == GNOMON_INVALID_ARGUMENT);
    EXPECT(gnomon_world_lattice_snap(NULL, world, 2, snapped, NULL) == GNOMON_INVALID_ARGUMENT);
    EXPECT(gnomon_world_lattice_snap(&lattice, world, 2, NULL, NULL) == GNOMON_INVALID_ARGUMENT);
}

static void check_lists(void) {
    const gnomon_device_list* devices;
    const gnomon_technique_list* techniques;
    DONE(gnomon_devices_list(&devices));
    EXPECT(devices->count > 0 && strchr(devices->devices[0].selector, ':') != NULL);
    gnomon_device_list_destroy(devices);
    DONE(gnomon_techniques_list(&techniques));
    EXPECT(techniques->count > 1 && techniques->techniques[0].exact);
    EXPECT(strcmp(techniques->techniques[0].name, "frustum-traced") == 0);
    EXPECT(techniques->techniques[0].setting_count > 0 && techniques->techniques[0].diagnostic_count > 0);
    EXPECT(strlen(techniques->techniques[0].settings[0].meaning) > 0);
    EXPECT(strcmp(techniques->techniques[0].diagnostics[0].name, "decided") == 0);
    gnomon_technique_list_destroy(techniques);
}

static void check_device(const gnomon_device* device) {
    const gnomon_device_description* description;
    cl_context context;
    cl_command_queue queue;
    uint64_t bytes, peak;
    gnomon_kernel_builds builds;
    DONE(gnomon_device_describe(device, &description));
    EXPECT(strlen(description->name) > 0 && strcmp(description->lacks, "") == 0);
    DONE(gnomon_device_context(device, &context));
    DONE(gnomon_device_queue(device, &queue));
    EXPECT(context != NULL && queue != NULL);
    DONE(gnomon_device_memory(device, &bytes, &peak));
    EXPECT(bytes > 0 && peak >= bytes);
    DONE(gnomon_device_kernel_builds(device, &builds));
    EXPECT(builds.programs > 0);
}

static void check_inputs(gnomon_triangles* triangles, gnomon_points* points, const gnomon_visibility* visibility) {
    size_t count, first;
    cl_mem buffer;
    gnomon_point_layout layout;
    float positions[9];
    uint32_t receivers[3];
    cl_event event;
    DONE(gnomon_triangles_count(triangles, &count));
    EXPECT(count == 2);
    DONE(gnomon_triangles_buffer(triangles, &buffer, &first));
    EXPECT(buffer != NULL && first == 0);
    DONE(gnomon_triangles_keep_clusters(triangles, &event));
    wait_for(event);
    DONE(gnomon_points_count(points, &count));
    EXPECT(count == 3);
    DONE(gnomon_points_positions(points, &buffer, &layout));
    EXPECT(buffer != NULL && layout.first == 0 && layout.point_stride == 3 && layout.coordinate_stride == 1);
    DONE(gnomon_points_receivers(points, &buffer));
    EXPECT(buffer == NULL);
    DONE(gnomon_points_read(points, positions, receivers));
    EXPECT(memcmp(positions, ground, sizeof(ground)) == 0 && receivers[2] == GNOMON_NO_RECEIVER);
    DONE(gnomon_visibility_count(visibility, &count));
    EXPECT(count == 3);
    DONE(gnomon_visibility_buffer(visibility, &buffer));
    EXPECT(buffer != NULL);
}

static void check_technique(const gnomon_device* device, const gnomon_triangles* triangles, const gnomon_points* points,
                            const gnomon_visibility* visibility, const gnomon_light lights[2]) {
    gnomon_technique* technique;
    gnomon_visibility* second;
    const gnomon_statistics* statistics[2];
    uint8_t drawn[3 * 4];
    cl_event event;
    DONE(gnomon_technique_create(device, "frustum-traced", &technique));
    DONE(gnomon_technique_set(technique, "map-size", "64"));
    DONE(gnomon_technique_run(technique, triangles, points, lights[0], visibility, NULL, &event, &statistics[0]));
    wait_for(event);
    expect_shadows(visibility);
    EXPECT(statistics[0]->stage_count > 0 && strlen(statistics[0]->stages[0].name) > 0);
    EXPECT(statistics[0]->count_count > 0 && statistics[0]->device_memory_bytes > 0);
    gnomon_statistics_destroy(statistics[0]);
    DONE(gnomon_technique_prepare(technique, triangles, lights[0], &event, NULL));
    wait_for(event);
    DONE(gnomon_technique_run(technique, triangles, points, lights[0], visibility, NULL, NULL, NULL));
    expect_shadows(visibility);
    DONE(gnomon_technique_release_prepared_light(technique));
    DONE(gnomon_visibility_create(device, 3, &second));
    const gnomon_light_visibility both[2] = {{lights[0], visibility}, {lights[1], second}};
    DONE(gnomon_technique_run_each_light(technique, triangles, points, both, 2, NULL, &event, statistics));
    wait_for(event);
    expect_shadows(visibility);
    gnomon_statistics_destroy(statistics[0]);
    gnomon_statistics_destroy(statistics[1]);
    DONE(gnomon_technique_diagnose(technique, "decided", triangles, points, lights[0], NULL, drawn));
    EXPECT(drawn[3] == 255);
    const float normals[9] = {0, 1, 0, 0, 1, 0, 0, -1, 0};  // the lit point's is turned away
    gnomon_run_options options = GNOMON_RUN_OPTIONS_INIT;
    float lit[3];
    options.facing.kind = GNOMON_FACING_WINDING;
    DONE(gnomon_technique_run(technique, triangles, points, lights[0], visibility, &options, NULL, NULL));
    expect_shadows(visibility);  // no point has a receiver
    options.facing.kind = GNOMON_FACING_NORMALS;
    // The positions as normals: 0, x and x, none of which faces the light.
    DONE(gnomon_points_positions(points, &options.facing.normals_buffer, NULL));
    DONE(gnomon_technique_run(technique, triangles, points, lights[0], second, &options, &event, NULL));
    wait_for(event);
    DONE(gnomon_visibility_read(second, lit));
    EXPECT(lit[0] == 0 && lit[1] == 0 && lit[2] == 0);
    options.facing.normals = normals;
    DONE(gnomon_technique_run(technique, triangles, points, lights[0], visibility, &options, NULL, NULL));
    DONE(gnomon_device_finish(device));
    DONE(gnomon_visibility_read(visibility, lit));
    EXPECT(lit[2] == 0);
    gnomon_visibility_destroy(second);
    gnomon_technique_destroy(technique);
}

static int count_points(const gnomon_points* points, void* sum) {
    size_t count;
    DONE(gnomon_points_count(points, &count));
    *(size_t*)sum += count;
    return 0;
}

enum { width = 8, height = 6, pixels = width * height };

static void check_picture(const gnomon_device* device, const gnomon_triangles* triangles, const gnomon_view* view,
                          gnomon_light light) {
    const uint32_t material[2] = {0, 0};
    const float grey[3] = {0.5f, 0.5f, 0.5f};
    const gnomon_materials materials = {sizeof(materials), material, 2, grey, 1};
    gnomon_samples_options options = GNOMON_SAMPLES_OPTIONS_INIT;
    gnomon_technique* technique;
    gnomon_visibility* mean;
    const gnomon_statistics* statistics;
    size_t sum = 0;
    cl_event event;
    uint8_t* picture = malloc(pixels * 4);
    float* normals = malloc(pixels * 3 * sizeof(float));
    DONE(gnomon_technique_create(device, "frustum-traced", &technique));
    DONE(gnomon_visibility_create(device, pixels, &mean));
    options.sink = count_points;
    options.user_data = &sum;
    DONE(gnomon_technique_run_samples(technique, triangles, view, light, mean, &options, &event, &statistics));
    wait_for(event);
    EXPECT(sum == 4 * pixels);
    gnomon_statistics_destroy(statistics);
    const gnomon_light_visibility lit = {light, mean};
    DONE(gnomon_view_shade(view, triangles, &lit, 1, &materials, picture));
    EXPECT(picture[4 * (pixels / 2 + width / 2)] > 0);
    DONE(gnomon_view_read(view, triangles, NULL, normals, NULL));
    EXPECT(normals[3 * (pixels / 2 + width / 2) + 1] == 1);
    free(normals);
    free(picture);
    gnomon_visibility_destroy(mean);
    gnomon_technique_destroy(technique);
}

static void check_views(const gnomon_device* device, const gnomon_triangles* triangles, const gnomon_camera* camera,
                        gnomon_light light) {
    gnomon_view* view;
    gnomon_points* lifted;
    const gnomon_points* points;
    gnomon_camera_pass* pass;
    size_t count;
    cl_event event;
    DONE(gnomon_view_look(device, triangles, camera, width, height, &view, &event, NULL));
    wait_for(event);
    DONE(gnomon_view_points(view, &points));
    DONE(gnomon_points_count(points, &count));
    EXPECT(count == pixels);
    check_picture(device, triangles, view, light);
    DONE(gnomon_points_lift(points, triangles, camera->eye, &lifted, &event));
    wait_for(event);
    DONE(gnomon_points_set_lifted_off(lifted, triangles, camera->eye));
    DONE(gnomon_points_set_camera(lifted, camera, width, height));
    gnomon_points_destroy(lifted);
    gnomon_view_destroy(view);
    DONE(gnomon_camera_pass_create(device, &pass));
    DONE(gnomon_camera_pass_look(pass, triangles, camera, width, height, &view, &event, NULL));
    wait_for(event);
    gnomon_view_destroy(view);
    gnomon_camera_pass_destroy(pass);
}

static void check_parts_and_reasons(const gnomon_device* device, const gnomon_triangles* triangles,
                                    const gnomon_points* points, const gnomon_camera* camera, gnomon_light light) {
    const gnomon_setting settings[1] = {{"map-size", "64"}};
    const gnomon_explanation* explanation;
    const gnomon_view_of_parts* view;
    const gnomon_statistics* statistics;
    gnomon_visibility* visibility;
    gnomon_host_scene scene = GNOMON_HOST_SCENE_INIT;
    gnomon_host_scene_options options = GNOMON_HOST_SCENE_OPTIONS_INIT;
    scene.vertices = roof;
    scene.count = 2;
    options.settings = settings;
    options.setting_count = 1;
    DONE(gnomon_points_explain(points, triangles, 0, light, NULL, &explanation));
    EXPECT(explanation->occluder_count == 2 && explanation->occluders[1].blocks && explanation->is_consistent);
    EXPECT(explanation->visibility == 0 && strlen(explanation->stage) > 0);
    gnomon_explanation_destroy(explanation);
    DONE(gnomon_visibility_create(device, 3, &visibility));
    DONE(gnomon_host_scene_run(device, &scene, points, light, visibility, &options, &statistics));
    expect_shadows(visibility);
    gnomon_statistics_destroy(statistics);
    gnomon_visibility_destroy(visibility);
    DONE(gnomon_host_scene_look(device, &scene, camera, width, height, &view));
    EXPECT(view->id_count == 2 && view->ids[1] == 1 && view->view != NULL && view->triangles != NULL);
    gnomon_view_of_parts_destroy(view);
}

// The caller's own buffers: gnomon keeps them for as long as it needs them, and no longer.
static void check_wrapping(const gnomon_device* device, gnomon_light light) {
    cl_context context;
    cl_command_queue queue;
    gnomon_device* own;
    gnomon_triangles* triangles;
    gnomon_points* points;
    gnomon_visibility* visibility;
    gnomon_technique* technique;
    float result[3];
    DONE(gnomon_device_context(device, &context));
    DONE(gnomon_device_queue(device, &queue));
    DONE(gnomon_device_wrap(context, queue, NULL, &own));
    cl_mem inputs = clCreateBuffer(context, CL_MEM_READ_WRITE, sizeof(roof) + sizeof(ground), NULL, NULL);
    cl_mem output = clCreateBuffer(context, CL_MEM_READ_WRITE, sizeof(result), NULL, NULL);
    clEnqueueWriteBuffer(queue, inputs, CL_TRUE, 0, sizeof(ground), ground, 0, NULL, NULL);
    clEnqueueWriteBuffer(queue, inputs, CL_TRUE, sizeof(ground), sizeof(roof), roof, 0, NULL, NULL);
    gnomon_run_options options = GNOMON_RUN_OPTIONS_INIT;
    options.facing.kind = GNOMON_FACING_EYE;
    memcpy(options.facing.eye, above, sizeof(above));
    DONE(gnomon_triangles_wrap(own, inputs, 2, 9, &triangles));
    DONE(gnomon_points_wrap(own, inputs, NULL, 3, NULL, &points));
    DONE(gnomon_visibility_wrap(own, output, 3, 0, &visibility));
    DONE(gnomon_technique_create(own, "frustum-traced", &technique));
    gnomon_device_destroy(own);  // in any order
    clReleaseMemObject(inputs);
    DONE(gnomon_technique_run(technique, triangles, points, light, visibility, &options, NULL, NULL));
    gnomon_triangles_destroy(triangles);
    gnomon_points_destroy(points);
    gnomon_visibility_destroy(visibility);
    gnomon_technique_destroy(technique);
    EXPECT(clEnqueueReadBuffer(queue, output, CL_TRUE, 0, sizeof(result), result, 0, NULL, NULL) == CL_SUCCESS);
    EXPECT(result[0] == 0 && result[1] == 0 && result[2] == 1);
    clReleaseMemObject(output);
}

// A square of a raster over one of two points, with the light straight above.
static void check_raster(const gnomon_device* device) {
    const float x[2] = {0, 1}, y[2] = {1, 0}, heights[4] = {1, 1, 1, 1}, along_z[3] = {0, 0, -1};
    const float positions[6] = {0.25f, 0.75f, 0, 2, 0.5f, 0};
    float result[2];
    gnomon_light light;
    gnomon_triangles* triangles;
    gnomon_points* points;
    gnomon_visibility* visibility;
    gnomon_technique* technique;
    size_t count;
    DONE(gnomon_light_directional(along_z, &light));
    DONE(gnomon_technique_create(device, "frustum-traced", &technique));
    DONE(gnomon_triangles_raster(device, x, 2, y, 2, heights, true, &triangles));
    DONE(gnomon_triangles_count(triangles, &count));
    EXPECT(count == 2);
    DONE(gnomon_points_upload(device, positions, 2, NULL, &points));
    DONE(gnomon_visibility_create(device, 2, &visibility));
    DONE(gnomon_technique_run(technique, triangles, points, light, visibility, NULL, NULL, NULL));
    DONE(gnomon_visibility_read(visibility, result));
    EXPECT(result[0] == 0 && result[1] == 1);
    gnomon_technique_destroy(technique);
    gnomon_visibility_destroy(visibility);
    gnomon_points_destroy(points);
    gnomon_triangles_destroy(triangles);
}

// Two of the roof's corners as points. It is seen from above as a height field, and its windings' front is below.
static void check_fans(const gnomon_device* device, const gnomon_triangles* triangles, const gnomon_light lights[2]) {
    const float corners[9] = {roof[0], roof[1], roof[2], 99, 99, 99, roof[3], roof[4], roof[5]}, up[3] = {0, 1, 0};
    gnomon_vertex_fans* fans;
    gnomon_points* points;
    gnomon_visibility* visibility;
    gnomon_technique* technique;
    const uint32_t* ids;
    size_t count;
    uint64_t extended;
    float lit[3];
    cl_event event;
    DONE(gnomon_points_upload(device, corners, 3, NULL, &points));
    DONE(gnomon_visibility_create(device, 3, &visibility));
    DONE(gnomon_vertex_fans_find(device, roof, 2, corners, 3, &fans));
    DONE(gnomon_vertex_fans_alone(fans, &ids, &count));
    EXPECT(count == 1 && ids[0] == 1);
    DONE(gnomon_vertex_fans_open(fans, &ids, &count));
    EXPECT(count == 2 && ids[0] == 0 && ids[1] == 2);
    DONE(gnomon_technique_create(device, "frustum-traced", &technique));
    gnomon_run_options options = GNOMON_RUN_OPTIONS_INIT;
    options.facing.kind = GNOMON_FACING_FANS;
    options.facing.fans = fans;
    options.facing.up = up;
    DONE(gnomon_technique_run(technique, triangles, points, lights[0], visibility, &options, &event, NULL));
    wait_for(event);
    DONE(gnomon_visibility_read(visibility, lit));
    EXPECT(lit[0] == 1 && lit[1] == 1 && lit[2] == 1);
    DONE(gnomon_vertex_fans_extended(fans, &extended));
    EXPECT(extended == 0);  // a vertical ray leaves over all triangles
    const float down_too[3] = {0, -1, 0};
    options.facing.up = down_too;
    DONE(gnomon_technique_run(technique, triangles, points, lights[0], visibility, &options, NULL, NULL));
    DONE(gnomon_visibility_read(visibility, lit));
    EXPECT(lit[0] == 0 && lit[1] == 1 && lit[2] == 0);
    options.facing.up = NULL;
    DONE(gnomon_technique_run(technique, triangles, points, lights[0], visibility, &options, NULL, NULL));
    DONE(gnomon_vertex_fans_extended(fans, &extended));
    EXPECT(extended == 2);
    gnomon_vertex_fans_destroy(fans);
    gnomon_technique_destroy(technique);
    gnomon_visibility_destroy(visibility);
    gnomon_points_destroy(points);
}

static int note_progress(double done, void* user_data) {
    *(double*)user_data = done;
    return 0;
}

// Only the third point sees a light: the one straight above it.
static void check_many_lights(const gnomon_device* device, const gnomon_triangles* triangles,
                              const gnomon_points* points, const gnomon_visibility* visibility,
                              const gnomon_light both[2]) {
    const float weights[2] = {0.5f, 4}, up[3] = {0, 1, 0}, north[3] = {0, 0, -1}, edge[3] = {0.1f, 0, 0};
    gnomon_lights *lights, *disk, *area, *sky;
    gnomon_technique* technique;
    gnomon_light copied[2];
    float weights_copied[2], mean[3];
    uint32_t bits[3], counts[3], first[3], last[3];
    double sums[3], rounded, done = 0;
    int32_t exponent;
    size_t count;
    cl_event event;
    const gnomon_statistics* statistics;
    DONE(gnomon_lights_create(both, weights, 2, &lights));
    DONE(gnomon_lights_count(lights, &count));
    DONE(gnomon_lights_read(lights, copied, weights_copied));
    DONE(gnomon_lights_rounding(lights, &exponent, &rounded));
    EXPECT(count == 2 && rounded == 0 && exponent < 0);
    EXPECT(memcmp(copied, both, sizeof(copied)) == 0 && memcmp(weights_copied, weights, sizeof(weights)) == 0);
    DONE(gnomon_technique_create(device, "frustum-traced", &technique));
    const gnomon_light_table_arrays arrays = {sizeof(arrays), bits, counts, sums, first, last, false};
    DONE(gnomon_technique_run_light_table_to_host(technique, triangles, points, lights, &arrays, NULL, &statistics));
    gnomon_statistics_destroy(statistics);
    EXPECT(bits[0] == 0 && bits[1] == 0 && bits[2] == 1);
    EXPECT(counts[0] == 0 && counts[1] == 0 && counts[2] == 1);
    EXPECT(sums[0] == 0 && sums[1] == 0 && sums[2] == 0.5);
    EXPECT(first[0] == GNOMON_NO_LIGHT && first[2] == 0 && last[1] == GNOMON_NO_LIGHT && last[2] == 0);
    gnomon_light_table_buffers buffers = GNOMON_LIGHT_TABLE_BUFFERS_INIT;
    gnomon_run_options options = GNOMON_RUN_OPTIONS_INIT;
    options.progress = note_progress;
    options.user_data = &done;
    DONE(gnomon_visibility_buffer(visibility, &buffers.counts));
    DONE(gnomon_technique_run_light_table(technique, triangles, points, lights, &buffers, &options, NULL));
    DONE(gnomon_visibility_read(visibility, (float*)(void*)counts));
    EXPECT(counts[0] == 0 && counts[1] == 0 && counts[2] == 1 && done == 1);
    DONE(gnomon_technique_run_mean(technique, triangles, points, lights, visibility, NULL, &event, NULL));
    wait_for(event);
    DONE(gnomon_visibility_read(visibility, mean));
    EXPECT(mean[0] == 0 && mean[1] == 0 && mean[2] == 0.5f);
    DONE(gnomon_lights_sun_disk(down, 0.533, 7, &disk));
    DONE(gnomon_lights_area(above, edge, up, 3, &area));
    DONE(gnomon_lights_sky(up, north, 1, &sky));
    DONE(gnomon_lights_count(sky, &count));
    EXPECT(count == 145);
    gnomon_lights_destroy(sky);
    gnomon_lights_destroy(area);
    gnomon_lights_destroy(disk);
    gnomon_lights_destroy(lights);
    gnomon_technique_destroy(technique);
}

// What observers see is what lamps at their eyes light: one above the roof sees no point, one below it sees all.
static void check_observers(const gnomon_device* device, const gnomon_triangles* triangles,
                            const gnomon_points* points) {
    const float above_roof[3] = {0, 5, 0}, below_roof[3] = {0, 1, 0};
    gnomon_light eyes[2];
    gnomon_lights* lights;
    gnomon_technique* technique;
    uint32_t bits[3], counts[3];
    const gnomon_light_table_arrays arrays = {sizeof(arrays), bits, counts, NULL, NULL, NULL, false};
    DONE(gnomon_light_point(above_roof, &eyes[0]));
    DONE(gnomon_light_point(below_roof, &eyes[1]));
    DONE(gnomon_lights_create(eyes, NULL, 2, &lights));
    DONE(gnomon_technique_create(device, "frustum-traced", &technique));
    DONE(gnomon_technique_run_light_table_to_host(technique, triangles, points, lights, &arrays, NULL, NULL));
    for (int i = 0; i < 3; ++i) EXPECT(bits[i] == 2 && counts[i] == 1);
    gnomon_technique_destroy(technique);
    gnomon_lights_destroy(lights);
}

static void destroy_nothing(void) {
    gnomon_lights_destroy(NULL);
    gnomon_device_list_destroy(NULL);
    gnomon_technique_list_destroy(NULL);
    gnomon_statistics_destroy(NULL);
    gnomon_explanation_destroy(NULL);
    gnomon_view_of_parts_destroy(NULL);
    gnomon_device_destroy(NULL);
    gnomon_triangles_destroy(NULL);
    gnomon_points_destroy(NULL);
    gnomon_visibility_destroy(NULL);
    gnomon_vertex_fans_destroy(NULL);
    gnomon_technique_destroy(NULL);
    gnomon_view_destroy(NULL);
    gnomon_camera_pass_destroy(NULL);
}

void open_c_inputs(c_inputs* inputs) {
    gnomon_device_options options = GNOMON_DEVICE_OPTIONS_INIT;
    check_values(inputs->lights, &inputs->camera);
    DONE(gnomon_device_open(NULL, &options, &inputs->device));
    DONE(gnomon_triangles_upload(inputs->device, roof, 2, &inputs->triangles));
    DONE(gnomon_points_upload(inputs->device, ground, 3, NULL, &inputs->points));
    DONE(gnomon_visibility_create(inputs->device, 3, &inputs->visibility));
}

void close_c_inputs(c_inputs* inputs) {
    gnomon_visibility_destroy(inputs->visibility);
    gnomon_points_destroy(inputs->points);
    gnomon_triangles_destroy(inputs->triangles);
    gnomon_device_destroy(inputs->device);
}

static void lattice_and_lists(c_inputs* in) {
    (void)in;
    check_lattice();
    check_lists();
    destroy_nothing();
}
static void inputs_again(c_inputs* in) {
    gnomon_triangles* triangles;
    DONE(gnomon_triangles_upload(in->device, roof, 2, &triangles));
    check_inputs(triangles, in->points, in->visibility);
    gnomon_triangles_destroy(triangles);
}
static void technique(c_inputs* in) {
    check_technique(in->device, in->triangles, in->points, in->visibility, in->lights);
}
static void fans(c_inputs* in) { check_fans(in->device, in->triangles, in->lights); }
static void raster(c_inputs* in) { check_raster(in->device); }
static void many_lights(c_inputs* in) {
    check_many_lights(in->device, in->triangles, in->points, in->visibility, in->lights);
}
static void observers(c_inputs* in) { check_observers(in->device, in->triangles, in->points); }
static void views(c_inputs* in) { check_views(in->device, in->triangles, &in->camera, in->lights[0]); }
static void parts_and_reasons(c_inputs* in) {
    check_parts_and_reasons(in->device, in->triangles, in->points, &in->camera, in->lights[0]);
}
static void wrapping(c_inputs* in) { check_wrapping(in->device, in->lights[0]); }
static void device(c_inputs* in) { check_device(in->device); }
static void another_device(c_inputs* in) {
    c_inputs other;
    (void)in;
    open_c_inputs(&other);
    close_c_inputs(&other);
}

const c_group c_groups[] = {
    {"lattice and lists", lattice_and_lists, 0},
    {"inputs", inputs_again, 0},
    {"a technique", technique, 0},
    {"vertex fans", fans, 0},
    {"a raster", raster, 0},
    {"many lights", many_lights, 0},
    {"what observers see", observers, 0},
    {"views", views, 0},
    {"parts and reasons", parts_and_reasons, 0},
    {"a device and its description", device, 0},
    {"buffers and a queue of the caller's", wrapping, 1},
    {"a device, opened and closed", another_device, 1},
};
const size_t c_group_count = sizeof(c_groups) / sizeof(c_groups[0]);

int c_failures(void) { return failures; }

#ifndef GNOMON_C_GROUPS_ALONE
int main(void) {
    c_inputs inputs;
    EXPECT(strcmp(gnomon_last_error(), "") == 0 && gnomon_last_opencl_error() == CL_SUCCESS);
    DONE(gnomon_rivals_add());
    DONE(gnomon_opencl_load(NULL));
    open_c_inputs(&inputs);
    for (size_t i = 0; i < c_group_count; ++i) c_groups[i].run(&inputs);
    close_c_inputs(&inputs);
    return failures != 0;
}
#endif
