// SPDX-License-Identifier: MIT
// gnomon inside a program that uses OpenCL itself: the program's own context, queue and buffers, and a kernel of its
// own that takes the visibility where gnomon left it. Nothing passes through the host in between.
#include <gnomon.hpp>

#include <cstdio>
#include <stdexcept>
#include <vector>

namespace {

void require(cl_int code, const char* what) {
    if (code != CL_SUCCESS) throw std::runtime_error(std::string(what) + " failed");
}

cl_mem make_buffer(cl_context context, cl_mem_flags flags, std::size_t bytes, void* data) {
    cl_int code;
    cl_mem buffer = clCreateBuffer(context, flags, bytes, data, &code);
    require(code, "clCreateBuffer");
    return buffer;
}

cl_kernel make_kernel(cl_context context, cl_device_id device, const char* source, const char* name) {
    cl_int code;
    cl_program program = clCreateProgramWithSource(context, 1, &source, nullptr, &code);
    require(code, "clCreateProgramWithSource");
    require(clBuildProgram(program, 1, &device, "", nullptr, nullptr), "clBuildProgram");
    cl_kernel kernel = clCreateKernel(program, name, &code);
    require(code, "clCreateKernel");
    clReleaseProgram(program);
    return kernel;
}

constexpr const char* brighten = R"(
    __kernel void brighten(__global const float* visibility, __global float* brightness) {
        size_t i = get_global_id(0);
        brightness[i] = 0.25f + 0.75f * visibility[i];
    })";

}  // namespace

int main() try {
    // The program's own device; here the one that gnomon would choose.
    cl_device_id device = nullptr;
    for (const gnomon::DeviceDescription& found : gnomon::devices())
        if (found.is_default) device = found.device_id;
    cl_int code;
    cl_context context = clCreateContext(nullptr, 1, &device, nullptr, nullptr, &code);
    require(code, "clCreateContext");
    cl_command_queue queue = clCreateCommandQueue(context, device, 0, &code);  // in order
    require(code, "clCreateCommandQueue");

    // A roof of two triangles, and three points that lie as a structure of arrays: all x, all y, all z.
    std::vector<float> roof{-1, 2, -1, 1, 2, -1, 1, 2, 1, -1, 2, -1, 1, 2, 1, -1, 2, 1};
    constexpr std::size_t count = 3;
    std::vector<float> ground{0, 1, 1.001f, 0, 0, 0, 0, 0, 0};
    constexpr cl_mem_flags copied = CL_MEM_READ_ONLY | CL_MEM_COPY_HOST_PTR;
    cl_mem vertices = make_buffer(context, copied, roof.size() * sizeof(float), roof.data());
    cl_mem positions = make_buffer(context, copied, ground.size() * sizeof(float), ground.data());
    cl_mem visibility = make_buffer(context, CL_MEM_READ_WRITE, count * sizeof(float), nullptr);
    cl_mem brightness = make_buffer(context, CL_MEM_READ_WRITE, count * sizeof(float), nullptr);

    {
        // Whatever is wrapped is retained: it may be released before or after these go.
        const gnomon::Device own(context, queue);
        const auto technique = gnomon::make_technique("frustum-traced", own);
        technique->run(gnomon::Triangles::wrap(own, vertices, roof.size() / 9),
                       gnomon::Points::wrap(own, positions, gnomon::PointLayout{0, 1, count}, count),
                       gnomon::Light::directional({0, -1, 0}), gnomon::Visibility::wrap(own, visibility, count));
    }

    // On the same queue, so after gnomon's last kernel.
    cl_kernel kernel = make_kernel(context, device, brighten, "brighten");
    require(clSetKernelArg(kernel, 0, sizeof(visibility), &visibility), "clSetKernelArg");
    require(clSetKernelArg(kernel, 1, sizeof(brightness), &brightness), "clSetKernelArg");
    require(clEnqueueNDRangeKernel(queue, kernel, 1, nullptr, &count, nullptr, 0, nullptr, nullptr), "brighten");
    std::vector<float> result(count);
    require(
        clEnqueueReadBuffer(queue, brightness, CL_TRUE, 0, count * sizeof(float), result.data(), 0, nullptr, nullptr),
        "clEnqueueReadBuffer");
    for (std::size_t i = 0; i < count; ++i) std::printf("point %zu is %.2f bright\n", i, result[i]);

    clReleaseKernel(kernel);
    for (cl_mem buffer : {vertices, positions, visibility, brightness}) clReleaseMemObject(buffer);
    clReleaseCommandQueue(queue);
    clReleaseContext(context);
    return result == std::vector<float>{0.25f, 0.25f, 1} ? 0 : 1;
} catch (const std::exception& error) {  // gnomon::Error is one
    std::fprintf(stderr, "%s\n", error.what());
    return 1;
}
