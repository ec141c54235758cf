// SPDX-License-Identifier: MIT
// Runs a tiny kernel with the fault named on the command line (none, out_of_bounds or race), so that
// the tests can see that oclgrind's findings do fail a test. Plain OpenCL: it must work when gnomon does not.
#include <iostream>
#include <string>
#include <vector>

#include <gnomon.hpp>

namespace {

const char* kernel_source = R"(
kernel void none(global float* out) { out[get_global_id(0)] = 1.0f; }
kernel void out_of_bounds(global float* out) { out[get_global_id(0) + 1] = 1.0f; }
kernel void race(global float* out) { out[0] += get_global_id(0); })";

void check(cl_int error, const char* call) {
    if (error != CL_SUCCESS) throw gnomon::OpenClError(call, error);
}

void run(const std::string& kernel_name) {
    cl_platform_id platform = nullptr;
    check(clGetPlatformIDs(1, &platform, nullptr), "clGetPlatformIDs");
    std::string name(256, '\0');
    check(clGetPlatformInfo(platform, CL_PLATFORM_NAME, name.size(), name.data(), nullptr), "clGetPlatformInfo");
    if (name.find("Oclgrind") == std::string::npos) throw gnomon::DeviceNotFound("run this under oclgrind");

    cl_device_id device = nullptr;
    check(clGetDeviceIDs(platform, CL_DEVICE_TYPE_ALL, 1, &device, nullptr), "clGetDeviceIDs");
    cl_int error = CL_SUCCESS;
    cl_context context = clCreateContext(nullptr, 1, &device, nullptr, nullptr, &error);
    check(error, "clCreateContext");
    cl_command_queue queue = clCreateCommandQueue(context, device, 0, &error);
    check(error, "clCreateCommandQueue");
    cl_program program = clCreateProgramWithSource(context, 1, &kernel_source, nullptr, &error);
    check(error, "clCreateProgramWithSource");
    check(clBuildProgram(program, 1, &device, "", nullptr, nullptr), "clBuildProgram");
    cl_kernel kernel = clCreateKernel(program, kernel_name.c_str(), &error);
    check(error, "clCreateKernel");

    std::vector<float> zeros(64);
    cl_mem out = clCreateBuffer(context, CL_MEM_READ_WRITE | CL_MEM_COPY_HOST_PTR, zeros.size() * sizeof(float),
                                zeros.data(), &error);
    check(error, "clCreateBuffer");
    check(clSetKernelArg(kernel, 0, sizeof(out), &out), "clSetKernelArg");
    const std::size_t global_size = zeros.size(), local_size = 8;
    check(clEnqueueNDRangeKernel(queue, kernel, 1, nullptr, &global_size, &local_size, 0, nullptr, nullptr),
          "clEnqueueNDRangeKernel");
    check(clFinish(queue), "clFinish");

    clReleaseMemObject(out);
    clReleaseKernel(kernel);
    clReleaseProgram(program);
    clReleaseCommandQueue(queue);
    clReleaseContext(context);
}

}  // namespace

int main(int argument_count, char** arguments) try {
    run(argument_count > 1 ? arguments[1] : "none");
    run("none");  // in a context of its own: what the first one's log says must not be lost
} catch (const gnomon::Error& error) {
    std::cerr << error.what() << '\n';
    return 1;
}
