// SPDX-License-Identifier: MIT
// Fuzz target: the bytes are a scene file, .glb or .gltf. Whatever they are, loading ends with a scene that keeps its
// promises (host/scene/scene.hpp) or with a SceneError of one line; beside it lies a file data.bin for the scene to
// name as a buffer.
#include <sys/stat.h>
#include <unistd.h>

#include <algorithm>
#include <cmath>
#include <cstddef>
#include <cstdint>
#include <cstdlib>
#include <filesystem>
#include <fstream>
#include <optional>
#include <string>

#include "require.hpp"
#include "scene.hpp"

namespace {

using fuzz::require;

/// A folder in memory where there is one, gone when the program ends well.
class Folder {
public:
    Folder() {
        const bool has_memory = std::filesystem::is_directory("/dev/shm");
        std::string pattern =
            ((has_memory ? "/dev/shm" : std::filesystem::temp_directory_path()) / "gnomon_fuzz_XXXXXX").string();
        require(mkdtemp(pattern.data()) != nullptr, "a folder for the scenes");
        path_ = pattern;
        std::string counting(64, '\0');
        for (std::size_t i = 0; i < counting.size(); ++i) counting[i] = char(i % 4);  // small indices, tiny floats
        write("data.bin", counting.data(), counting.size());
    }
    ~Folder() {
        std::error_code ignored;
        std::filesystem::remove_all(path_, ignored);
    }

    std::filesystem::path write(const std::string& name, const void* bytes, std::size_t size) const {
        const std::filesystem::path file = path_ / name;
        std::ofstream stream(file, std::ios::binary);
        stream.write(static_cast<const char*>(bytes), std::streamsize(size));
        require(bool(stream), "room for the scene's file");
        return file;
    }

private:
    std::filesystem::path path_;
};

bool is_finite(const gnomon::Float3& v) { return std::isfinite(v[0]) && std::isfinite(v[1]) && std::isfinite(v[2]); }

bool is_unit(const std::array<double, 3>& v) {
    return std::fabs(std::sqrt(v[0] * v[0] + v[1] * v[1] + v[2] * v[2]) - 1) < 1e-9;
}

void check_camera(const gnomon::Camera& camera) {
    require(is_finite(camera.eye), "a finite eye");
    require(is_unit(camera.right) && is_unit(camera.up) && is_unit(camera.forward), "axes of unit length");
    require(camera.fov_y_radians > 0 && camera.fov_y_radians < 3.15, "a field of view between 0 and 180 degrees");
}

bool is_one_line(const std::string& text) {
    return !text.empty() && std::none_of(text.begin(), text.end(), [](unsigned char c) { return c < 32 || c == 127; });
}

/// Images are those of any decoder, or cannot be read.
void require_readable(std::span<const unsigned char> bytes) {
    if (bytes.empty() || bytes[0] % 2 != 0) throw gnomon::Error("an odd image");
}
gnomon::scene::SceneCutOuts::Texture decoded_alpha(std::span<const unsigned char> bytes) {
    require_readable(bytes);
    return {2, 1, {bytes[0], 255}};
}
gnomon::scene::ColorImage decoded_colors(std::span<const unsigned char> bytes, std::uint64_t) {
    require_readable(bytes);
    return {1, 2, {1, 2, 3, bytes[0], 4, 5, 6, 7}};
}

/// Arrays of as many numbers per triangle as Surfaces expects, or none; textures that are there.
void check_colors(const gnomon::scene::Scene& scene) {
    const gnomon::scene::SurfaceDetailView view(scene);
    const gnomon::SurfaceDetail& detail = view.get();
    const auto has = [&](std::size_t size, std::size_t each) {
        return size == 0 || size == each * scene.triangle_count();
    };
    require(has(detail.texture_coordinates.size(), 6), "six coordinates for each triangle");
    require(has(detail.corner_colors.size(), 9), "nine colours for each triangle");
    require(has(detail.corner_normals.size(), 3), "three normals for each triangle");
    require(detail.texture_uses.empty() || detail.texture_uses.size() == scene.materials.base_color.size(),
            "a use of textures for each material");
    for (const gnomon::ColorTextureUse& use : detail.texture_uses)
        require(use.texture == gnomon::no_texture || use.texture < detail.textures.size(), "textures that exist");
}

void check(const gnomon::scene::Scene& scene) {
    check_colors(scene);
    require(scene.triangles.size() % 9 == 0, "nine floats for each triangle");
    const auto& [ids, colors] = scene.materials;
    require(ids.size() == scene.triangle_count(), "a material for each triangle");
    require(std::all_of(ids.begin(), ids.end(), [&, n = colors.size()](std::uint32_t id) { return id < n; }),
            "materials that exist");
    require(std::all_of(colors.begin(), colors.end(), is_finite), "finite colours");
    for (const gnomon::scene::NamedCamera& named : scene.cameras) check_camera(named.camera);
    check_camera(gnomon::scene::framing_camera(scene));
    for (const gnomon::scene::NamedLight& named : scene.lights) {
        const auto& [x, y, z, w] = named.light.xyzw;
        require(is_finite({x, y, z}) && (w == 1 || (w == 0 && (x != 0 || y != 0 || z != 0))), "lights that are lights");
    }
    for (const std::string& warning : scene.warnings) require(is_one_line(warning), "warnings of one line");
}

}  // namespace

// A scene is refused when it needs more memory than the machine has. Here that is little, so that no input takes long.
extern "C" long __real_sysconf(int name);
extern "C" long __wrap_sysconf(int name);
extern "C" long __wrap_sysconf(int name) {
    return name == _SC_PHYS_PAGES ? (16 << 20) / __real_sysconf(_SC_PAGESIZE) : __real_sysconf(name);
}

extern "C" int LLVMFuzzerTestOneInput(const std::uint8_t* data, std::size_t size);
extern "C" int LLVMFuzzerTestOneInput(const std::uint8_t* data, std::size_t size) {
    static const Folder folder;
    const std::filesystem::path file = folder.write("scene.glb", data, size);
    try {
        gnomon::scene::SceneFile scenes(file, {.decode_alpha = decoded_alpha, .decode_colors = decoded_colors});
        const gnomon::scene::Scene at_rest = scenes.at(std::nullopt);
        check(at_rest);
        if (!at_rest.animations.empty()) check(scenes.at(0.5));
    } catch (const gnomon::scene::SceneError& error) {
        const std::string sentence = error.what();
        require(sentence.rfind(file.string() + ": ", 0) == 0, "an error that names the file");
        require(is_one_line(sentence), "an error of one line");
    }
    return 0;
}
