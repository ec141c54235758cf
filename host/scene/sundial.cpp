// SPDX-License-Identifier: MIT
// The built-in scene: a horizontal sundial for latitude 50 degrees north on a fluted pedestal, in a round paved court.
// +X east, +Y up, -Z north, metres. The sun stands where it would at half past three in May, so the style's shadow
// falls between the third and the fourth afternoon hour line: tan(line) = sin(latitude) tan(hour angle). Every solid is
// a loft (rings of points, joined by quads and closed by caps), wound outwards, and closed also after rounding: a
// shared point is rounded from the same double. Solids stand a little in one another instead of touching, so no two
// faces are coplanar.
#include <algorithm>
#include <cmath>
#include <cstdint>
#include <map>
#include <numeric>

#include "affine.hpp"
#include "scene.hpp"

namespace gnomon::scene {
namespace {

constexpr double pi = 3.14159265358979323846;
constexpr double degree = pi / 180;
constexpr double latitude = 50 * degree;
constexpr double declination = 19 * degree;
constexpr double hour_angle = 52.5 * degree;  // half past three

// ---- Building solids ------------------------------------------------------------------------------------------------

struct Material {
    std::uint32_t index;  ///< in the scene's materials
    Float3 color;
};
constexpr Material grass{0, {0.17f, 0.27f, 0.09f}};
constexpr Material gravel{1, {0.30f, 0.26f, 0.21f}};
constexpr Material paving_warm{2, {0.60f, 0.49f, 0.38f}};
constexpr Material paving_pale{3, {0.66f, 0.60f, 0.51f}};
constexpr Material paving_grey{4, {0.50f, 0.48f, 0.45f}};
constexpr Material limestone{5, {0.74f, 0.69f, 0.58f}};
constexpr Material marble{6, {0.86f, 0.84f, 0.79f}};
constexpr Material bronze{7, {0.36f, 0.20f, 0.08f}};
constexpr Material verdigris{8, {0.16f, 0.42f, 0.36f}};
constexpr Material sandstone{9, {0.62f, 0.38f, 0.24f}};
constexpr Material gold{10, {0.83f, 0.58f, 0.16f}};

using Ring = std::vector<glm::dvec3>;

class Mason {
public:
    explicit Mason(Scene& scene) : scene_(scene) {}

    /// Joins each ring to the next; the first and the last are closed by fans around `first_center`, `last_center`.
    void loft(Material material, const std::vector<Ring>& rings, const glm::dvec3& first_center,
              const glm::dvec3& last_center) {
        join(rings);
        cap(rings.front(), first_center, true);
        cap(rings.back(), last_center, false);
        finish(material);
    }

    /// A loft that is closed by flat caps.
    void prism(Material material, const std::vector<Ring>& rings) {
        loft(material, rings, centroid(rings.front()), centroid(rings.back()));
    }

    /// Joins each ring to the next, and the last to the first.
    void hoop(Material material, std::vector<Ring> rings) {
        rings.push_back(rings.front());
        join(rings);
        finish(material);
    }

private:
    using Corners = std::array<glm::dvec3, 3>;

    static glm::dvec3 centroid(const Ring& ring) {
        return std::accumulate(ring.begin(), ring.end(), glm::dvec3(0)) / double(ring.size());
    }

    void join(const std::vector<Ring>& rings) {
        for (std::size_t r = 0; r + 1 < rings.size(); ++r)
            for (std::size_t i = 0; i < rings[r].size(); ++i) {
                const std::size_t next = (i + 1) % rings[r].size();
                solid_.push_back({rings[r][i], rings[r][next], rings[r + 1][next]});
                solid_.push_back({rings[r][i], rings[r + 1][next], rings[r + 1][i]});
            }
    }

    void cap(const Ring& ring, const glm::dvec3& center, bool is_first) {
        for (std::size_t i = 0; i < ring.size(); ++i) {
            const glm::dvec3 &a = ring[i], &b = ring[(i + 1) % ring.size()];
            solid_.push_back(is_first ? Corners{center, b, a} : Corners{center, a, b});
        }
    }

