// SPDX-License-Identifier: MIT
// See points.hpp.
#include "points.hpp"

#include <cmath>

#include "reference/parallel.hpp"
#include "support/tie_points.hpp"

namespace stress {
namespace {

std::uint32_t triangle_count(const Question& question) {
    return static_cast<std::uint32_t>(question.triangles->size() / 9);
}

struct Chunk {
    Floats points;
    std::vector<std::uint32_t> receivers;
};

/// Calls make(random, count, chunk) on all threads, each chunk with random numbers of its own, and lines the chunks up.
template <typename Make>
void in_chunks(const PointRequest& request, Question& question, Make make) {
    constexpr std::size_t size = 16384;
    std::vector<Chunk> chunks((request.count + size - 1) / size);
    const std::uint64_t seed = request.random.next();
    reference::for_chunks(chunks.size(), 1, [&](std::size_t i, std::size_t) {
        Random random(seed + 7919 * i);
        make(random, std::min(size, request.count - size * i), chunks[i]);
    });
    for (const Chunk& chunk : chunks) {
        support::append(question.points, chunk.points);
        question.receivers.insert(question.receivers.end(), chunk.receivers.begin(), chunk.receivers.end());
    }
}

struct Bounds {
    Float3 low, high;
};

Bounds bounds_of(const Floats& triangles) {
    Bounds bounds{support::vertex(triangles, 0), support::vertex(triangles, 0)};
    for (std::size_t i = 0; i < triangles.size(); ++i) {
        bounds.low[i % 3] = std::min(bounds.low[i % 3], triangles[i]);
        bounds.high[i % 3] = std::max(bounds.high[i % 3], triangles[i]);
    }
    return bounds;
}

/// From somewhere around one vertex towards another.
Viewpoint random_viewpoint(const Floats& triangles, Random& random) {
    const auto random_vertex = [&] {
        return support::vertex(triangles, random.below(static_cast<std::uint32_t>(triangles.size() / 3)));
    };
    Viewpoint view;
    do {
        view.target = random_vertex();
        const Float3 other = random_vertex();
        const float far = random.between(0.1f, 2);
        for (int c = 0; c < 3; ++c) view.eye[c] = view.target[c] + (other[c] - view.target[c]) * far;
        view.eye[1] += std::fabs(view.eye[0] - view.target[0]) * 0.25f;
    } while (view.eye == view.target);
    // Up is the axis that is farthest from the view.
    const auto along = [&](int c) { return std::fabs(view.eye[c] - view.target[c]); };
    const int up = along(1) <= along(0) ? (along(1) <= along(2) ? 1 : 2) : (along(0) <= along(2) ? 0 : 2);
    view.up = {0, 0, 0};
    view.up[up] = 1;
    view.fov_y_degrees = random.between(30, 100);
    return view;
}

}  // namespace

void points_in_the_cube(const PointRequest& request, Question& question) {
    in_chunks(request, question, [&](Random& random, std::size_t count, Chunk& chunk) {
        const Floats unit = support::random_points(count, -1.2f, 1.2f, random.next());
        chunk.points = support::placed(unit, request.subject.scale, request.subject.offset);
    });
}

void points_near_triangles(const PointRequest& request, Question& question) {
    const Floats& triangles = *question.triangles;
    in_chunks(request, question, [&](Random& random, std::size_t count, Chunk& chunk) {
        for (std::size_t i = 0; i < count; ++i) {
            const std::uint32_t id = random.below(triangle_count(question));
            const auto place = support::place_on(random, triangles, id);
            double size = 0;
            for (std::size_t k = 0; k < 9; ++k)
                size = std::max(size, std::fabs(double(triangles[9 * id + k]) - double(triangles[9 * id + k % 3])));
            const double away = random.below(4) == 0 ? 0 : size * std::pow(10.0, random.between(-7, 0.5f));
            for (int c = 0; c < 3; ++c)
                chunk.points.push_back(static_cast<float>(place[c] + away * random.between(-1, 1)));
            chunk.receivers.push_back(random.below(2) == 0 ? id : gnomon::no_receiver);
        }
    });
}

void points_on_rays(const PointRequest& request, Question& question) {
    in_chunks(request, question, [&](Random& random, std::size_t count, Chunk& chunk) {
        chunk.points =
            support::points_behind(*question.triangles, question.light, count, request.subject.reach, random.next());
    });
}

void points_on_lattice(const PointRequest& request, Question& question) {
    const Bounds bounds = bounds_of(*question.triangles);
    const double cell = request.subject.scale;
    in_chunks(request, question, [&](Random& random, std::size_t count, Chunk& chunk) {
        for (std::size_t i = 0; i < 3 * count; ++i) {
            const double low = bounds.low[i % 3] - cell, high = bounds.high[i % 3] + cell;
            const auto steps = static_cast<std::uint32_t>(2 * (high - low) / cell) + 1;
            chunk.points.push_back(static_cast<float>(low + 0.5 * cell * random.below(steps)));
        }
    });
}

void points_exactly_behind(const PointRequest& request, Question& question) {
    const Light& light = question.light;
    in_chunks(request, question, [&](Random& random, std::size_t count, Chunk& chunk) {
        for (std::size_t i = 0; i < count; ++i) {
            const std::uint32_t id = random.below(triangle_count(question)), corner = random.below(3);
            const Float3 a = support::vertex(*question.triangles, 3 * id + corner);
            // A vertex or the middle of an edge: a multiple of a half.
            const Float3 b = support::vertex(*question.triangles, 3 * id + (corner + random.below(2)) % 3);
            // At a vertex or middle, before it by one or two steps, or behind it by up to 5.
            const float steps = float(random.below(8)) - 2;
            for (int c = 0; c < 3; ++c) {
                const float place = (a[c] + b[c]) / 2;
                chunk.points.push_back(light[3] == 0 ? place - steps * light[c] : place + steps * (place - light[c]));
            }
        }
    });
}

void add_view(const gnomon::Device& device, const Viewpoint& from, std::uint32_t width, std::uint32_t height,
              Question& question) {
    const auto triangles = upload_triangles(device, question);
    const auto camera = gnomon::Camera::look_at(from.eye, from.target, from.up, from.fov_y_degrees);
    auto view = gnomon::look(device, triangles, camera, width, height).read(device, triangles);
    for (std::size_t i = 0; i < view.receiver.size(); ++i)
        if (view.receiver[i] == gnomon::no_receiver)
            view.position[3 * i] = std::numeric_limits<float>::quiet_NaN();  // the sky is absent
    question.points = std::move(view.position);
    question.receivers = std::move(view.receiver);
    question.eye = from.eye;
}

void points_of_a_view(const PointRequest& request, Question& question) {
    const auto& views = request.subject.views;
    const Viewpoint from =
        request.variant < views.size() ? views[request.variant] : random_viewpoint(*question.triangles, request.random);
    // About 16 : 9, and of all remainders.
    const auto height = std::max<std::uint32_t>(1, static_cast<std::uint32_t>(std::sqrt(request.count * 9.0 / 16)));
    const auto width = std::max<std::uint32_t>(1, static_cast<std::uint32_t>(request.count / height));
    add_view(request.device, from, std::min(width, 16384u), std::min(height, 16384u), question);
}

}  // namespace stress
