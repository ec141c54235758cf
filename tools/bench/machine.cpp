// SPDX-License-Identifier: MIT
#include "machine.hpp"

#include <sys/utsname.h>

#include <cstdlib>
#include <ctime>
#include <fstream>
#include <string>
#include <thread>

#include <gnomon.hpp>
#include "commit.hpp"

namespace gnomon::bench {

namespace {

// What follows the first `key` and `separator` in a file of lines "key separator value"; "unknown" without one.
std::string line_of(const char* file, const std::string& key, char separator) {
    std::ifstream stream(file);
    for (std::string line; std::getline(stream, line);) {
        if (!line.starts_with(key)) continue;
        const std::size_t start = line.find_first_not_of(" \t\"", line.find(separator) + 1);
        if (start == std::string::npos) continue;
        const std::size_t end = line.find_last_not_of(" \t\"");
        return line.substr(start, end + 1 - start);
    }
    return "unknown";
}

std::string now_utc() {
    const std::time_t now = std::time(nullptr);
    char text[32];
    std::strftime(text, sizeof(text), "%Y-%m-%d %H:%M UTC", std::gmtime(&now));
    return text;
}

nlohmann::ordered_json environment_json() {
    nlohmann::ordered_json json = nlohmann::ordered_json::object();
    for (const char* name : {"POCL_MAX_PTHREAD_COUNT", "POCL_AFFINITY", "GNOMON_BUILD_OPTIONS", "GNOMON_KERNELS_DIR"})
        if (const char* value = std::getenv(name)) json[name] = value;
    return json;
}

}  // namespace

nlohmann::ordered_json machine_json(unsigned threads, const std::string& embree) {
    utsname system{};
    uname(&system);
    double load[3] = {};
    getloadavg(load, 3);
    nlohmann::ordered_json opencl = nlohmann::ordered_json::array();
    for (const DeviceDescription& device : devices())
        opencl.push_back({{"name", device.name},
                          {"platform", device.platform},
                          {"driver", device.driver_version},
                          {"opencl", device.opencl_version},
                          {"compute_units", device.compute_units}});
    return {{"date", now_utc()},
            {"gnomon", std::string(version())},
            {"commit", commit},
            {"processor", line_of("/proc/cpuinfo", "model name", ':')},
            {"logical_cores", std::thread::hardware_concurrency()},
            {"threads", threads},
            {"memory", line_of("/proc/meminfo", "MemTotal", ':')},
            {"system", line_of("/etc/os-release", "PRETTY_NAME", '=')},
            {"kernel", system.release},
            {"compiler", "GCC or clang " __VERSION__},
            {"embree", embree},
            {"load_average_at_start", load[0]},
            {"environment", environment_json()},
            {"opencl_devices", opencl}};
}

}  // namespace gnomon::bench
