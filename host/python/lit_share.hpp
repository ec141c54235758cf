// SPDX-License-Identifier: MIT
// Method. For a light all triangles are projected along it onto a coordinate plane: there a receiver R and the parts of
// the occluders that lie strictly above R's plane are polygons, and shares of R's area are those in space. The shadows
// are subtracted from R one after the other; what is left of R is a list of convex pieces. A piece that no further
// shadow meets is lit; a piece inside a shadow is dark, and so is what two shadows with a common edge cover together;
// pieces that have not met all shadows are undecided. The largest piece is taken first.
//
// Proof. Heights above a plane are exact: corners are whole numbers below 2^24, so a normal's are below 2^52 and a
// height below 2^80. Lengths are in steps. A projected corner rounds by at most 2^-26, since no coordinate grows beyond
// 2^25, and a corner where an edge crosses the plane by 2^-24 with it. So the shadow's triangle, as stored, differs
// from the true one in a strip of 2^-24 to each side of its border, whose part in a convex piece is at most as long as
// the piece's border. A cut of a stored piece by a stored line is wrong only within 2^-22 of that line: of that size
// are the roundings of a distance (8 2^-53 2^27 in products and differences) and of a new corner. Three cuts and the
// strip are wrong by less than ERROR times the piece's border in area. A shadow narrower than SLIVER is left out, which
// is wrong by less than 2 SLIVER times the receiver's border. The roundings of areas (2^-51 times a piece's diameter
// squared, so 2^-25 times its border) are in ERROR, too. Subtracting the same shadow from two sets does not make
// their difference larger, so that the errors add up: |stored lit area - true lit area| is at most their sum, `error`.
#pragma once

#include <algorithm>
#include <array>
#include <cmath>
#include <cstdint>
#include <limits>
#include <vector>

namespace gnomon::python {

constexpr double CERTAIN = 0x1p-21, ERROR = 0x1p-18, SLIVER = 0x1p-18;

struct Point {
    double x, y;
};

inline double cross(Point a, Point b, Point c) { return (b.x - a.x) * (c.y - a.y) - (b.y - a.y) * (c.x - a.x); }

struct Box {
    Point low{std::numeric_limits<double>::max(), std::numeric_limits<double>::max()};
    Point high{std::numeric_limits<double>::lowest(), std::numeric_limits<double>::lowest()};
    void add(Point p) {
        low = {std::min(low.x, p.x), std::min(low.y, p.y)};
        high = {std::max(high.x, p.x), std::max(high.y, p.y)};
    }
    bool is_apart(const Box& b) const {
        return low.x > b.high.x + CERTAIN || b.low.x > high.x + CERTAIN || low.y > b.high.y + CERTAIN ||
               b.low.y > high.y + CERTAIN;
    }
};

// A convex polygon, counter-clockwise.
struct Polygon {
    static constexpr unsigned MOST = 24;
    std::array<Point, MOST> corner;
    unsigned count = 0;

    void add(Point p) { corner[count++] = p; }
    Point next(unsigned i) const { return corner[i + 1 == count ? 0 : i + 1]; }
    double area() const {
        double twice = 0;
        for (unsigned i = 1; i + 1 < count; ++i) twice += cross(corner[0], corner[i], corner[i + 1]);
        return std::max(twice / 2, 0.0);
    }
    double border() const {
        double length = 0;
        for (unsigned i = 0; i < count; ++i) length += std::hypot(next(i).x - corner[i].x, next(i).y - corner[i].y);
        return length;
    }
    // The integral of the position over the area.
    Point moment() const {
        Point sum{0, 0};
        for (unsigned i = 1; i + 1 < count; ++i) {
            const double sixth = cross(corner[0], corner[i], corner[i + 1]) / 6;
            sum.x += sixth * (corner[0].x + corner[i].x + corner[i + 1].x);
            sum.y += sixth * (corner[0].y + corner[i].y + corner[i + 1].y);
        }
        return sum;
    }
};

// An occluder's shadow, or half of it: counter-clockwise.
struct Shadow {
    std::array<Point, 3> corner;
    std::array<Point, 3> left;  // unit vectors to the left of the edge that begins at each corner
    Box box;
    double overlap;  // of its box with that of the receiver
};

struct Piece {
    Polygon polygon;
    double area = 0;
    Box box{};
    std::size_t met = 0;  // the shadows before this one are subtracted
    bool operator<(const Piece& other) const { return area < other.area; }
};

// The distances of a polygon's corners to the left of a line through a point.
struct Distances {
    std::array<double, Polygon::MOST> of;
    double least = std::numeric_limits<double>::max(), largest = std::numeric_limits<double>::lowest();
    Distances(const Polygon& p, Point a, Point left) {
        for (unsigned i = 0; i < p.count; ++i) {
            of[i] = left.x * (p.corner[i].x - a.x) + left.y * (p.corner[i].y - a.y);
            least = std::min(least, of[i]);
            largest = std::max(largest, of[i]);
        }
    }
};

// Cuts a polygon by a line into the parts to its left and to its right.
inline void cut(const Polygon& p, const Distances& distance, Polygon* left, Polygon* right) {
    left->count = right->count = 0;
    for (unsigned i = 0; i < p.count; ++i) {
        const unsigned j = i + 1 == p.count ? 0 : i + 1;
        const double here = distance.of[i], there = distance.of[j];
        if (here >= 0) left->add(p.corner[i]);
        if (here <= 0) right->add(p.corner[i]);
        if ((here > 0 && there < 0) || (here < 0 && there > 0)) {
            const double t = here / (here - there);
            const Point at{p.corner[i].x + t * (p.corner[j].x - p.corner[i].x),
                           p.corner[i].y + t * (p.corner[j].y - p.corner[i].y)};
            left->add(at);
            right->add(at);
        }
    }
}

// What is known of a receiver's share, in area of the projection.
class Share {
public:
    // left_out: how many shadows are too narrow to be among `shadows`.
    Share(const Polygon& receiver, const std::vector<Shadow>& shadows, unsigned left_out)
        : shadows_(shadows), whole_(receiver.area()) {
        error_of_whole_ = 0x1p-23 * receiver.border();
        error_ = 2 * SLIVER * left_out * receiver.border();
        push(receiver, 0);
    }

