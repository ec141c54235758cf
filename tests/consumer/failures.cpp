// SPDX-License-Identifier: MIT
// The library's exceptions reach a program whose own symbols are hidden, each as what it is.
#include <gnomon.hpp>

#include <cstdio>

namespace {

template <typename Expected, typename Call>
void expect(const char* name, const Call& call) {
    try {
        call();
        std::printf("no %s\n", name);
    } catch (const Expected&) {
        std::printf("%s\n", name);
    } catch (...) {
        std::printf("no %s, but another\n", name);
    }
}

}  // namespace

int main() {
    expect<gnomon::InvalidArgument>("InvalidArgument", [] { gnomon::Light::directional({0, 0, 0}); });
    expect<gnomon::DeviceNotFound>("DeviceNotFound", [] { gnomon::Device device("no device has this name"); });
    const auto exceed_memory = [] {
        const gnomon::Device device({}, {.memory_limit_bytes = 8});
        gnomon::Triangles::upload(device, std::vector<float>(9));
    };
    expect<gnomon::OutOfDeviceMemory>("OutOfDeviceMemory", exceed_memory);
    expect<gnomon::OpenClError>("OpenClError", exceed_memory);
    expect<gnomon::Error>("Error", exceed_memory);
    expect<std::runtime_error>("runtime_error", exceed_memory);
}
