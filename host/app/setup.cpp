// SPDX-License-Identifier: MIT
#include "setup.hpp"

#include <cstring>
#include <fstream>
#include <iterator>

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

scene::Scene load_triangles(const std::filesystem::path& file) {
    std::ifstream stream(file, std::ios::binary);
    const std::vector<char> bytes{std::istreambuf_iterator<char>(stream), std::istreambuf_iterator<char>()};
    if (!stream.is_open() || stream.bad()) throw Error("cannot read " + file.string());
    constexpr std::size_t triangle_bytes = 9 * sizeof(float);
    if (bytes.size() % triangle_bytes != 0)
        throw Error(file.string() + " holds " + std::to_string(bytes.size()) +
                    " bytes: triangles take 36 bytes each, nine float32");
    scene::Scene scene;
    scene.triangles.resize(bytes.size() / sizeof(float));
    std::memcpy(scene.triangles.data(), bytes.data(), bytes.size());
    return scene;
}

std::unique_ptr<Technique> make_technique(const Device& device, const std::string& name,
                                          const std::vector<std::pair<std::string, std::string>>& settings) {
    std::unique_ptr<Technique> technique = gnomon::make_technique(name, device);
    for (const auto& [key, value] : settings) technique->set(key, value);
    return technique;
}

}  // namespace gnomon::app
