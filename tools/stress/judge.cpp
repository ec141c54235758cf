// SPDX-License-Identifier: MIT
// Who answers what. See judge.hpp.
#include "judge.hpp"

#include <chrono>
#include <cmath>
#include <optional>
#include <sstream>

#include "embree.hpp"
#include "plain_float.hpp"
#include "reference/parallel.hpp"
#include "reference/visibility.hpp"

namespace stress {
namespace {

class Stopwatch {
public:
    double seconds() const { return std::chrono::duration<double>(Clock::now() - start_).count(); }

private:
    using Clock = std::chrono::steady_clock;
    Clock::time_point start_ = Clock::now();
};

/// Length of the diagonal of the box around all finite triangles.
double size_of(const Floats& triangles) {
    std::array<double, 3> low, high;
    low.fill(std::numeric_limits<double>::infinity());
    high.fill(-std::numeric_limits<double>::infinity());
    for (std::size_t i = 0; i < triangles.size() / 9; ++i) {
        const reference::Triangle t = reference::triangle_at(triangles, i);
        if (!reference::is_finite(t)) continue;
        for (const Float3& v : t)
            for (int c = 0; c < 3; ++c) {
                low[c] = std::min(low[c], double(v[c]));
                high[c] = std::max(high[c], double(v[c]));
            }
    }
    return low[0] > high[0] ? 0 : std::hypot(high[0] - low[0], high[1] - low[1], high[2] - low[2]);
}

enum class Kind : std::uint8_t { absent, facing_away, asked };

/// By the contract: which points are there, and which of them are in shadow before any triangle is asked.
std::vector<Kind> kinds_of(const Question& question) {
    std::vector<Kind> kinds(question.points.size() / 3);
    const Floats& triangles = *question.triangles;
    reference::for_chunks(kinds.size(), 1024, [&](std::size_t first, std::size_t last) {
        reference::Effort effort;
        for (std::size_t i = first; i < last; ++i) {
            kinds[i] = reference::is_finite(reference::point_at(question.points, i)) ? Kind::asked : Kind::absent;
            if (kinds[i] == Kind::absent || !question.eye || question.receivers.empty()) continue;
            const std::uint32_t receiver = question.receivers[i];
            if (receiver >= triangles.size() / 9) continue;
            const reference::Triangle plane = reference::triangle_at(triangles, receiver);
            if (reference::is_finite(plane) && !reference::is_facing(plane, question.light, *question.eye, effort))
                kinds[i] = Kind::facing_away;
        }
    });
    return kinds;
}

/// The plain float test, over the triangles that the oracle's tree hands out.
std::vector<std::uint8_t> shadowed_by_plain_float(const reference::Bvh& bvh, const Question& question) {
    std::vector<std::uint8_t> result(question.points.size() / 3);
    const auto ask = [&](std::size_t i) {
        const Float3 point = reference::point_at(question.points, i);
        if (!reference::is_finite(point)) return false;
        const std::uint32_t receiver = question.receivers.empty() ? reference::NO_RECEIVER : question.receivers[i];
        const PlainRay plain = PlainRay::to_light(point, question.light);
        const reference::Ray ray = reference::Ray::to_light(point, question.light);
        bool blocked = false;
        bvh.traverse(ray, [&](std::uint32_t id, const reference::Triangle& triangle) {
            blocked = id != receiver && plain_blocks(plain, triangle);
            return blocked ? -1 : ray.last_parameter;
        });
        return blocked;
    };
    reference::for_chunks(result.size(), 1024, [&](std::size_t first, std::size_t last) {
        for (std::size_t i = first; i < last; ++i) result[i] = ask(i);
    });
    return result;
}

std::uint64_t count_wrong(const std::vector<std::uint8_t>& got, const std::vector<std::uint8_t>& truth,
                          const std::vector<Kind>& kinds) {
    std::uint64_t wrong = 0;
    for (std::size_t i = 0; i < truth.size(); ++i)
        wrong += kinds[i] == Kind::asked && got[i] != BEYOND_EMBREE && got[i] != truth[i];
    return wrong;
}

void ask_embree(const Question& question, const EmbreeScene& none, const EmbreeScene& robust, double size,
                const std::vector<std::uint8_t>& truth, const std::vector<Kind>& kinds, Tally& tally) {
    const Stopwatch time;
    tally.has_embree = true;
    for (std::size_t way = 0; way < EMBREE_WAYS.size(); ++way) {
        const auto [name, is_robust, offset] = EMBREE_WAYS[way];
        const auto got =
            (is_robust ? robust : none).shadowed(question.points, question.receivers, question.light, offset * size);
        tally.embree_wrong[way] += count_wrong(got, truth, kinds);
        if (way > 0) continue;
        for (std::size_t i = 0; i < got.size(); ++i)
            tally.embree_left_out += kinds[i] == Kind::asked && got[i] == BEYOND_EMBREE;
    }
    tally.embree_seconds += time.seconds();
}

std::string description_of(const Question& question, std::size_t point, float got, bool in_shadow) {
    std::ostringstream text;
    text << std::hexfloat << "point " << point << " at";
    for (int c = 0; c < 3; ++c) text << ' ' << question.points[3 * point + c];
    if (!question.receivers.empty()) text << ", receiver " << question.receivers[point];
    text << ", light";
    for (const float x : question.light) text << ' ' << x;
    text << std::defaultfloat << ": " << got << ", must be " << (in_shadow ? 0 : 1);
    return text.str();
}

void add_counts(const gnomon::Statistics& statistics, Tally& tally) {
    tally.by_map += statistics.count("points_decided_by_map");
    tally.facing_away += statistics.count("points_facing_away");
    tally.pairs += statistics.count("tests");
    tally.open_pairs += statistics.count("uncertain_pairs");
    tally.by_float += statistics.count("decided_by_float");
    tally.by_double += statistics.count("decided_by_double");
    tally.by_integers += statistics.count("decided_by_integers");
}

/// Camera points that see the centre of their star-shaped mesh: counted, and held against the camera's bound.
void judge_star(const reference::Bvh& bvh, const Question& question, const std::vector<Kind>& kinds, Tally& tally) {
    const auto blocked = reference::shadowed(bvh, *question.triangles, question.points, {}, {0, 0, 0, 1});
    const reference::PinholeCamera& camera = *question.star_view;
    const reference::PixelRays rays(camera);
    reference::Effort effort;
    for (std::size_t i = 0; i < blocked.size(); ++i) {
        if (kinds[i] == Kind::absent) continue;
        ++tally.star_points;
        if (blocked[i]) continue;
        ++tally.slipped;
        const auto x = static_cast<std::uint32_t>(i % camera.width), y = static_cast<std::uint32_t>(i / camera.width);
        const auto verdict =
            reference::judge_position(bvh, *question.triangles, rays, reference::centre_of(x, y), question.receivers[i],
                                      reference::point_at(question.points, i), effort);
        tally.largest_slip_ulp = std::max(tally.largest_slip_ulp, static_cast<double>(verdict.distance_ulp));
        if (!verdict.is_close) ++tally.slipped_too_far;
    }
}

}  // namespace

Tally& Tally::operator+=(const Tally& other) {
    questions += other.questions;
    triangles = std::max(triangles, other.triangles);
    points += other.points;
    directional += other.directional;
    positional += other.positional;
    shadowed += other.shadowed;
    wrong += other.wrong;
    if (first_wrong.empty()) first_wrong = other.first_wrong;
    by_map += other.by_map;
    facing_away += other.facing_away;
    pairs += other.pairs;
    open_pairs += other.open_pairs;
    by_float += other.by_float;
    by_double += other.by_double;
    by_integers += other.by_integers;
    has_plain |= other.has_plain;
    plain_wrong += other.plain_wrong;
    has_embree |= other.has_embree;
    for (std::size_t way = 0; way < embree_wrong.size(); ++way) embree_wrong[way] += other.embree_wrong[way];
    leaks += other.leaks;
    star_points += other.star_points;
    slipped += other.slipped;
    slipped_too_far += other.slipped_too_far;
    largest_slip_ulp = std::max(largest_slip_ulp, other.largest_slip_ulp);
    gnomon_seconds += other.gnomon_seconds;
    oracle_seconds += other.oracle_seconds;
    embree_left_out += other.embree_left_out;
    embree_seconds += other.embree_seconds;
    plain_seconds += other.plain_seconds;
    return *this;
}

/// What is built once for questions about the same triangles.
struct Judge::Trees {
    Trees(const gnomon::Device& device, const Question& question)
        : held(question.triangles),
          cut_outs(question.cut_outs),
          triangles(upload_triangles(device, question)),
          bvh(*held, cut_outs ? &cut_outs->masks() : nullptr),
          size(size_of(*held)) {}

