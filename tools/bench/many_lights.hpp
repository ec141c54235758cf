// SPDX-License-Identifier: MIT
// Many lights: points of a scene times a table of lights, by gnomon and by its rival, by turns.
//
// Points: N area-uniform on the faces (seed 1), on the outward side by the winding, 2e-6 of the largest coordinate off
// their face; of a terrain N of its vertices, with the mean normal of the triangles around them; or those of a
// picture's pixels. Decisions are the pairs whose light is in front of the point's normal. Timed runs write the number
// of lights that reach each point; one run before them, which is not timed, writes all bits, and these are compared.
// Outside of all times: gnomon's clusters, the rival's tree, and the rival's order of points and lights. gnomon's times
// contain its own tree and order. A terrain is asked about twice, as triangles and as an implicit raster.
#pragma once

#include <memory>
#include <optional>
#include <string>
#include <vector>

#include "contestant.hpp"

namespace gnomon::bench {

struct ManyLights {
    /// "suns" (latitude 52, hourly, elevation above 0), "suns:N" (N of them, evenly spread), "sky" (145 patches),
    /// "sky:D" (Reinhart's division D), "disk:N" (N lights on the sun's disk), "lamp:N" (N samples of a lamp in
    /// the middle of the scene), "lamps:N" (N point lights before faces).
    std::string lights = "suns";
    std::uint64_t points = 1'000'000;
    /// If not 1, only the points in one of so many cells of a grid of 24 x 24 cells over x and z, chosen by a hash: as
    /// dense as all of them, in a fraction of the time.
    std::uint32_t columns = 1;
    bool every_way = false;  ///< many_lights_configurations() in place of the block's
    /// If named, the points are those of this view's pixels, on the eye's side.
    std::string view;
    Size size;
};

bool is_terrain_scene(const NamedScene& scene);

struct LightsQuestion {
    LightsQuestion(const Place& place, const ManyLights& asked);

    const NamedScene& scene;
    std::optional<View> picture;            ///< whose pixels the points are
    std::vector<float> positions, normals;  ///< 3 per point; a pixel that shows the sky has no normal, 0
    std::vector<std::uint32_t> receivers;   ///< none where the points are vertices
    Lights lights;
    /// The lights in an order in which neighbours are close: suns of one hour, day after day.
    std::vector<std::uint32_t> light_order;
    Row row;  ///< what all rows share

    std::size_t count() const { return positions.size() / 3; }
    std::size_t words() const { return (lights.count() + 31) / 32; }
    bool are_vertices() const { return receivers.empty(); }
    /// A pixel without a point: all lights reach it by gnomon's definition, and a ray tracer has nothing to trace.
    bool shows_sky(std::size_t point) const {
        const float* n = &normals[3 * point];
        return n[0] == 0 && n[1] == 0 && n[2] == 0;
    }
};

/// From a point towards a light, of a point light as far as it is.
inline Float3 towards(const float* point, const std::array<float, 4>& light) {
    const auto along = [&](std::size_t c) { return light[3] != 0 ? light[c] - point[c] : light[c]; };
    return {along(0), along(1), along(2)};
}
/// Whether the light is in front of the point's normal, in double arithmetic.
inline bool is_facing(const float* normal, const float* point, const std::array<float, 4>& light) {
    const Float3 d = towards(point, light);
    return double(normal[0]) * d[0] + double(normal[1]) * d[1] + double(normal[2]) * d[2] > 0;
}

class LightsContestant {
public:
    virtual ~LightsContestant() = default;
    /// All bits, as LightsOutputs::bits. Called once, before all runs.
    virtual std::vector<std::uint32_t> bits() = 0;
    /// Writes the number of lights of each point.
    virtual RunTimes run() = 0;
    virtual std::vector<std::uint32_t> counts() const = 0;  ///< of the last run
    virtual void describe(Row& row) const = 0;
};

std::unique_ptr<LightsContestant> make_own_contestant(const LightsQuestion& question, const Place& place,
                                                      const Configuration& configuration);
/// The same for a terrain's raster: Triangles::raster() in place of its triangles.
std::unique_ptr<LightsContestant> make_raster_contestant(const LightsQuestion& question, const Place& place,
                                                         const Configuration& configuration);
/// Embree's best of medium and high quality times 16 points x 1 light, 1 point x 16 lights and streams, as measured on
/// a sample of the points. None without Embree.
std::vector<std::unique_ptr<LightsContestant>> make_light_peers(const LightsQuestion& question, unsigned threads);

/// A row for each, in their order. A contestant that fails says so in its row.
std::vector<Row> run_contestants(const LightsQuestion& question,
                                 std::span<const std::unique_ptr<LightsContestant>> contestants, const RunRule& rule);

}  // namespace gnomon::bench
