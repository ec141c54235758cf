// SPDX-License-Identifier: MIT
// Collects the shadows on each receiver (lit_share.hpp has method and proof), one light after the other.
#include "lit_fractions.hpp"

#include <algorithm>
#include <atomic>
#include <chrono>
#include <cmath>
#include <thread>

#include "lit_share.hpp"

namespace gnomon::python {
namespace {

__extension__ typedef __int128 Wide;

// A triangle as a receiver: its plane, exactly.
struct Receiver {
    std::uint32_t triangle;
    std::array<Wide, 3> normal;
    double area;

    Wide height(const LatticeTriangle& of, const std::array<std::int32_t, 3>& x) const {
        Wide sum = 0;
        for (unsigned c = 0; c < 3; ++c) sum += normal[c] * (x[c] - of[0][c]);
        return sum;
    }
};

Receiver receiver_of(const LatticeTriangle& t, std::uint32_t id) {
    std::array<Wide, 3> a, b;
    for (unsigned c = 0; c < 3; ++c) a[c] = t[1][c] - t[0][c], b[c] = t[2][c] - t[0][c];
    Receiver r{id, {a[1] * b[2] - a[2] * b[1], a[2] * b[0] - a[0] * b[2], a[0] * b[1] - a[1] * b[0]}, 0};
    r.area = std::sqrt(double(r.normal[0]) * double(r.normal[0]) + double(r.normal[1]) * double(r.normal[1]) +
                       double(r.normal[2]) * double(r.normal[2])) /
             2;
    return r;
}

// The sign of n . l, exactly. n has 52 bits, a coordinate of l 24 significant ones. A coordinate that is no whole
// multiple of 2^exponent is below 2^24 of them, so the products that are not in the sum yet are below 2^76 each.
int side_of(const std::array<Wide, 3>& n, const float* l) {
    constexpr Wide certain = Wide(1) << 78;
    constexpr int finer = 40;  // 78 + 40 and 24 + 40 + 52 bits are below 127
    std::array<double, 3> rest{l[0], l[1], l[2]};
    int exponent = std::ilogb(std::max({std::abs(l[0]), std::abs(l[1]), std::abs(l[2])})) - 66;  // at first below 2^67
    for (Wide sum = 0;; sum *= Wide(1) << finer, exponent -= finer) {
        for (unsigned c = 0; c < 3; ++c) {
            const double scaled = std::ldexp(rest[c], -exponent);
            if (scaled == std::trunc(scaled)) sum += n[c] * Wide(scaled), rest[c] = 0;
        }
        if (rest == std::array<double, 3>{} || sum > certain || sum < -certain) return (sum > 0) - (sum < 0);
    }
}

// All triangles as one light sees them, and a grid of lists of those that its squares may meet.
class LightSpace {
public:
    LightSpace(std::span<const LatticeTriangle> triangles, const float* towards) {
        axis_ = std::abs(towards[0]) > std::abs(towards[1]) ? 0 : 1;
        if (std::abs(towards[2]) >= std::abs(towards[axis_])) axis_ = 2;
        u_ = (axis_ + 1) % 3;
        v_ = (axis_ + 2) % 3;
        is_mirrored_ = towards[axis_] < 0;
        slope_u_ = double(towards[u_]) / towards[axis_];
        slope_v_ = double(towards[v_]) / towards[axis_];
        boxes_.resize(triangles.size());
        for (std::size_t t = 0; t < triangles.size(); ++t) {
            for (const auto& x : triangles[t]) boxes_[t].add(projected(x));
            all_.add(boxes_[t].low);
            all_.add(boxes_[t].high);
        }
        side_ = std::clamp<std::size_t>(std::size_t(std::sqrt(double(triangles.size())) / 4), 1, 512);
        scale_ = {side_ / std::max(all_.high.x - all_.low.x, 1.0), side_ / std::max(all_.high.y - all_.low.y, 1.0)};
        first_.assign(side_ * side_ + 1, 0);
        for (const Box& box : boxes_) for_squares(box, [&](std::size_t s) { ++first_[s + 1]; });
        for (std::size_t s = 0; s < side_ * side_; ++s) first_[s + 1] += first_[s];
        list_.resize(first_.back());
        std::vector<std::uint32_t> slot(first_.begin(), first_.end() - 1);
        for (std::uint32_t t = 0; t < boxes_.size(); ++t)
            for_squares(boxes_[t], [&](std::size_t s) { list_[slot[s]++] = t; });
        seen_.assign(triangles.size(), 0);
    }

    // A light from below mirrors the plane, so that what faces the light is counter-clockwise in any case.
    Point projected(const std::array<std::int32_t, 3>& x) const {
        const double depth = x[axis_];
        const Point p{x[u_] - depth * slope_u_, x[v_] - depth * slope_v_};
        return is_mirrored_ ? Point{p.y, p.x} : p;
    }
    const Box& box(std::uint32_t triangle) const { return boxes_[triangle]; }

