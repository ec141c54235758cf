// SPDX-License-Identifier: MIT
// Shapes with shared vertices; see shapes.hpp for what each promises.
#include "shapes.hpp"

#include <algorithm>
#include <array>
#include <map>
#include <utility>

namespace gnomon::make_scenes {

void triangle(Part& part, const Vec3& a, const Vec3& b, const Vec3& c) {
    const std::uint32_t first = part.vertex(a);
    part.vertex(b);
    part.vertex(c);
    part.triangle(first, first + 1, first + 2);
}

void quad(Part& part, const Vec3& a, const Vec3& b, const Vec3& c, const Vec3& d) {
    const std::uint32_t first = part.vertex(a);
    part.vertex(b);
    part.vertex(c);
    part.vertex(d);
    part.quad(first, first + 1, first + 2, first + 3);
}

void floor_quad(Part& part, double low_x, double low_z, double high_x, double high_z, double y) {
    quad(part, {low_x, y, low_z}, {low_x, y, high_z}, {high_x, y, high_z}, {high_x, y, low_z});
}

void grid(Part& part, const Vec3& origin, const Vec3& u, const Vec3& v, int u_count, int v_count) {
    const auto first = static_cast<std::uint32_t>(part.positions.size() / 3);
    for (int j = 0; j <= v_count; ++j) {
        for (int i = 0; i <= u_count; ++i) {
            part.vertex(origin + u * (static_cast<double>(i) / u_count) + v * (static_cast<double>(j) / v_count));
        }
    }
    const auto row = static_cast<std::uint32_t>(u_count + 1);
    for (int j = 0; j < v_count; ++j) {
        for (int i = 0; i < u_count; ++i) {
            const std::uint32_t corner = first + static_cast<std::uint32_t>(j) * row + static_cast<std::uint32_t>(i);
            part.quad(corner, corner + 1, corner + row + 1, corner + row);
        }
    }
}

namespace {

/// Corner i of a box lies at -+u (bit 0), -+v (bit 1), -+w (bit 2).
void box_faces(Part& part, std::uint32_t first, bool has_bottom) {
    static constexpr std::array<std::array<std::uint32_t, 4>, 6> faces{
        {{0, 1, 5, 4}, {2, 6, 7, 3}, {0, 4, 6, 2}, {1, 3, 7, 5}, {0, 2, 3, 1}, {4, 5, 7, 6}}};
    for (std::size_t i = has_bottom ? 0 : 1; i < faces.size(); ++i) {
        const auto& face = faces[i];
        part.quad(first + face[0], first + face[1], first + face[2], first + face[3]);
    }
}

std::uint32_t box_corners(Part& part, const Vec3& low, const Vec3& high) {
    const auto first = static_cast<std::uint32_t>(part.positions.size() / 3);
    for (unsigned i = 0; i < 8; ++i) {
        part.vertex({i & 1 ? high.x : low.x, i & 2 ? high.y : low.y, i & 4 ? high.z : low.z});
    }
    return first;
}

}  // namespace

void box(Part& part, const Vec3& low, const Vec3& high) { box_faces(part, box_corners(part, low, high), true); }

void lid(Part& part, const Vec3& low, const Vec3& high) { box_faces(part, box_corners(part, low, high), false); }

void oriented_box(Part& part, const Vec3& center, const Vec3& u, const Vec3& v, const Vec3& w) {
    const auto first = static_cast<std::uint32_t>(part.positions.size() / 3);
    for (unsigned i = 0; i < 8; ++i) {
        part.vertex(center + u * (i & 1 ? 1 : -1) + v * (i & 2 ? 1 : -1) + w * (i & 4 ? 1 : -1));
    }
    box_faces(part, first, true);
}

void bar(Part& part, const Vec3& from, const Vec3& to, double width) {
    const Vec3 along = (to - from) * 0.5;
    const Vec3 side = perpendicular(normalized(along));
    const Vec3 other = cross(normalized(along), side);
    oriented_box(part, from + along, along, side * (width / 2), other * (width / 2));
}

std::uint32_t ring(Part& part, const Vec3& center, const Vec3& radius_u, const Vec3& radius_v, int sides) {
    const auto first = static_cast<std::uint32_t>(part.positions.size() / 3);
    for (int i = 0; i < sides; ++i) {
        const CosineSine angle = cosine_sine(static_cast<double>(i) / sides);
        part.vertex(center + radius_u * angle.cosine + radius_v * angle.sine);
    }
    return first;
}

void join_rings(Part& part, std::uint32_t first, std::uint32_t second, int sides) {
    const auto count = static_cast<std::uint32_t>(sides);
    for (std::uint32_t i = 0; i < count; ++i) {
        const std::uint32_t next = i + 1 == count ? 0 : i + 1;
        part.quad(first + i, first + next, second + next, second + i);
    }
}

void cap_ring(Part& part, std::uint32_t first, const Vec3& apex, int sides, bool is_bottom) {
    const std::uint32_t center = part.vertex(apex);
    const auto count = static_cast<std::uint32_t>(sides);
    for (std::uint32_t i = 0; i < count; ++i) {
        const std::uint32_t next = i + 1 == count ? 0 : i + 1;
        if (is_bottom) {
            part.triangle(center, first + next, first + i);
        } else {
            part.triangle(center, first + i, first + next);
        }
    }
}

void revolve(Part& part, const Vec3& origin, std::span<const ProfilePoint> profile, int sides) {
    revolve(part, origin, {0, 1, 0}, profile, sides);
}

void revolve(Part& part, const Vec3& origin, const Vec3& axis, std::span<const ProfilePoint> profile, int sides) {
    const Vec3 u = perpendicular(axis);
    const Vec3 v = cross(axis, u);
    std::uint32_t last = 0;
    for (std::size_t i = 0; i < profile.size(); ++i) {
        const Vec3 center = origin + axis * profile[i].height;
        const std::uint32_t current = ring(part, center, u * profile[i].radius, v * profile[i].radius, sides);
        if (i == 0) {
            cap_ring(part, current, center, sides, true);
        } else {
            join_rings(part, last, current, sides);
        }
        last = current;
    }
    cap_ring(part, last, origin + axis * profile.back().height, sides, false);
}

void tube(Part& part, std::span<const Vec3> path, std::span<const double> radius, int sides) {
    Vec3 side = perpendicular(normalized(path[1] - path[0]));
    std::uint32_t last = 0;
    for (std::size_t i = 0; i < path.size(); ++i) {
        const Vec3 before = i == 0 ? path[0] : path[i - 1];
        const Vec3 after = i + 1 == path.size() ? path[i] : path[i + 1];
        const Vec3 along = normalized(after - before);
        side = normalized(side - along * dot(side, along));
        const Vec3 other = cross(along, side);
        const std::uint32_t current = ring(part, path[i], side * radius[i], other * radius[i], sides);
        if (i == 0) {
            cap_ring(part, current, path[i], sides, true);
        } else {
            join_rings(part, last, current, sides);
        }
        last = current;
    }
    cap_ring(part, last, path.back(), sides, false);
}

void icosphere(Part& part, const Vec3& center, double radius, int levels) {
    const double golden = (1 + std::sqrt(5.0)) / 2;
    std::vector<Vec3> points;
    for (const double s : {-1.0, 1.0}) {
        for (const double t : {-golden, golden}) {
            points.insert(points.end(), {Vec3{0, s, t}, Vec3{s, t, 0}, Vec3{t, 0, s}});
        }
    }
    // The 20 faces are the triples at mutual distance 2; those pointing inwards are turned round.
    std::vector<std::array<std::uint32_t, 3>> faces;
    const auto is_edge = [&](std::uint32_t a, std::uint32_t b) { return length(points[a] - points[b]) < 2.1; };
    for (std::uint32_t a = 0; a < 12; ++a) {
        for (std::uint32_t b = a + 1; b < 12; ++b) {
            for (std::uint32_t c = b + 1; c < 12; ++c) {
                if (!is_edge(a, b) || !is_edge(b, c) || !is_edge(a, c)) continue;
                const bool is_outward = dot(cross(points[b] - points[a], points[c] - points[a]), points[a]) > 0;
                faces.push_back(is_outward ? std::array{a, b, c} : std::array{a, c, b});
            }
        }
    }
    for (int level = 0; level < levels; ++level) {
        std::map<std::pair<std::uint32_t, std::uint32_t>, std::uint32_t> middles;
        const auto middle = [&](std::uint32_t a, std::uint32_t b) {
            const auto [entry, is_new] =
                middles.try_emplace(std::minmax(a, b), static_cast<std::uint32_t>(points.size()));
            if (is_new) points.push_back((normalized(points[a]) + normalized(points[b])) * 0.5);
            return entry->second;
        };
        std::vector<std::array<std::uint32_t, 3>> finer;
        for (const auto& [a, b, c] : faces) {
            const std::uint32_t ab = middle(a, b);
            const std::uint32_t bc = middle(b, c);
            const std::uint32_t ca = middle(c, a);
            for (const auto& face :
                 {std::array{a, ab, ca}, std::array{b, bc, ab}, std::array{c, ca, bc}, std::array{ab, bc, ca}}) {
                finer.push_back(face);
            }
        }
        faces = std::move(finer);
    }
    const auto first = static_cast<std::uint32_t>(part.positions.size() / 3);
    for (const Vec3& point : points) part.vertex(center + normalized(point) * radius);
    for (const auto& [a, b, c] : faces) part.triangle(first + a, first + b, first + c);
}

}  // namespace gnomon::make_scenes
