// SPDX-License-Identifier: MIT
// A scene in the making, and its way into a glTF 2.0 binary file.
#pragma once

#include <array>
#include <cstdint>
#include <deque>
#include <filesystem>
#include <optional>
#include <stdexcept>
#include <string>
#include <vector>

#include "arithmetic.hpp"

namespace gnomon::make_scenes {

/// Anything a person can put right; what() is one sentence.
class MakeError : public std::runtime_error {
public:
    using std::runtime_error::runtime_error;
};

/// alphaMode MASK. Without texels the alpha of the vertices decides alone.
struct Mask {
    enum Filter { nearest = 9728, linear = 9729 };
    enum Wrap { repeat = 10497, clamp = 33071, mirror = 33648 };
    double cutoff = 0.5;
    std::uint32_t width = 0, height = 0;
    std::vector<std::uint8_t> rgba{};  ///< 4 per texel
    Filter filter = linear;
    Wrap wrap = repeat;
};

/// The triangles of one material: float32 positions, 32-bit indices.
struct Part {
    std::string material;
    std::array<double, 3> base_color{};  ///< linear
    std::vector<float> positions;        ///< 3 per vertex
    std::vector<std::uint32_t> indices;  ///< 3 per triangle
    std::vector<float> coordinates{};    ///< of the texture: 2 per vertex, or none
    std::vector<float> alphas{};         ///< 1 per vertex, or none
    std::optional<Mask> mask{};

    std::uint32_t vertex(const Vec3& position);
    void triangle(std::uint32_t a, std::uint32_t b, std::uint32_t c);
    /// The triangles abc and acd: they share the edge ac.
    void quad(std::uint32_t a, std::uint32_t b, std::uint32_t c, std::uint32_t d);
    std::uint64_t triangle_count() const { return indices.size() / 3; }
};

/// A perspective camera; up is +Y, or -Z where it looks straight up or down.
struct CameraNode {
    std::string name;
    Vec3 eye, target;
    double fov_y_degrees = 50;
};

/// A KHR_lights_punctual light.
struct LightNode {
    std::string name;
    std::string type;  ///< "directional", "point" or "spot"
    Vec3 position;     ///< not for directional
    Vec3 direction;    ///< the way it travels, of any length; not for point
};

struct Scene {
    std::string name;
    std::deque<Part> parts;  ///< a deque: adding a part leaves references to the others valid
    std::vector<CameraNode> cameras;
    std::vector<LightNode> lights;

    Part& part(std::string material, const std::array<double, 3>& base_color);
    void camera(std::string camera_name, const Vec3& eye, const Vec3& target, double fov_y_degrees = 50);
    void directional(std::string light_name, const Vec3& direction);
    void point(std::string light_name, const Vec3& position);
    void spot(std::string light_name, const Vec3& position, const Vec3& direction);
    std::uint64_t triangle_count() const;
};

/// Writes the scene; parts without triangles are left out. Throws MakeError if the file cannot be written.
void write_glb(const Scene& scene, const std::filesystem::path& file);

}  // namespace gnomon::make_scenes