    /// Winds the solid outwards (positive volume) and appends it.
    void finish(Material material) {
        double volume = 0;
        const glm::dvec3& o = solid_.front()[0];
        for (const Corners& t : solid_) volume += determinant(t[0] - o, t[1] - o, t[2] - o);
        for (Corners& t : solid_) {
            if (volume < 0) std::swap(t[1], t[2]);
            for (const glm::dvec3& p : t) {
                const Float3 corner = array_of(p);
                scene_.triangles.insert(scene_.triangles.end(), corner.begin(), corner.end());
            }
            scene_.materials.triangle_material.push_back(material.index);
        }
        add_normals();
        solid_.clear();
    }

    /// At each corner the mean of the faces that meet there, as large as they are, and bend by less than 30 degrees.
    /// None where a triangle's neighbours lie in its plane.
    void add_normals() {
        std::map<std::array<double, 3>, std::vector<glm::dvec3>> faces;
        std::vector<glm::dvec3> normals;
        for (const Corners& t : solid_) {
            normals.push_back(cross(t[1] - t[0], t[2] - t[0]));
            for (const glm::dvec3& p : t) faces[array_of<double>(p)].push_back(normals.back());
        }
        const auto cosine = [](const glm::dvec3& a, const glm::dvec3& b) {
            return dot(a, b) / std::sqrt(dot(a, a) * dot(b, b));
        };
        for (std::size_t i = 0; i < solid_.size(); ++i) {
            std::array<std::uint32_t, 3> corners{};
            bool is_flat = true;
            for (std::size_t c = 0; c < 3; ++c) {
                glm::dvec3 sum{};
                for (const glm::dvec3& n : faces[array_of<double>(solid_[i][c])])
                    if (cosine(n, normals[i]) > std::cos(30 * degree)) sum += n;
                corners[c] = pack_normal(array_of(sum));
                is_flat = is_flat && cosine(sum, normals[i]) > 1 - 1e-9;
            }
            if (is_flat) corners = {};
            scene_.colors.corner_normals.insert(scene_.colors.corner_normals.end(), corners.begin(), corners.end());
        }
    }

