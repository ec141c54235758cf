// SPDX-License-Identifier: MIT
// OpenCL's functions, loaded when they are first needed: gnomon builds, installs and links without an OpenCL library,
// and a program that never opens a device never loads one. Inside namespace gnomon, a call of clFinish() finds the
// pointer gnomon::clFinish, so that the calls look as OpenCL's documentation writes them.
#pragma once

#include <string>

#include "forks.hpp"
#include "gnomon.hpp"

// Every OpenCL function that gnomon calls. All belong to OpenCL 1.2.
// clang-format off
#define GN_OPENCL_FUNCTIONS(use) \
    use(clBuildProgram) use(clCreateBuffer) use(clCreateCommandQueue) use(clCreateContext) use(clCreateKernel) \
    use(clCreateProgramWithBinary) use(clCreateProgramWithSource) use(clCreateSubBuffer) use(clEnqueueCopyBuffer) \
    use(clEnqueueFillBuffer) use(clEnqueueMapBuffer) use(clEnqueueMarkerWithWaitList) use(clEnqueueNDRangeKernel) \
    use(clEnqueueReadBuffer) use(clEnqueueUnmapMemObject) use(clEnqueueWriteBuffer) use(clFinish) \
    use(clGetCommandQueueInfo) use(clGetDeviceIDs) use(clGetDeviceInfo) \
    use(clGetEventProfilingInfo) use(clGetKernelInfo) use(clGetKernelWorkGroupInfo) use(clGetMemObjectInfo) \
    use(clGetPlatformIDs) use(clGetPlatformInfo) use(clGetProgramBuildInfo) use(clGetProgramInfo) use(clReleaseCommandQueue) \
    use(clReleaseContext) use(clReleaseEvent) use(clReleaseKernel) use(clReleaseMemObject) use(clReleaseProgram) \
    use(clRetainCommandQueue) use(clRetainContext) use(clRetainEvent) use(clRetainMemObject) use(clSetKernelArg)
// clang-format on

namespace gnomon {

#define GN_DECLARE(name) extern cl::Function<decltype(&::name)> name;
GN_OPENCL_FUNCTIONS(GN_DECLARE)
#undef GN_DECLARE

namespace cl {
/// Loads OpenCL's functions unless they are loaded. Returns an empty text, or the sentence why it failed.
std::string try_to_load_opencl(const std::string& library = {});
}  // namespace cl

}  // namespace gnomon
