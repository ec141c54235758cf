// SPDX-License-Identifier: MIT
#include "setup.hpp"

#include "terminal.hpp"

namespace gnomon::app {

Device open_device(const ViewOptions& options, bool profile) {
    DeviceOptions device_options;
    device_options.profile = profile;
    device_options.memory_limit_bytes = options.memory_limit_bytes;
    return Device(options.device, device_options);
}

scene::Scene load_scene(const ViewOptions& options) {
    scene::Scene loaded = options.scene ? scene::load(*options.scene) : scene::sundial();
    if (options.strict && !loaded.warnings.empty())
        throw Error(loaded.warnings.front() + " (an error because of --strict)");
    for (const std::string& warning : loaded.warnings) print_warning(warning);
    return loaded;
}

std::unique_ptr<Technique> make_technique(const Device& device, const std::string& name,
                                          const std::vector<std::pair<std::string, std::string>>& settings) {
    std::unique_ptr<Technique> technique = gnomon::make_technique(name, device);
    for (const auto& [key, value] : settings) technique->set(key, value);
    return technique;
}

}  // namespace gnomon::app
