// SPDX-License-Identifier: MIT
// Stage izb: the points that still need an answer after the coarse test, listed by bin of light space
// (kernels/techniques/izb.cl); for the traversal of triangles over lists of points.
#pragma once

#include "lists/scan.hpp"
#include "occluders/triangle_setup.hpp"
#include "receivers/light_frame.hpp"

namespace gnomon {

class Izb {
public:
    /// Of frame `frame`, whose projection and map these are, once its triangles are listed. `map` may be null: no
    /// coarse test.
    void run(cl::Session& session, const LightFrame& light_frame, cl_uint frame, const PointInputs& points,
             const cl::Buffer& projection, const cl::Buffer* map, cl_mem visibility, const cl::Buffer& counters);

    const cl::Buffer& offsets() const { return offsets_; }
    const cl::Buffer& x() const { return x_; }
    const cl::Buffer& y() const { return y_; }
    const cl::Buffer& z() const { return z_; }
    const cl::Buffer& order() const { return order_; }

private:
    Scan scan_;
    cl::Buffer cursors_, offsets_, x_, y_, z_, order_;
};

}  // namespace gnomon
