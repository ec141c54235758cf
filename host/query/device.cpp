// SPDX-License-Identifier: MIT
// The public functions of a device; the rest of a session stands in cl/session.cpp.
#include <gnomon.hpp>

#include "cl/session.hpp"
#include "exact/self_check.hpp"

namespace gnomon {

#define GN_TEXT_OF(number) #number
#define GN_VERSION_TEXT(major, minor, patch) GN_TEXT_OF(major) "." GN_TEXT_OF(minor) "." GN_TEXT_OF(patch)
std::string_view version() { return GN_VERSION_TEXT(GNOMON_VERSION_MAJOR, GNOMON_VERSION_MINOR, GNOMON_VERSION_PATCH); }
#undef GN_TEXT_OF
#undef GN_VERSION_TEXT

Device::Device(std::string_view selector, const DeviceOptions& options)
    : session_(open_checked(options, [found = cl::select_device(selector)](const DeviceOptions& chosen) {
          return std::make_shared<cl::Session>(found, chosen);
      })) {}

Device::Device(cl_context context, cl_command_queue queue, const DeviceOptions& options)
    : session_(open_checked(options, [context, queue](const DeviceOptions& chosen) {
          return std::make_shared<cl::Session>(context, queue, chosen);
      })) {}

const DeviceDescription& Device::description() const { return session_->description(); }
cl_context Device::context() const { return session_->context(); }
cl_command_queue Device::queue() const { return session_->queue(); }
void Device::finish() const { session_->finish(); }
std::uint64_t Device::memory_bytes() const { return session_->memory_bytes(); }
std::uint64_t Device::peak_memory_bytes() const { return session_->peak_memory_bytes(); }
KernelBuilds Device::kernel_builds() const { return session_->kernel_builds(); }

}  // namespace gnomon
