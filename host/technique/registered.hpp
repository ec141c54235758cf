// SPDX-License-Identifier: MIT
// The register of techniques. A technique's class stands in its own file.
#pragma once

#include <functional>
#include <gnomon.hpp>

namespace gnomon {

struct Registered {
    TechniqueDescription description;
    std::function<std::unique_ptr<Technique>(const Device&)> make;
};

template <typename T>
Registered registered() {
    return {T::describe(), [](const Device& device) { return std::make_unique<T>(device); }};
}

Registered frustum_traced_technique();

/// Adds techniques to those that make_technique() knows (rivals/rivals.cpp). Any thread may call it.
void register_techniques(std::vector<Registered> techniques);

}  // namespace gnomon
