// SPDX-License-Identifier: MIT
// Prints what the reference answers on fixed scenes, as one hash and a few counts per scene. Built at two optimisation
// levels; the outputs must be the same to the byte (reference.cmake). Positions are printed too, because roundings, not
// decisions, are what optimisation has been seen to change.
#include <bit>
#include <cstdio>

#include "scenes_for_tests.hpp"
#include "view.hpp"

namespace {

using namespace reference;

/// FNV-1a over 32-bit words.
class Hash {
public:
    void add(std::uint32_t word) { value_ = (value_ ^ word) * 0x100000001B3u; }
    void add(float x) { add(std::bit_cast<std::uint32_t>(x)); }
    unsigned long long value() const { return value_; }

private:
    std::uint64_t value_ = 0xCBF29CE484222325u;
};

void print_points(const TestScene& scene) {
    for (const auto& light : scene.lights) {
        VisibilityCounts counts;
        const auto result = shadowed(scene.triangles, scene.points, scene.receivers, light, scene.eye, &counts);
        Hash hash;
        for (const std::uint8_t bit : result) hash.add(std::uint32_t{bit});
        std::printf("%s: %016llx, %llu in shadow, %llu lit, %llu decided exactly\n", scene.name.c_str(), hash.value(),
                    static_cast<unsigned long long>(counts.shadowed), static_cast<unsigned long long>(counts.lit),
                    static_cast<unsigned long long>(counts.decided_exactly));
    }
}

void print_view(const TestScene& scene) {
    const PinholeCamera camera{scene.eye, scene.target, {0, 1, 0}, 60, 48, 32};
    const View view = make_view(scene.triangles, camera, scene.lights.front());
    Hash hash;
    for (const float x : view.position) hash.add(x);
    for (const float x : view.normal) hash.add(x);
    for (const float x : view.visibility) hash.add(x);
    for (const std::uint32_t id : view.receiver) hash.add(id);
    const ViewReport report = judge_view(scene.triangles, camera, scene.lights.front(), view.claim());
    std::printf("%s, view: %016llx, at most %.6Lf ulp, %llu wrong\n", scene.name.c_str(), hash.value(),
                report.largest_distance_ulp, static_cast<unsigned long long>(report.wrong()));
}

}  // namespace

int main() {
    for (const TestScene& scene : all_test_scenes()) {
        print_points(scene);
        if (scene.has_view) print_view(scene);
    }
}
