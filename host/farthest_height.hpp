// SPDX-License-Identifier: MIT
// Stage farthest_height: per bin the height of the point farthest from the light, and a pyramid of minima
// (kernels/farthest_height.cl).
#pragma once

#include "light_frame.hpp"

namespace gnomon {

class FarthestHeight {
public:
    void run(cl::Session& session, const LightFrame& frame, const PointInputs& points, const cl::Buffer& projection,
             cl_mem visibility);
    const cl::Buffer& pyramid() const { return pyramid_; }

private:
    cl::Buffer pyramid_;
};

}  // namespace gnomon