    std::shared_ptr<const Floats> held;
    std::shared_ptr<const support::CutOutData> cut_outs;
    gnomon::Triangles triangles;
    reference::Bvh bvh;
    double size;
    std::optional<EmbreeScene> embree[2];  ///< default, robust
};

Judge::Judge(const gnomon::Device& device, bool with_embree) : device_(device), with_embree_(with_embree) {}
Judge::~Judge() = default;

void Judge::hold_triangles(const Question& question) {
    if (trees_ && trees_->held == question.triangles && trees_->cut_outs == question.cut_outs) return;
    trees_.reset();
    trees_ = std::make_unique<Trees>(device_, question);
    if (!with_embree_ || question.cut_outs) return;
    trees_->embree[0].emplace(*question.triangles, EmbreeFlags::none);
    trees_->embree[1].emplace(*question.triangles, EmbreeFlags::robust);
}

void Judge::ask(const Question& question, const std::vector<std::pair<std::string, std::string>>& settings,
                const std::string& where, Tally& tally) {
    hold_triangles(question);
    ++tally.questions;
    tally.triangles = std::max<std::uint64_t>(tally.triangles, question.triangles->size() / 9);

    Stopwatch gnomon_time;
    const gnomon::Points points = gnomon::Points::upload(device_, question.points, question.receivers);
    const auto facing = question.eye ? gnomon::Facing::eye(*question.eye) : gnomon::Facing::none();
    const auto technique = gnomon::make_technique("frustum-traced", device_);
    for (const auto& [name, value] : settings) technique->set(name, value);
    const gnomon::Visibility visibility(device_, points.count());
    add_counts(technique->run(trees_->triangles, points, gnomon::Light{question.light}, visibility, {.facing = facing}),
               tally);
    const std::vector<float> got = visibility.read();
    tally.gnomon_seconds += gnomon_time.seconds();

    Stopwatch oracle_time;
    const auto truth = reference::shadowed(trees_->bvh, *question.triangles, question.points, question.receivers,
                                           question.light, question.eye);
    tally.oracle_seconds += oracle_time.seconds();

    const std::vector<Kind> kinds = kinds_of(question);
    for (std::size_t i = 0; i < truth.size(); ++i) {
        if (got[i] != (truth[i] ? 0.0f : 1.0f) && tally.wrong++ == 0)
            tally.first_wrong = where + ", " + description_of(question, i, got[i], truth[i]);
        if (kinds[i] == Kind::absent) continue;
        ++tally.points;
        ++(question.light[3] == 0 ? tally.directional : tally.positional);
        tally.shadowed += truth[i];
        tally.leaks += question.is_inside && !truth[i];
    }
    if (question.star_view) judge_star(trees_->bvh, question, kinds, tally);

    if (question.cut_outs) return;  // the others know nothing of cut-outs
    tally.has_plain = true;
    Stopwatch plain_time;
    tally.plain_wrong += count_wrong(shadowed_by_plain_float(trees_->bvh, question), truth, kinds);
    tally.plain_seconds += plain_time.seconds();
    if (with_embree_) ask_embree(question, *trees_->embree[0], *trees_->embree[1], trees_->size, truth, kinds, tally);
}

}  // namespace stress
