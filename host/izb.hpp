// SPDX-License-Identifier: MIT
// Stage izb: the points that still need an answer, listed by bin of light space; the coarse test by the conservative
// map is inside (kernels/izb.cl).
#pragma once

#include "light_frame.hpp"
#include "scan.hpp"
#include "triangle_setup.hpp"

namespace gnomon {

class Izb {
public:
    /// `map` may be null: no coarse test.
    void run(cl::Session& session, const LightFrame& frame, const TriangleInputs& triangles, const PointInputs& points,
             const cl::Buffer& projection, const cl::Buffer* map, cl_mem visibility, const cl::Buffer& counters);

    const cl::Buffer& farthest() const { return farthest_; }  ///< per bin, as a key; 0xFFFFFFFF where nothing is listed
    const cl::Buffer& offsets() const { return offsets_; }
    const cl::Buffer& x() const { return x_; }
    const cl::Buffer& y() const { return y_; }
    const cl::Buffer& z() const { return z_; }
    const cl::Buffer& order() const { return order_; }
    const cl::Buffer& block_bin() const { return block_bin_; }

private:
    Scan scan_;
    cl::Buffer cursors_, offsets_, farthest_, x_, y_, z_, order_, block_bin_;
};

}  // namespace gnomon
