// SPDX-License-Identifier: MIT
// Scenes that are on the device one part at a time: look_in_parts() and run_in_parts() of gnomon.hpp.
//
// The bits equal those of the whole scene, since both results combine the parts' results:
// - A point is in shadow exactly if some part puts it into shadow: one triangle that blocks suffices. The part with the
//   point's receiver excludes the receiver and tests backfacing; in the other parts the point has no receiver.
// - A pixel sees the first of all triangles in one order that only depends on the pixel (nearer first, the smaller id
//   among equals). So only the visible triangles of the earlier parts can be visible in the whole; the next part is
//   tested together with these. Ids rise in such a list as in the scene, so equals stay in order.
//
// The size of a part is found by trying: a part that ends with OutOfDeviceMemory is halved. The code assumes nothing
// about a technique's memory, and every failed try leaves all objects usable.
#include <algorithm>
#include <numeric>

#include "cl/session.hpp"
#include "query/inputs.hpp"
#include "query/statistics.hpp"

namespace gnomon {
namespace {

using Ids = std::vector<std::uint32_t>;

/// Smaller parts are not tried: if such a part does not fit, the parts are not the cause.
constexpr std::size_t smallest_part = 256;

std::vector<float> gathered(std::span<const float> vertices, std::span<const std::uint32_t> ids) {
    std::vector<float> part;
    part.reserve(ids.size() * 9);
    for (const std::uint32_t id : ids) {
        const auto triangle = vertices.subspan(9 * std::size_t(id), 9);
        part.insert(part.end(), triangle.begin(), triangle.end());
    }
    return part;
}

/// The triangles `ids` on the device, with their cut-outs if there are any.
Triangles upload_gathered(const Device& device, const SceneOnHost& scene, const Ids& ids) {
    const std::vector<float> part = gathered(scene.vertices, ids);
    const CutOuts* cut_outs = scene.cut_outs;
    if (cut_outs == nullptr) return Triangles::upload(device, part);
    CutOuts of_part = *cut_outs;
    Ids materials;
    std::vector<float> coordinates, alphas;
    for (const std::uint32_t id : ids) {
        const CutOuts one = cut_outs->part(id, 1);
        materials.push_back(one.material_of_triangle.front());
        coordinates.insert(coordinates.end(), one.texture_coordinates.begin(), one.texture_coordinates.end());
        alphas.insert(alphas.end(), one.corner_alphas.begin(), one.corner_alphas.end());
    }
    of_part.material_of_triangle = materials;
    of_part.texture_coordinates = coordinates;
    of_part.corner_alphas = alphas;
    return Triangles::upload(device, part, of_part);
}

/// The visible triangles among the tested triangles `ids`.
Ids seen_of(const Device& device, const View& view, const Ids& ids) {
    const auto receivers = session_of(device).read_values<std::uint32_t>(view.points.receivers(), view.points.count());
    std::vector<bool> is_seen(ids.size(), false);
    for (const std::uint32_t receiver : receivers)
        if (receiver != no_receiver) is_seen[receiver] = true;
    Ids seen;
    for (std::size_t i = 0; i < ids.size(); ++i)
        if (is_seen[i]) seen.push_back(ids[i]);
    return seen;
}

/// The points that no part so far has put into shadow.
struct OpenPoints {
    std::vector<float> positions;  ///< 3 each
    std::vector<float> normals;    ///< 3 each where these decide facing, else empty
    Ids receivers;                 ///< positions in the whole scene, or no_receiver
    Ids indices;                   ///< the points' indices in `visibility`