    Scene& scene_;
    std::vector<Corners> solid_;
};

/// A vertical axis through (x, z), and the number of points around it.
struct Axis {
    double x = 0, z = 0;
    int sides = 48;
};

double no_swell(double) { return 0; }

/// `swell` is added to the radius at an angle (flutes).
Ring circle(const Axis& axis, double radius, double y, double (*swell)(double) = no_swell) {
    Ring ring;
    for (int i = 0; i < axis.sides; ++i) {
        const double angle = 2 * pi * i / axis.sides;
        const double r = radius + swell(angle);
        ring.push_back({axis.x + r * std::sin(angle), y, axis.z + r * std::cos(angle)});
    }
    return ring;
}

/// A solid of revolution from a profile of (radius, y), bottom to top.
void turn(Mason& mason, Material material, const Axis& axis, const std::vector<std::array<double, 2>>& profile) {
    std::vector<Ring> rings;
    for (const auto& [radius, y] : profile) rings.push_back(circle(axis, radius, y));
    mason.prism(material, rings);
}

void sphere(Mason& mason, Material material, const Axis& axis, double y, double radius) {
    const int bands = axis.sides / 2;
    std::vector<Ring> rings;
    for (int i = 1; i < bands; ++i) {
        const double angle = pi * i / bands;
        rings.push_back(circle(axis, radius * std::sin(angle), y - radius * std::cos(angle)));
    }
    mason.loft(material, rings, {axis.x, y - radius, axis.z}, {axis.x, y + radius, axis.z});
}

/// A level quadrilateral block with bevelled upper edges, from its four corners seen from above.
void slab(Mason& mason, Material material, const std::array<std::array<double, 2>, 4>& corners, double bottom,
          double top, double bevel) {
    double center_x = 0, center_z = 0;
    for (const auto& [x, z] : corners) {
        center_x += x / 4;
        center_z += z / 4;
    }
    const auto ring = [&](double y, double inset) {
        Ring out;
        for (const auto& [x, z] : corners) {
            const double dx = center_x - x, dz = center_z - z, length = std::hypot(dx, dz);
            out.push_back({x + dx / length * inset, y, z + dz / length * inset});
        }
        return out;
    };
    mason.prism(material, {ring(bottom, 0), ring(top - bevel, 0), ring(top, bevel * std::sqrt(2.0))});
}

/// A block of a ring around the origin: between two radii and two angles (0: south, 90 degrees: east).
void ring_block(Mason& mason, Material material, double inner, double outer, double from, double to, double bottom,
                double top, double bevel) {
    const auto at = [](double radius, double angle) {
        return std::array<double, 2>{radius * std::sin(angle), radius * std::cos(angle)};
    };
    slab(mason, material, {at(inner, from), at(outer, from), at(outer, to), at(inner, to)}, bottom, top, bevel);
}

/// A number in [0, 1) that belongs to an integer: the same stones on every machine.
double scatter(std::uint32_t n) {
    n = (n ^ 61) ^ (n >> 16);
    n *= 9;
    n ^= n >> 4;
    n *= 0x27d4eb2d;
    n ^= n >> 15;
    return double(n & 0xFFFFFF) / double(1 << 24);
}

// ---- The court ------------------------------------------------------------------------------------------------------

void ground(Mason& mason) {
    turn(mason, grass, {0, 0, 64}, {{60.0, -0.5}, {60.0, -0.06}});
    turn(mason, gravel, {0, 0, 96}, {{6.35, -0.4}, {6.35, -0.035}, {6.30, -0.02}});
}

/// Rings of flagstones with open joints, each a little higher or lower than the next.
void paving(Mason& mason) {
    constexpr double course = 0.55, joint = 0.012;
    std::uint32_t stone = 0;
    for (int ring = 0; ring < 10; ++ring) {
        const double inner = 0.7 + course * ring, outer = inner + course - joint;
        const int stones = int(std::lround(2 * pi * (inner + course / 2) / 0.62));
        const double offset = scatter(1000u + std::uint32_t(ring));
        for (int i = 0; i < stones; ++i, ++stone) {
            const double step = 2 * pi / stones, gap = joint / 2 / inner;
            const double shade = scatter(stone);
            const Material material = shade < 0.4 ? paving_pale : shade < 0.75 ? paving_warm : paving_grey;
            const double top = 0.006 * scatter(stone + 77777u);
            ring_block(mason, material, inner, outer, (i + offset) * step + gap, (i + 1 + offset) * step - gap, -0.15,
                       top, 0.008);
        }
    }
}

/// A low wall of two courses around the north, with coping stones.
void wall(Mason& mason) {
    constexpr double from = 114 * degree, to = 246 * degree, inner = 5.55, outer = 5.95;
    const auto course = [&](int blocks, double shift, double in, double out, double bottom, double top,
                            std::uint32_t seed) {
        for (int i = 0; i < blocks; ++i) {
            const double step = (to - from) / blocks;
            const double a = from + (i + (i == 0 ? 0 : shift)) * step;
            const double b = from + (i + 1 + (i + 1 == blocks ? 0 : shift)) * step - 0.002;
            const double lean = 0.012 * scatter(seed + std::uint32_t(i));
            ring_block(mason, scatter(seed + 500u + std::uint32_t(i)) < 0.7 ? limestone : sandstone, in + lean,
                       out + lean, a, b, bottom, top, 0.012);
        }
    };
    course(16, 0.0, inner, outer, -0.2, 0.30, 1u);
    course(16, 0.5, inner, outer, 0.285, 0.58, 100u);
    course(12, 0.0, inner - 0.05, outer + 0.05, 0.57, 0.66, 200u);
}

void bollards(Mason& mason) {
    for (int i = 0; i < 14; ++i) {
        const double angle = (-104 + 208.0 * i / 13) * degree;
        const Axis axis{5.2 * std::sin(angle), 5.2 * std::cos(angle), 24};
        turn(mason, limestone, axis,
             {{0.17, -0.1},
              {0.17, 0.07},
              {0.155, 0.085},
              {0.12, 0.10},
              {0.105, 0.42},
              {0.13, 0.44},
              {0.13, 0.47},
              {0.09, 0.50}});
        sphere(mason, marble, axis, 0.57, 0.105);
    }
}

/// A square needle with a gilt sphere.
void obelisk(Mason& mason, double x, double z) {
    const auto square = [&](double half, double y) {
        return Ring{{x - half, y, z - half}, {x + half, y, z - half}, {x + half, y, z + half}, {x - half, y, z + half}};
    };
    mason.prism(limestone, {square(0.50, -0.1), square(0.50, 0.16), square(0.48, 0.18)});
    mason.prism(marble, {square(0.38, 0.17), square(0.38, 0.52), square(0.34, 0.56), square(0.30, 0.58)});
    mason.prism(sandstone, {square(0.24, 0.57), square(0.15, 1.70), square(0.03, 1.86)});
    sphere(mason, gold, {x, z, 32}, 1.95, 0.12);
}

// ---- The dial -------------------------------------------------------------------------------------------------------

constexpr double plate_top = 1.02, plate_radius = 0.78, line_radius = 0.64;
/// The style meets the plate, and all hour lines meet, south of the plate's centre: the lines fan out north.
constexpr double origin_z = 0.24;

void pedestal(Mason& mason) {
    turn(mason, limestone, {0, 0, 64}, {{1.16, -0.1}, {1.16, 0.11}, {1.14, 0.13}});
    turn(mason, limestone, {0, 0, 64}, {{0.88, 0.12}, {0.88, 0.25}, {0.86, 0.27}});
    turn(mason, marble, {0, 0, 64},
         {{0.52, 0.26}, {0.52, 0.32}, {0.49, 0.35}, {0.44, 0.36}, {0.42, 0.39}, {0.40, 0.40}, {0.35, 0.41}});
    // Twenty flutes of twelve points each; the column narrows upwards.
    const auto flute = [](double angle) { return -0.026 * std::fabs(std::sin(10 * angle)); };
    const Axis column{0, 0, 240};
    mason.prism(marble, {circle(column, 0.335, 0.40, flute), circle(column, 0.328, 0.55, flute),
                         circle(column, 0.312, 0.70, flute), circle(column, 0.29, 0.85, flute)});
    turn(mason, marble, {0, 0, 64},
         {{0.27, 0.84}, {0.33, 0.85}, {0.345, 0.865}, {0.33, 0.88}, {0.42, 0.91}, {0.46, 0.935}, {0.46, 0.95}});
}

void plate(Mason& mason) {
    turn(mason, limestone, {0, 0, 128},
         {{0.70, 0.94}, {0.76, 0.955}, {plate_radius, 0.975}, {plate_radius, 1.0}, {0.76, plate_top}});
    // Two thin raised hoops bound the scale.
    const auto hoop = [&](double inner, double outer) {
        std::vector<Ring> rings;
        for (int i = 0; i < 128; ++i) {
            const double s = std::sin(2 * pi * i / 128), c = std::cos(2 * pi * i / 128), rise = plate_top + 0.005;
            rings.push_back({{inner * s, plate_top - 0.01, inner * c},
                             {outer * s, plate_top - 0.01, outer * c},
                             {outer * s, rise, outer * c},
                             {inner * s, rise, inner * c}});
        }
        mason.hoop(bronze, rings);
    };
    hoop(0.645, 0.655);
    hoop(0.725, 0.737);
}

/// A bar of the hour line at `angle` (from north, towards east), from one distance of the lines' origin to another.
void bar(Mason& mason, Material material, double angle, double from, double to, double width) {
    const double along_x = std::sin(angle), along_z = -std::cos(angle), half = width / 2;
    const auto at = [&](double distance, double side) {
        return std::array<double, 2>{along_x * distance - along_z * side,
                                     origin_z + along_z * distance + along_x * side};
    };
    slab(mason, material, {at(from, -half), at(from, half), at(to, half), at(to, -half)}, plate_top - 0.01,
         plate_top + 0.006, 0.0015);
}

/// Distance from the lines' origin to a circle around the plate's centre.
double distance_to_circle(double angle, double radius) {
    const double along_center = origin_z * std::cos(angle);
    return along_center + std::sqrt(along_center * along_center + radius * radius - origin_z * origin_z);
}

void hour_lines(Mason& mason) {
    for (int quarter = -7 * 4; quarter <= 7 * 4; ++quarter) {
        const double hour = quarter / 4.0 * 15 * degree;
        const double angle = std::atan2(std::sin(latitude) * std::sin(hour), std::cos(hour));
        const double start = distance_to_circle(angle, 0.662), end = distance_to_circle(angle, 0.718);
        if (quarter % 4 == 0) {
            bar(mason, bronze, angle, 0.17, distance_to_circle(angle, line_radius), 0.011);
            bar(mason, quarter == 0 ? gold : bronze, angle, start, end, quarter % 12 == 0 ? 0.034 : 0.022);
        } else {
            bar(mason, bronze, angle, start, quarter % 2 == 0 ? (start + end) / 2 + 0.008 : (start + end) / 2 - 0.006,
                0.008);
        }
    }
}

/// A triangular blade in the meridian, thick, its upper edge parallel to the earth's axis.
void blade(Mason& mason) {
    constexpr double half_thickness = 0.013, length = 0.62, sunk = 0.02;
    const double south = origin_z + sunk / std::tan(latitude), north = origin_z - length;
    const double top = plate_top + length * std::tan(latitude);
    const auto outline = [&](double x) {
        return Ring{{x, plate_top - sunk, south},        {x, top, north},
                    {x, top - 0.03, north - 0.02},       {x, plate_top + 0.34, north + 0.10},
                    {x, plate_top + 0.16, north + 0.03}, {x, plate_top - sunk, north - 0.03}};
    };
    // The outline is not convex: its caps are fans around a point from which all of the outline is visible.
    const auto center = [&](double x) { return glm::dvec3(x, plate_top + 0.30, north + 0.26); };
    mason.loft(verdigris, {outline(-half_thickness), outline(half_thickness)}, center(-half_thickness),
               center(half_thickness));
}

/// From the dial to the sun, in the sky's own terms: declination, hour angle (afternoon positive) and latitude.
glm::dvec3 toward_sun() {
    const double west = std::cos(declination) * std::sin(hour_angle);
    const double up =
        std::sin(latitude) * std::sin(declination) + std::cos(latitude) * std::cos(declination) * std::cos(hour_angle);
    const double north =
        std::cos(latitude) * std::sin(declination) - std::sin(latitude) * std::cos(declination) * std::cos(hour_angle);
    return {-west, up, -north};
}

}  // namespace

Scene sundial() {
    Scene scene;
    for (const Material& material :
         {grass, gravel, paving_warm, paving_pale, paving_grey, limestone, marble, bronze, verdigris, sandstone, gold})
        scene.materials.base_color.push_back(material.color);
    Mason mason(scene);
    ground(mason);
    paving(mason);
    wall(mason);
    bollards(mason);
    obelisk(mason, -4.1, -0.55);
    pedestal(mason);
    plate(mason);
    hour_lines(mason);
    blade(mason);
    scene.cameras.push_back({"default", Camera::look_at({2.45f, 2.95f, 1.75f}, {-0.3f, 1.0f, -0.3f}, {0, 1, 0}, 45)});
    const glm::dvec3 sun = toward_sun();
    scene.lights.push_back({"sun", "directional", Light::directional(array_of(-sun))});
    return scene;
}

}  // namespace gnomon::scene
