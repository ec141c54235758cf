// SPDX-License-Identifier: MIT
// The fans of points that are vertices of a mesh: found on the host, by equal coordinates.
#include <algorithm>
#include <bit>
#include <cmath>
#include <unordered_map>

#include "kernels/receivers/backfacing.h"
#include "query/inputs.hpp"

namespace gnomon {
namespace {

/// A position by its bits, where -0 is 0: equal positions have equal keys.
using Key = std::array<std::uint32_t, 3>;

Key key_of(const float* p) {
    Key key;
    for (int c = 0; c < 3; ++c) key[c] = std::bit_cast<std::uint32_t>(p[c] + 0.0f);
    return key;
}

struct HashOfKey {
    std::size_t operator()(const Key& key) const {
        std::uint64_t hash = 0;
        for (const std::uint32_t word : key) {
            hash = (hash ^ word) * 0x9E3779B97F4A7C15u;
            hash ^= hash >> 29;
        }
        return hash;
    }
};

bool is_finite(std::span<const float> values) {
    return std::all_of(values.begin(), values.end(), [](float v) { return std::isfinite(v); });
}

/// The fan of each distinct position: corner ids of `first[i]` to `first[i + 1]`, ascending.
struct FoundFans {
    std::vector<std::uint32_t> fan_of_point;
    std::vector<std::uint32_t> first, corners;
};

FoundFans found_fans(std::span<const float> vertices, std::span<const float> points) {
    FoundFans found;
    std::unordered_map<Key, std::uint32_t, HashOfKey> fan_at;
    fan_at.reserve(points.size() / 3);
    for (std::size_t i = 0; i < points.size(); i += 3)
        found.fan_of_point.push_back(
            fan_at.try_emplace(key_of(&points[i]), static_cast<std::uint32_t>(fan_at.size())).first->second);

    std::vector<std::uint32_t> fan_of_corner(vertices.size() / 3, no_receiver);
    found.first.assign(fan_at.size() + 1, 0);
    for (std::size_t corner = 0; corner < fan_of_corner.size(); ++corner) {
        if (!is_finite(vertices.subspan(corner / 3 * 9, 9))) continue;
        const auto at = fan_at.find(key_of(&vertices[3 * corner]));
        if (at == fan_at.end()) continue;
        fan_of_corner[corner] = at->second;
        ++found.first[at->second + 1];
    }
    for (std::size_t i = 1; i < found.first.size(); ++i) found.first[i] += found.first[i - 1];
    found.corners.resize(found.first.back());
    std::vector<std::uint32_t> next = found.first;
    for (std::size_t corner = 0; corner < fan_of_corner.size(); ++corner)
        if (fan_of_corner[corner] != no_receiver)
            found.corners[next[fan_of_corner[corner]]++] = static_cast<std::uint32_t>(corner);
    return found;
}

/// Each edge at the vertex runs away from it in one of these corners, and towards it in one.
bool is_closed(std::span<const float> vertices, std::span<const std::uint32_t> corners) {
    std::vector<Key> away, towards;
    for (const std::uint32_t corner : corners) {
        const std::uint32_t first = corner / 3 * 3;
        away.push_back(key_of(&vertices[3 * (first + (corner + 1) % 3)]));
        towards.push_back(key_of(&vertices[3 * (first + (corner + 2) % 3)]));
    }
    std::sort(away.begin(), away.end());
    std::sort(towards.begin(), towards.end());
    return away == towards && std::adjacent_find(away.begin(), away.end()) == away.end();
}

std::shared_ptr<void> uploaded_words(const Device& device, const std::vector<std::uint32_t>& words) {
    return uploaded(device, words.data(), words.size() * sizeof(std::uint32_t));
}

}  // namespace

VertexFans VertexFans::find(const Device& device, std::span<const float> vertices, std::span<const float> points) {
    if (vertices.size() % 9 != 0 || points.size() % 3 != 0)
        throw InvalidArgument("fans need 9 floats for each triangle and 3 for each point, and " +
                              std::to_string(vertices.size()) + " and " + std::to_string(points.size()) +
                              " were given");
    if (vertices.size() / 3 >= FAN_IS_CLOSED || points.size() / 3 >= no_receiver)
        throw InvalidArgument("fans are found among fewer than 2^31 corners, for fewer than 2^32 points");
    const FoundFans found = found_fans(vertices, points);
    std::vector<std::uint32_t> fans;
    VertexFans result;
    std::vector<char> closed(found.first.size(), 0);
    for (std::size_t fan = 0; fan + 1 < found.first.size(); ++fan)
        closed[fan] = is_closed(
            vertices, std::span(found.corners).subspan(found.first[fan], found.first[fan + 1] - found.first[fan]));
    for (std::size_t i = 0; i < found.fan_of_point.size(); ++i) {
        const std::uint32_t fan = found.fan_of_point[i];
        const std::uint32_t count = found.first[fan + 1] - found.first[fan];
        fans.push_back(found.first[fan]);
        fans.push_back(count | (closed[fan] ? FAN_IS_CLOSED : 0));
        if (count == 0) result.alone_.push_back(static_cast<std::uint32_t>(i));
        if (count != 0 && !closed[fan]) result.open_.push_back(static_cast<std::uint32_t>(i));
    }
    result.device_ = device;
    result.fans_ = uploaded_words(device, fans);
    result.corners_ = uploaded_words(device, found.corners);
    result.extended_ = uploaded_words(device, {0});
    result.count_ = found.fan_of_point.size();
    result.triangles_ = vertices.size() / 9;
    return result;
}

std::uint64_t VertexFans::extended() const {
    if (!device_) return 0;
    return session_of(*device_).read_values<std::uint32_t>(static_cast<cl_mem>(extended_.get()), 1).front();
}

}  // namespace gnomon