    // Refines until the undecided area is at most `within` of the receiver's, or `limit` subtractions are done.
    void refine(double within, std::uint64_t limit) {
        std::uint64_t done = 0;
        while (!open_.empty() && undecided_ > within * whole_) {
            Piece piece = open_.front();
            while (piece.met < shadows_.size() && is_apart(piece, shadows_[piece.met])) ++piece.met;
            if (piece.met < shadows_.size() && done++ >= limit) return;
            std::pop_heap(open_.begin(), open_.end());
            open_.pop_back();
            undecided_ -= piece.area;
            if (piece.met == shadows_.size()) {
                lit_ += piece.area;
                const Point moment = piece.polygon.moment();
                moment_ = {moment_.x + moment.x, moment_.y + moment.y};
            } else {
                subtract(piece);
            }
        }
    }

    bool is_whole() const { return open_.empty() && error_ == 0 && !is_cut_; }
    double low() const {
        if (is_whole()) return lit_ > 0 ? 1 : 0;
        return std::clamp((lit_ - error()) / (whole_ + error_of_whole_), 0.0, 1.0);
    }
    double high() const {
        if (is_whole()) return lit_ > 0 ? 1 : 0;
        double open = 0;  // anew: `undecided_` has rounded at each step
        for (const Piece& piece : open_) open += piece.area;
        if (whole_ <= error_of_whole_) return 1;
        return std::clamp((lit_ + open + error()) / (whole_ - error_of_whole_), 0.0, 1.0);
    }
    double lit() const { return lit_; }
    Point moment() const { return moment_; }

private:
    double error() const { return error_ + 0x1p-40 * whole_; }  // the sums of areas round, too

    void push(const Polygon& polygon, std::size_t met) {
        const double area = polygon.count < 3 ? 0 : polygon.area();
        if (!(area > 0)) return;
        if (polygon.count <= Polygon::MOST / 2) {
            open_.push_back({polygon, area, {}, met});
            for (unsigned i = 0; i < polygon.count; ++i) open_.back().box.add(polygon.corner[i]);
            std::push_heap(open_.begin(), open_.end());
            undecided_ += area;
            return;
        }
        Polygon first, second;
        const unsigned half = polygon.count / 2;
        for (unsigned i = 0; i <= half; ++i) first.add(polygon.corner[i]);
        for (unsigned i = half; i < polygon.count; ++i) second.add(polygon.corner[i]);
        second.add(polygon.corner[0]);
        push(first, met);
        push(second, met);
    }

    static bool is_apart(const Piece& piece, const Shadow& shadow) {
        if (piece.box.is_apart(shadow.box)) return true;
        for (unsigned i = 0; i < 3; ++i)
            if (Distances(piece.polygon, shadow.corner[i], shadow.left[i]).largest < -CERTAIN) return true;
        return false;
    }

    void subtract(const Piece& piece) {
        const Shadow& shadow = shadows_[piece.met];
        std::array<Polygon, 3> outside;
        Polygon inside = piece.polygon;
        bool is_certain = true;
        for (unsigned i = 0; i < 3; ++i) {
            const Distances distance(inside, shadow.corner[i], shadow.left[i]);
            if (distance.least >= CERTAIN) continue;
            is_certain = false;
            Polygon left;
            cut(inside, distance, &left, &outside[i]);
            inside = left;
        }
        if (is_certain) return;  // wholly dark
        is_cut_ = true;
        const double wrong = ERROR * piece.polygon.border();
        error_ += wrong;
        const double dark = inside.count < 3 ? 0 : inside.area();
        if (dark <= wrong) {  // of no use as a cut
            error_ += dark;
            push(piece.polygon, piece.met + 1);
            return;
        }
        for (const Polygon& part : outside) push(part, piece.met + 1);
    }

    const std::vector<Shadow>& shadows_;
    std::vector<Piece> open_;  // a heap, the largest piece in front
    double whole_, error_of_whole_, undecided_ = 0, lit_ = 0, error_ = 0;
    Point moment_{0, 0};
    bool is_cut_ = false;
};

}  // namespace gnomon::python
