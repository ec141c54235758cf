// SPDX-License-Identifier: MIT
// Stage height_field: the grid and the pyramid over triangles that are a height field
// (kernels/horizons/height_field.h).
#pragma once

#include <vector>

#include "kernels/horizons/height_field.h"
#include "lists/morton.hpp"
#include "query/inputs.hpp"

namespace gnomon {

class BuiltHeightField {
public:
    BuiltHeightField(const Device& device, const Triangles& triangles);

    /// True if the triangles are a height field and none of them is masked. If false, the other members are empty.
    bool is_field() const { return !levels_.empty(); }
    const Triangles& triangles() const { return triangles_; }
    const HeightField& field() const { return field_; }
    const std::vector<FieldLevel>& levels() const { return levels_; }
    const cl::Buffer& pyramid() const { return pyramid_; }
    /// The triangles of cell c: list()[starts()[c]] to list()[starts()[c + 1] - 1].
    const cl::Buffer& starts() const { return starts_; }
    const cl::Buffer& list() const { return list_; }

private:
    bool find_axis(const CoordinateBounds& box);
    bool set_grid(const CoordinateBounds& box);
    bool make_lists();
    bool find_inside();
    bool is_covered_once() const;
    void make_pyramid();
    cl::Range each_triangle() const { return cl::Range::items(field_.triangles.count); }
    std::size_t cell_count() const { return std::size_t(field_.columns) * field_.rows; }

    Device device_;
    Triangles triangles_;  ///< its clusters, if it has some, live as long as the field
    HeightField field_{};
    std::vector<FieldLevel> levels_;
    cl::Buffer starts_, list_, pyramid_;
};

}  // namespace gnomon