    std::size_t count() const { return indices.size(); }
};

OpenPoints all_open(const Device& device, const Points& points, std::span<const std::uint32_t> ids,
                    const FacingInputs& sides) {
    PointsOnHost host = points.read(device);
    OpenPoints open{std::move(host.position), {}, std::move(host.receiver), Ids(points.count())};
    if (sides.normals != nullptr)
        open.normals = Points::wrap(device, sides.normals, sides.normals_layout, points.count()).read(device).position;
    if (!ids.empty())
        for (std::uint32_t& receiver : open.receivers) receiver = receiver < ids.size() ? ids[receiver] : no_receiver;
    std::iota(open.indices.begin(), open.indices.end(), 0u);
    return open;
}

struct Part {
    Triangles triangles;
    std::size_t first;  ///< id of its first triangle in the whole scene
};

Triangles uploaded_part(const Device& device, const SceneOnHost& scene, std::size_t first, std::size_t count) {
    const auto vertices = scene.vertices.subspan(9 * first, 9 * count);
    return scene.cut_outs != nullptr ? Triangles::upload(device, vertices, scene.cut_outs->part(first, count))
                                     : Triangles::upload(device, vertices);
}

/// Visibility of the open points [first, first + count) by one part.
std::vector<float> visible(const Device& device, Technique& technique, const Part& part, const OpenPoints& open,
                           std::size_t first, std::size_t count, const FacingInputs& sides, const Light& light,
                           Statistics& statistics) {
    Ids receivers(open.receivers.begin() + std::ptrdiff_t(first),
                  open.receivers.begin() + std::ptrdiff_t(first + count));
    for (std::uint32_t& receiver : receivers) {
        const bool is_here = receiver >= part.first && receiver - part.first < part.triangles.count();
        receiver = is_here ? std::uint32_t(receiver - part.first) : no_receiver;
    }
    const Points points = Points::upload(device, std::span(open.positions).subspan(3 * first, 3 * count), receivers);
    const Visibility visibility(device, count);
    const Facing facing = sides.eye     ? Facing::eye(*sides.eye)
                          : sides.front ? Facing::winding()
                          : sides.normals == nullptr
                              ? Facing::none()
                              : Facing::normals(std::span(open.normals).subspan(3 * first, 3 * count));
    const Statistics run = technique.run(part.triangles, points, light, visibility, {.facing = facing});
    statistics.device_memory_bytes = std::max(statistics.device_memory_bytes, run.device_memory_bytes);
    add_stages(statistics, run);
    return visibility.read();
}

/// Removes the points in shadow from the open points and writes their `visibility`.
void close_points(OpenPoints& open, std::span<const float> answers, std::vector<float>& visibility) {
    std::size_t kept = 0;
    for (std::size_t i = 0; i < answers.size(); ++i) {
        visibility[open.indices[i]] = std::min(visibility[open.indices[i]], answers[i]);
        if (answers[i] == 0) continue;
        std::copy_n(&open.positions[3 * i], 3, &open.positions[3 * kept]);
        if (!open.normals.empty()) std::copy_n(&open.normals[3 * i], 3, &open.normals[3 * kept]);
        open.receivers[kept] = open.receivers[i];
        open.indices[kept++] = open.indices[i];
    }
    open.positions.resize(3 * kept);
    if (!open.normals.empty()) open.normals.resize(3 * kept);
    open.receivers.resize(kept);
    open.indices.resize(kept);
}

}  // namespace

ViewOfParts look_in_parts(const Device& device, const SceneOnHost& scene, const Camera& camera, std::uint32_t width,
                          std::uint32_t height) {
    require_groups(scene.vertices.size(), 9, "triangles");
    const std::size_t total = scene.vertices.size() / 9;
    Ids seen;  // of the triangles before `first`
    for (std::size_t first = 0, part = total;;) {
        const std::size_t count = std::min(part, total - first);
        Ids ids = seen;
        for (std::size_t id = first; id < first + count; ++id) ids.push_back(std::uint32_t(id));
        try {
            Triangles triangles = upload_gathered(device, scene, ids);
            View view = look(device, triangles, camera, width, height);
            first += count;
            if (first == total) return {std::move(view), std::move(triangles), std::move(ids)};
            seen = seen_of(device, view, ids);
        } catch (const OutOfDeviceMemory&) {
            if (count <= smallest_part) throw;
            part = (count + 1) / 2;
        }
    }
}

Statistics run_in_parts(const std::function<std::unique_ptr<Technique>()>& make, const Device& device,
                        const SceneOnHost& scene, const Points& points, std::span<const std::uint32_t> ids,
                        const Light& light, const Visibility& visibility, const RunOptions& options) {
    require_groups(scene.vertices.size(), 9, "triangles");
    const auto start = cl::Clock::now();
    const FacingInputs sides = Internals::facing_inputs(device, points, options.facing);
    if (sides.fans != nullptr)
        throw InvalidArgument("fans need all triangles at once: a run in parts has no facing by fans");
    require_run(Triangles(), Internals::seen_from(points, sides.eye), light, visibility);
    Statistics statistics;
    OpenPoints open = all_open(device, points, ids, sides);
    std::vector<float> answers(points.count(), 1.0f);
    std::unique_ptr<Technique> technique = make();
    const std::size_t total = scene.vertices.size() / 9;
    std::size_t triangle_part = total, point_part = std::max<std::size_t>(open.count(), 1), parts = 0;
    for (std::size_t first = 0; first < total;) {
        const std::size_t count = std::min(triangle_part, total - first);
        try {
            const Part part{uploaded_part(device, scene, first, count), first};
            std::vector<float> found;
            while (found.size() < open.count()) {
                const std::size_t batch = std::min(point_part, open.count() - found.size());
                const auto values =
                    visible(device, *technique, part, open, found.size(), batch, sides, light, statistics);
                found.insert(found.end(), values.begin(), values.end());
            }
            close_points(open, found, answers);
            first += count;
            ++parts;
            if (options.progress && !options.progress(double(first) / double(total)))
                throw Cancelled("the run in parts was cancelled");
        } catch (const OutOfDeviceMemory&) {
            if (std::max(count, point_part) <= smallest_part) throw;
            (count >= point_part ? triangle_part : point_part) = (std::max(count, point_part) + 1) / 2;
            technique.reset();  // frees the buffers of the failed try
            technique = make();
        }
    }
    session_of(device).write(visibility.buffer(), answers.data(), answers.size() * sizeof(float));
    statistics.counts = {{"points", points.count()},
                         {"points_in_shadow", std::uint64_t(std::count(answers.begin(), answers.end(), 0.0f))},
                         {"triangles", total},
                         {"parts", parts}};
    statistics.total_wall_ms = cl::ms_since(start);
    return statistics;
}

}  // namespace gnomon
