// SPDX-License-Identifier: MIT
// gnomon inside a C program that uses OpenCL itself: the program's own context, queue and buffers. Kernels of the
// program write the triangles and the points, gnomon writes their visibility, and a kernel counts the lit points. The
// arrays exist on the device alone: one number is copied to the host.
#include <gnomon.h>

#include <stdio.h>
#include <stdlib.h>

// A checkerboard of 64 x 64 cells: a roof of two triangles above every other cell, a point under the middle of each.
enum { side = 64, cells = side * side, triangles_count = cells };

static const char* const source =
    "__kernel void make_roofs(__global float* vertices) {\n"
    "    size_t cell = 2 * get_global_id(0) + get_global_id(0) / (SIDE / 2) % 2;\n"
    "    float x = cell % SIDE, z = cell / SIDE;\n"
    "    const float corners[12] = {x, z, x + 1, z, x + 1, z + 1, x, z, x + 1, z + 1, x, z + 1};\n"
    "    for (int i = 0; i < 6; ++i) {\n"
    "        __global float* vertex = vertices + 18 * get_global_id(0) + 3 * i;\n"
    "        vertex[0] = corners[2 * i];\n"
    "        vertex[1] = 2;\n"
    "        vertex[2] = corners[2 * i + 1];\n"
    "    }\n"
    "}\n"
    "__kernel void make_ground(__global float* xs_ys_zs) {\n"  // a structure of arrays: all x, all y, all z
    "    size_t cell = get_global_id(0);\n"
    "    xs_ys_zs[cell] = cell % SIDE + 0.5f;\n"
    "    xs_ys_zs[SIDE * SIDE + cell] = 0;\n"
    "    xs_ys_zs[2 * SIDE * SIDE + cell] = cell / SIDE + 0.5f;\n"
    "}\n"
    "__kernel void count_lit(__global const float* visibility, __global uint* lit) {\n"
    "    if (visibility[get_global_id(0)] == 1) atomic_inc(lit);\n"
    "}\n";

static void require(cl_int code, const char* what) {
    if (code == CL_SUCCESS) return;
    fprintf(stderr, "%s failed (%d)\n", what, (int)code);
    exit(1);
}

static void done(gnomon_status status) {
    if (status == GNOMON_SUCCESS) return;
    fprintf(stderr, "%s: %s\n", gnomon_status_name(status), gnomon_last_error());
    exit(1);
}

static cl_device_id default_device(void) {
    const gnomon_device_list* list;
    cl_device_id chosen = NULL;
    done(gnomon_devices_list(&list));
    for (size_t i = 0; i < list->count; ++i)
        if (list->devices[i].is_default) chosen = list->devices[i].device_id;
    gnomon_device_list_destroy(list);
    return chosen;
}

static cl_mem make_buffer(cl_context context, size_t bytes) {
    cl_int code;
    cl_mem buffer = clCreateBuffer(context, CL_MEM_READ_WRITE, bytes, NULL, &code);
    require(code, "clCreateBuffer");
    return buffer;
}

// Runs a kernel of the program, whose arguments are buffers, once `after` (NULL: nothing) has completed.
static void launch(cl_command_queue queue, cl_program program, const char* name, size_t items, cl_mem first,
                   cl_mem second, cl_event after) {
    cl_int code;
    cl_kernel kernel = clCreateKernel(program, name, &code);
    require(code, name);
    require(clSetKernelArg(kernel, 0, sizeof(first), &first), name);
    if (second != NULL) require(clSetKernelArg(kernel, 1, sizeof(second), &second), name);
    require(clEnqueueNDRangeKernel(queue, kernel, 1, NULL, &items, NULL, after != NULL, after != NULL ? &after : NULL,
                                   NULL),
            name);
    clReleaseKernel(kernel);
}

// Enqueues gnomon's work. The event, which belongs to the caller, completes when `visibility` has its values.
static cl_event cast_shadows(cl_context context, cl_command_queue queue, cl_mem vertices, cl_mem positions,
                             cl_mem visibility) {
    const float down[3] = {0, -1, 0};
    const gnomon_point_layout layout = {0, 1, cells};
    // README begins
    gnomon_device* device;
    gnomon_triangles* triangles;
    gnomon_points* points;
    gnomon_visibility* result;
    gnomon_technique* technique;
    gnomon_light sun;
    cl_event event;
    done(gnomon_device_wrap(context, queue, NULL, &device));
    done(gnomon_triangles_wrap(device, vertices, triangles_count, 0, &triangles));
    done(gnomon_points_wrap(device, positions, &layout, cells, NULL, &points));
    done(gnomon_visibility_wrap(device, visibility, cells, 0, &result));
    done(gnomon_technique_create(device, "frustum-traced", &technique));
    done(gnomon_light_directional(down, &sun));
    done(gnomon_technique_run(technique, triangles, points, sun, result, NULL, &event, NULL));
    // README ends
    gnomon_technique_destroy(technique);
    gnomon_visibility_destroy(result);
    gnomon_points_destroy(points);
    gnomon_triangles_destroy(triangles);
    gnomon_device_destroy(device);
    return event;
}

int main(void) {
    cl_int code;
    cl_device_id device = default_device();
    cl_context context = clCreateContext(NULL, 1, &device, NULL, NULL, &code);
    require(code, "clCreateContext");
    cl_command_queue queue = clCreateCommandQueue(context, device, 0, &code);  // in order
    require(code, "clCreateCommandQueue");
    const char* text = source;
    cl_program program = clCreateProgramWithSource(context, 1, &text, NULL, &code);
    require(code, "clCreateProgramWithSource");
    require(clBuildProgram(program, 1, &device, "-D SIDE=64", NULL, NULL), "clBuildProgram");

    cl_mem vertices = make_buffer(context, triangles_count * 9 * sizeof(float));
    cl_mem positions = make_buffer(context, cells * 3 * sizeof(float));
    cl_mem visibility = make_buffer(context, cells * sizeof(float));
    cl_mem lit_points = make_buffer(context, sizeof(cl_uint));
    const cl_uint zero = 0;
    require(clEnqueueFillBuffer(queue, lit_points, &zero, sizeof(zero), 0, sizeof(zero), 0, NULL, NULL), "fill");
    launch(queue, program, "make_roofs", cells / 2, vertices, NULL, NULL);
    launch(queue, program, "make_ground", cells, positions, NULL, NULL);
    cl_event shadows_done = cast_shadows(context, queue, vertices, positions, visibility);
    launch(queue, program, "count_lit", cells, visibility, lit_points, shadows_done);

    cl_uint lit = 0;
    require(clEnqueueReadBuffer(queue, lit_points, CL_TRUE, 0, sizeof(lit), &lit, 0, NULL, NULL), "read");
    printf("%u of %d points are in the light\n", lit, cells);

    clReleaseEvent(shadows_done);
    clReleaseMemObject(lit_points);
    clReleaseMemObject(visibility);
    clReleaseMemObject(positions);
    clReleaseMemObject(vertices);
    clReleaseProgram(program);
    clReleaseCommandQueue(queue);
    clReleaseContext(context);
    return lit == cells / 2 ? 0 : 1;
}