    // Calls with each triangle whose box may meet that of a triangle, once.
    template <typename Call>
    void for_neighbours(std::uint32_t triangle, const Call& call) {
        ++visit_;
        for_squares(boxes_[triangle], [&](std::size_t s) {
            for (std::uint32_t i = first_[s]; i < first_[s + 1]; ++i) {
                const std::uint32_t t = list_[i];
                if (seen_[t] == visit_) continue;
                seen_[t] = visit_;
                if (!boxes_[t].is_apart(boxes_[triangle])) call(t);
            }
        });
    }

private:
    template <typename Call>
    void for_squares(const Box& box, const Call& call) const {
        const auto square = [&](double at, double low, double scale) {
            return std::size_t(std::clamp((at - low) * scale, 0.0, double(side_ - 1)));
        };
        const std::size_t x0 = square(box.low.x - CERTAIN, all_.low.x, scale_.x),
                          x1 = square(box.high.x + CERTAIN, all_.low.x, scale_.x);
        const std::size_t y0 = square(box.low.y - CERTAIN, all_.low.y, scale_.y),
                          y1 = square(box.high.y + CERTAIN, all_.low.y, scale_.y);
        for (std::size_t y = y0; y <= y1; ++y)
            for (std::size_t x = x0; x <= x1; ++x) call(y * side_ + x);
    }

    unsigned axis_, u_, v_;
    bool is_mirrored_;
    double slope_u_, slope_v_;
    std::vector<Box> boxes_;
    Box all_;
    std::size_t side_;
    Point scale_;
    std::vector<std::uint32_t> first_, list_, seen_;
    std::uint32_t visit_ = 0;
};

// Appends the shadow of an occluder's part above the receiver's plane, as one or two triangles. Returns how many are
// too narrow.
unsigned add_shadows(const std::array<Point, 3>& corner, const std::array<Wide, 3>& heights, const Box& receiver,
                     std::vector<Shadow>* shadows) {
    Polygon part;
    for (unsigned i = 0; i < 3; ++i) {
        const unsigned j = (i + 1) % 3;
        if (heights[i] >= 0) part.add(corner[i]);
        if ((heights[i] > 0 && heights[j] < 0) || (heights[i] < 0 && heights[j] > 0)) {
            const double t = double(heights[i]) / double(heights[i] - heights[j]);
            part.add({corner[i].x + t * (corner[j].x - corner[i].x), corner[i].y + t * (corner[j].y - corner[i].y)});
        }
    }
    unsigned left_out = 0;
    for (unsigned i = 1; i + 1 < part.count; ++i) {
        Shadow s{{part.corner[0], part.corner[i], part.corner[i + 1]}, {}, {}, 0};
        const double twice = cross(s.corner[0], s.corner[1], s.corner[2]);
        if (twice < 0) std::swap(s.corner[1], s.corner[2]);
        for (const Point p : s.corner) s.box.add(p);
        if (s.box.is_apart(receiver)) continue;
        double longest = 0;
        for (unsigned k = 0; k < 3; ++k) {
            const Point a = s.corner[k], b = s.corner[(k + 1) % 3];
            const double length = std::sqrt((b.x - a.x) * (b.x - a.x) + (b.y - a.y) * (b.y - a.y));
            s.left[k] = {(a.y - b.y) / length, (b.x - a.x) / length};
            longest = std::max(longest, length);
        }
        if (std::abs(twice) <= SLIVER * longest) {
            ++left_out;
            continue;
        }
        s.overlap = (std::min(s.box.high.x, receiver.high.x) - std::max(s.box.low.x, receiver.low.x)) *
                    (std::min(s.box.high.y, receiver.high.y) - std::max(s.box.low.y, receiver.low.y));
        shadows->push_back(s);
    }
    return left_out;
}

// The sums over the triangles of one face, weighed by their areas in space.
struct FaceSums {
    double area = 0, low = 0, high = 0, lit = 0;
    std::array<double, 3> moment{};
};

class Decider {
public:
    Decider(std::span<const LatticeTriangle> triangles, std::span<const std::int32_t> face, std::uint32_t face_count,
            std::span<const float> towards, const LitFractionsSettings& settings)
        : triangles_(triangles), face_(face), face_count_(face_count), towards_(towards), settings_(settings) {
        for (std::uint32_t t = 0; t < triangles.size(); ++t)
            if (face[t] >= 0) receivers_.push_back(receiver_of(triangles[t], t));
        const std::size_t pairs = towards.size() / 3 * face_count;
        found_.low.resize(pairs);
        found_.high.resize(pairs);
        if (settings.centroids) found_.centroid.resize(3 * pairs);
    }

