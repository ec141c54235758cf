// SPDX-License-Identifier: MIT
// Devices for stage tests, buffers up and down, and canaries: words past an output that the stage must leave alone.
#pragma once

#include <gtest/gtest.h>

#include <cstdint>
#include <map>
#include <utility>
#include <vector>

#include "query/inputs.hpp"

namespace support {

/// Work-group sizes for stages with cheap kernels: one, powers of two, and sizes that divide nothing.
inline constexpr std::uint32_t WORK_GROUP_SIZES[] = {1, 2, 3, 7, 16, 33, 64, 128};
/// The same for stages whose kernels take long to compile (a CPU driver compiles them anew for each size).
inline constexpr std::uint32_t FEW_WORK_GROUP_SIZES[] = {3, 64};

/// The open devices, one for each size of work-groups and kind of kernels: a new one would build all programs again,
/// which takes PoCL a second even where its cache has them.
inline std::map<std::pair<std::uint32_t, bool>, gnomon::Device>& opened_devices() {
    static std::map<std::pair<std::uint32_t, bool>, gnomon::Device> opened;
    return opened;
}

inline gnomon::Device opened_device(std::uint32_t work_group_size, bool gpu_kernels) {
    const std::pair kind(work_group_size, gpu_kernels);
    if (!opened_devices().contains(kind)) {
        gnomon::DeviceOptions options;
        options.work_group_size = work_group_size;
        options.gpu_kernels = gpu_kernels;
        opened_devices().emplace(kind, gnomon::Device({}, options));
    }
    return opened_devices().at(kind);
}

/// Closes them before the program ends: the statics of drivers and layers may be gone before a device that is one.
struct ClosedDevices : testing::Environment {
    void TearDown() override { opened_devices().clear(); }
};
inline testing::Environment* const closed_devices = testing::AddGlobalTestEnvironment(new ClosedDevices);

/// Work-group size 0: the library's choice.
inline gnomon::Device device_with(std::uint32_t work_group_size = 0) { return opened_device(work_group_size, false); }

/// With the kernels that are made for GPUs, or with those of its kind.
inline gnomon::Device device_of(bool gpu_kernels) { return opened_device(0, gpu_kernels); }

template <typename Value>
gnomon::cl::Buffer uploaded(gnomon::cl::Session& session, const std::vector<Value>& values) {
    gnomon::cl::Buffer buffer(session, values.size() * sizeof(Value));
    session.write(buffer.get(), values.data(), values.size() * sizeof(Value));
    return buffer;
}

template <typename Value>
std::vector<Value> downloaded(gnomon::cl::Session& session, cl_mem buffer, std::size_t count) {
    std::vector<Value> values(count);
    session.read(buffer, values.data(), count * sizeof(Value));
    return values;
}

inline constexpr std::uint32_t CANARY = 0xDEADC0DEu;

/// Fills the whole buffer with canaries.
inline void put_canaries(gnomon::cl::Session& session, const gnomon::cl::Buffer& buffer) {
    session.fill(buffer, CANARY, buffer.bytes() / 4 * 4);
}

/// Expects at least one word from byte `first` on, and a canary in each of them.
inline void expect_canaries(gnomon::cl::Session& session, const gnomon::cl::Buffer& buffer, std::size_t first,
                            const char* what) {
    ASSERT_GE(buffer.bytes(), first + 4) << what << " leaves no room for canaries";
    const auto words = downloaded<std::uint32_t>(session, buffer.get(), buffer.bytes() / 4);
    for (std::size_t i = first / 4; i < words.size(); ++i)
        ASSERT_EQ(words[i], CANARY) << what << ": word " << i << " lies past the output and was written";
}

}  // namespace support
