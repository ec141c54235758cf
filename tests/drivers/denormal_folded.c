// SPDX-License-Identifier: MIT
// Minimal reproducer of a compiler that flushes a denormal while it folds a constant (docs/drivers.md). Not built by
// CMake:
//   gcc -o /tmp/denormal_folded tests/drivers/denormal_folded.c -lOpenCL
//   RUSTICL_ENABLE=llvmpipe /tmp/denormal_folded
//
// The kernel asks two things of one float read from memory, 0x807FFFFF: is it that, and if so, is its fabs()
// 0x007FFFFF? Each alone is answered with yes. Together, the compiler knows the number in the second question, folds
// fabs(), flushes the result to zero, and answers no. gnomon does not depend on it: its exact path only loads, selects
// and stores denormals (check_copies in kernels/exact/self_check.cl).
#define CL_TARGET_OPENCL_VERSION 120
#include <CL/cl.h>
#include <stdio.h>

static const char* source =
    "__kernel void ask(__global const float* x, __global uint* answers) {\n"
    "    answers[0] = as_uint(x[0]) == 0x807FFFFFu;\n"
    "    answers[1] = as_uint(fabs(x[1])) == 0x007FFFFFu;\n"
    "    answers[2] = as_uint(x[2]) == 0x807FFFFFu && as_uint(fabs(x[2])) == 0x007FFFFFu;\n"
    "}\n";

static void ask(cl_device_id device) {
    char name[256];
    clGetDeviceInfo(device, CL_DEVICE_NAME, sizeof(name), name, NULL);
    cl_context context = clCreateContext(NULL, 1, &device, NULL, NULL, NULL);
    cl_command_queue queue = clCreateCommandQueue(context, device, 0, NULL);
    cl_program program = clCreateProgramWithSource(context, 1, &source, NULL, NULL);
    clBuildProgram(program, 1, &device, "-cl-std=CL1.2", NULL, NULL);
    cl_kernel kernel = clCreateKernel(program, "ask", NULL);
    cl_uint numbers[3] = {0x807FFFFFu, 0x807FFFFFu, 0x807FFFFFu}, answers[3] = {9, 9, 9};
    cl_mem in = clCreateBuffer(context, CL_MEM_COPY_HOST_PTR, sizeof(numbers), numbers, NULL);
    cl_mem out = clCreateBuffer(context, CL_MEM_COPY_HOST_PTR, sizeof(answers), answers, NULL);
    clSetKernelArg(kernel, 0, sizeof(in), &in);
    clSetKernelArg(kernel, 1, sizeof(out), &out);
    size_t one = 1;
    clEnqueueNDRangeKernel(queue, kernel, 1, NULL, &one, &one, 0, NULL, NULL);
    clEnqueueReadBuffer(queue, out, CL_TRUE, 0, sizeof(answers), answers, 0, NULL, NULL);
    printf("%s: number %u, fabs %u, both %u%s\n", name, answers[0], answers[1], answers[2],
           answers[2] == 1 ? "" : "  <- wrong");
    clReleaseMemObject(in);
    clReleaseMemObject(out);
    clReleaseKernel(kernel);
    clReleaseProgram(program);
    clReleaseCommandQueue(queue);
    clReleaseContext(context);
}

int main(void) {
    cl_platform_id platforms[16];
    cl_uint platform_count = 0;
    clGetPlatformIDs(16, platforms, &platform_count);
    for (cl_uint i = 0; i < platform_count && i < 16; ++i) {
        cl_device_id devices[16];
        cl_uint device_count = 0;
        if (clGetDeviceIDs(platforms[i], CL_DEVICE_TYPE_ALL, 16, devices, &device_count) != CL_SUCCESS) continue;
        for (cl_uint k = 0; k < device_count && k < 16; ++k) ask(devices[k]);
    }
    return 0;
}
