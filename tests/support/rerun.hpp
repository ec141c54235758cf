// SPDX-License-Identifier: MIT
// The command to paste after a failure: it leads from a point of a test's scene to the triangles and the exact signs
// that decide it. The scene is written to the temporary folder, once for each content.
#pragma once

#include <array>
#include <cstdint>
#include <cstdio>
#include <filesystem>
#include <fstream>
#include <optional>
#include <span>
#include <string>

namespace gnomon_test {

inline constexpr std::uint32_t rerun_without_receiver = 0xFFFFFFFFu;  // gnomon::no_receiver

/// "x,y,z" with the nine digits that give the same floats again.
inline std::string rerun_numbers(float x, float y, float z) {
    char text[64];
    std::snprintf(text, sizeof(text), "%.9g,%.9g,%.9g", double(x), double(y), double(z));
    return text;
}

/// The file that holds these triangles, nine floats each, as `gnomon render --dump-triangles` writes them.
inline std::filesystem::path rerun_triangles(std::span<const float> triangles) {
    std::uint64_t hash = 14695981039346656037ull;  // FNV-1a
    for (const std::byte byte : std::as_bytes(triangles)) hash = (hash ^ std::uint64_t(byte)) * 1099511628211ull;
    char name[48];
    std::snprintf(name, sizeof(name), "gnomon_%016llx.triangles", static_cast<unsigned long long>(hash));
    std::error_code ignored;
    const std::filesystem::path file = std::filesystem::temp_directory_path() / name;
    if (std::filesystem::file_size(file, ignored) != triangles.size_bytes() || ignored)
        std::ofstream(file, std::ios::binary)
            .write(reinterpret_cast<const char*>(triangles.data()), std::streamsize(triangles.size_bytes()));
    return file;
}

/// The command that explains one point. `light`: minus the direction and 0, or the position and 1, as gnomon::Light has
/// it. With `eye`, the point can face away from the light.
inline std::string rerun_command(std::span<const float> triangles, std::array<float, 3> point, std::uint32_t receiver,
                                 std::array<float, 4> light, std::optional<std::array<float, 3>> eye = {}) {
    const bool is_directional = light[3] == 0.0f;
    std::string command = "gnomon explain --triangles " + rerun_triangles(triangles).string() +
                          " --point=" + rerun_numbers(point[0], point[1], point[2]);
    if (receiver != rerun_without_receiver) command += " --receiver " + std::to_string(receiver);
    command += is_directional ? " --light-direction=" + rerun_numbers(-light[0], -light[1], -light[2])
                              : " --light-position=" + rerun_numbers(light[0], light[1], light[2]);
    if (eye) command += " --eye=" + rerun_numbers((*eye)[0], (*eye)[1], (*eye)[2]);
    return command;
}

}  // namespace gnomon_test