    LitFractions run() {
        std::atomic<std::size_t> next{0};
        const auto work = [&](const std::function<bool()>& goes_on) {
            for (std::size_t light; (light = next++) < towards_.size() / 3;) decide_light(light, goes_on);
        };
        std::vector<std::thread> others;
        for (unsigned i = 1; i < settings_.threads; ++i)
            others.emplace_back(work, [this] { return !is_over_.load(std::memory_order_relaxed); });
        work([this, last = Clock::now()]() mutable {
            if (Clock::now() - last > std::chrono::milliseconds(50)) {
                if (!settings_.goes_on()) is_over_ = true;
                last = Clock::now();
            }
            return !is_over_;
        });
        for (std::thread& thread : others) thread.join();
        return std::move(found_);
    }

private:
    using Clock = std::chrono::steady_clock;

    void decide_light(std::size_t light, const std::function<bool()>& goes_on) {
        const float* const towards = &towards_[3 * light];
        LightSpace space(triangles_, towards);
        std::vector<FaceSums> faces(face_count_);
        for (const Receiver& receiver : receivers_) {
            if (!goes_on()) return;
            FaceSums& sums = faces[std::size_t(face_[receiver.triangle])];
            sums.area += receiver.area;
            if (side_of(receiver.normal, towards) > 0) decide_receiver(receiver, space, &sums);
        }
        for (std::size_t f = 0; f < face_count_; ++f) store(faces[f], light * face_count_ + f);
    }

    void decide_receiver(const Receiver& receiver, LightSpace& space, FaceSums* sums) {
        const LatticeTriangle& own = triangles_[receiver.triangle];
        Polygon polygon;
        for (const auto& x : own) polygon.add(space.projected(x));
        std::vector<Shadow> shadows;
        unsigned left_out = 0;
        space.for_neighbours(receiver.triangle, [&](std::uint32_t t) {
            if (face_[t] == face_[receiver.triangle]) return;
            std::array<Wide, 3> heights;
            std::array<Point, 3> corner;
            for (unsigned i = 0; i < 3; ++i) heights[i] = receiver.height(own, triangles_[t][i]);
            if (heights[0] <= 0 && heights[1] <= 0 && heights[2] <= 0) return;
            for (unsigned i = 0; i < 3; ++i) corner[i] = space.projected(triangles_[t][i]);
            left_out += add_shadows(corner, heights, space.box(receiver.triangle), &shadows);
        });
        std::sort(shadows.begin(), shadows.end(),
                  [](const Shadow& a, const Shadow& b) { return a.overlap > b.overlap; });
        Share share(polygon, shadows, left_out);
        share.refine(settings_.within, settings_.limit);
        sums->low += receiver.area * share.low();
        sums->high += receiver.area * share.high();
        if (settings_.centroids && share.lit() > 0) add_moment(receiver, polygon, share, sums);
    }

    // Carries the centroid from the projection to the triangle, by its weights of the corners.
    void add_moment(const Receiver& receiver, const Polygon& p, const Share& share, FaceSums* sums) const {
        const LatticeTriangle& own = triangles_[receiver.triangle];
        const Point at{share.moment().x / share.lit(), share.moment().y / share.lit()};
        const double whole = cross(p.corner[0], p.corner[1], p.corner[2]);
        const double b = cross(p.corner[0], at, p.corner[2]) / whole, c = cross(p.corner[0], p.corner[1], at) / whole;
        const double lit = receiver.area * share.lit() / p.area();
        sums->lit += lit;
        for (unsigned k = 0; k < 3; ++k)
            sums->moment[k] += lit * (own[0][k] + b * (own[1][k] - own[0][k]) + c * (own[2][k] - own[0][k]));
    }

    // The sums over triangles round by less than 2^-40 of themselves; none and all of a face stay what they are.
    void store(const FaceSums& sums, std::size_t pair) {
        found_.low[pair] = sums.low == sums.area ? 1 : std::max(sums.low / sums.area * (1 - 0x1p-40), 0.0);
        found_.high[pair] = std::min(sums.high / sums.area * (1 + 0x1p-40), 1.0);
        for (unsigned k = 0; k < 3 && settings_.centroids; ++k)
            found_.centroid[3 * pair + k] = sums.lit > 0 ? sums.moment[k] / sums.lit : std::nan("");
    }

    std::span<const LatticeTriangle> triangles_;
    std::span<const std::int32_t> face_;
    std::uint32_t face_count_;
    std::span<const float> towards_;
    LitFractionsSettings settings_;
    std::vector<Receiver> receivers_;
    LitFractions found_;
    std::atomic<bool> is_over_{false};
};

}  // namespace

LitFractions lit_fractions(std::span<const LatticeTriangle> triangles, std::span<const std::int32_t> face,
                           std::uint32_t face_count, std::span<const float> towards,
                           const LitFractionsSettings& settings) {
    return Decider(triangles, face, face_count, towards, settings).run();
}

}  // namespace gnomon::python
