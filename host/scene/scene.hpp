// SPDX-License-Identifier: MIT
// A scene as the command uses it: world triangles, colours, cameras and lights, from a glTF 2.0 file or built in. Not
// part of the core library: only this folder uses tinygltf.
#pragma once

#include <algorithm>
#include <cmath>
#include <filesystem>

#include <gnomon.hpp>

namespace gnomon::scene {

/// A file that cannot be used. what() is one sentence that names the file, the wrong part of it and the remedy.
class SceneError : public Error {
public:
    using Error::Error;
};

struct NamedCamera {
    std::string name;  ///< node name, else camera name, else "camera N"
    Camera camera;     ///< transformed in double; the eye is rounded once
};

/// KHR_lights_punctual. A spot is positional for visibility: its cone and range are shading.
struct NamedLight {
    std::string name;  ///< node name, else light name, else "light N"
    std::string type;  ///< "directional", "point" or "spot"
    Light light;       ///< transformed in double, rounded once
};

struct Scene {
    /// 9 per triangle: world space. Node transforms and instances are applied in double and rounded once; under an
    /// identity transform the floats have the file's own bits.
    std::vector<float> triangles;
    Materials materials;  ///< base colour factors, linear; textures are not read
    std::vector<NamedCamera> cameras;
    std::vector<NamedLight> lights;
    std::vector<std::string> warnings;  ///< each one sentence; --strict turns them into errors

    std::size_t triangle_count() const { return triangles.size() / 9; }
    /// A triangle with a NaN or infinite vertex casts no shadow.
    bool is_finite(std::size_t triangle) const {
        const auto first = triangles.begin() + std::ptrdiff_t(9 * triangle);
        return std::all_of(first, first + 9, [](float c) { return std::isfinite(c); });
    }
};

/// Loads a .glb or .gltf file. Throws SceneError, also if its triangles need more memory than `memory_bytes` (0: the
/// machine's memory).
Scene load(const std::filesystem::path& file, std::uint64_t memory_bytes = 0);

/// The built-in sundial, with a camera and a light.
Scene sundial();

/// A camera that frames all finite triangles from a three-quarter view (fov_y 50 degrees); for scenes without one.
Camera framing_camera(const Scene& scene);

/// The light of a scene without lights, if no option gives one: directional, travelling along (-0.4, -1, -0.3).
Light default_light();

}  // namespace gnomon::scene
