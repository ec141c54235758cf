// SPDX-License-Identifier: MIT
#include "device_cases.hpp"

#include <cmath>
#include <random>

namespace gnomon::app {
namespace {

/// Whole numbers whose bits the C++ standard fixes.
class Numbers {
public:
    explicit Numbers(std::uint32_t seed) : engine_(seed) {}
    float below(std::uint32_t limit) { return static_cast<float>(engine_() % limit); }
    /// From -1 to 1, with 24 bits.
    float unit() { return std::ldexp(below(1u << 24) - float(1 << 23), -23); }
    float power_of_two(int least, std::uint32_t count) {
        return std::ldexp(1.0f, least + static_cast<int>(below(count)));
    }

private:
    std::mt19937 engine_;
};

constexpr float denormal = 0x1p-149f;

/// `coordinate(numbers, c)` makes coordinate c of a vertex or of a point.
template <typename Coordinate>
HardCase made(const char* name, std::uint32_t seed, std::uint64_t answers, std::vector<Light> lights,
              Coordinate coordinate) {
    HardCase made{name, {}, {}, std::move(lights), answers};
    Numbers numbers(seed);
    for (int i = 0; i < 150 * 9; ++i) made.triangles.push_back(coordinate(numbers, i % 3));
    for (int i = 0; i < 2000 * 3; ++i) made.points.push_back(coordinate(numbers, i % 3));
    return made;
}

}  // namespace

std::vector<HardCase> hard_cases() {
    const Light oblique = Light::directional({-1, -2, 3}), axis = Light::directional({0, -1, 0}),
                diagonal = Light::directional({-1, -1, -1});
    return {
        made("exact ties", 1, 0x6a3784794a851028, {axis, diagonal, oblique, Light::point({3, 3, 3})},
             [](Numbers& n, int) { return n.below(7); }),
        made("exact ties far from the origin", 2, 0x931b4afd48a8e028,
             {axis, diagonal, Light::point({8388611, 8388611, 8388611})},
             [](Numbers& n, int) { return 8388608 + n.below(7); }),
        made("denormal heights", 3, 0x575195ff0cb62728, {axis, oblique, Light::directional({-1, -denormal, -1})},
             [](Numbers& n, int c) { return c == 1 ? denormal * n.below(40) : n.unit(); }),
        made("denormal widths", 4, 0xc5a6d22ee2485918, {axis, diagonal, Light::point({0, 0, 0})},
             [](Numbers& n, int c) { return c == 1 ? n.unit() : denormal * n.below(40); }),
        made("nothing but denormals", 5, 0x3c2ebd2d2ad58d38,
             {axis, oblique, Light::point({denormal, denormal, 2 * denormal})},
             [](Numbers& n, int) { return denormal * n.below(40); }),
        made("giants and specks", 6, 0xd286b9de35a0f805, {axis, oblique, Light::point({0, 0, 0})},
             [](Numbers& n, int) { return n.unit() * n.power_of_two(-30, 60); }),
        made("nearly in one plane", 7, 0x07e8a9afa3db06c5, {axis, oblique, Light::directional({-1, -0x1p-20f, 0})},
             [](Numbers& n, int c) { return c == 1 ? 1 + n.below(4) * 0x1p-23f : n.unit(); }),
    };
}

std::vector<KnownView> known_views(const Light& sun) {
    return {{"sundial under its sun", sun, 0xae56b7bbbf29ee88},
            {"sundial under a point light", Light::point({-1, 1.6f, 0.8f}), 0x06c1151e0f182ca8}};
}

std::uint64_t hash_of(std::span<const std::byte> bytes, std::uint64_t hash) {
    for (const std::byte byte : bytes) hash = (hash ^ static_cast<std::uint64_t>(byte)) * 0x100000001b3u;
    return hash;
}

}  // namespace gnomon::app
