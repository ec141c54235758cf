// SPDX-License-Identifier: MIT
#include "receivers/light_frame.hpp"

#include <algorithm>

#include "query/vectors.hpp"

namespace gnomon {
namespace {

LightFrame make_frame(const Light& light, const FrameGrid& grid, int axis_z, float sign_z) {
    LightFrame frame{};
    std::copy(light.xyzw.begin(), light.xyzw.end(), frame.light);
    frame.axis_z = static_cast<cl_uint>(axis_z);
    frame.axis_x = (frame.axis_z + 1) % 3;  // x, y, z stay a cyclic order: the grid's handedness is sign_z
    frame.axis_y = (frame.axis_z + 2) % 3;
    frame.sign_z = sign_z;
    frame.width = frame.height = grid.size;
    frame.bin_log2 = grid.bin_log2;
    frame.bins_x = frame.bins_y = grid.bins();
    return frame;
}

LightFrame parallel_frame(const Light& light, const FrameGrid& grid) {
    const auto& d = light.xyzw;
    const int axis = largest_axis(abs(loaded(d.data())));
    LightFrame frame = make_frame(light, grid, axis, d[axis] > 0 ? 1.0f : -1.0f);
    // Quotients in double, rounded once: within u of the real slopes (the bound in projection.h allows 4u).
    frame.shear_x = static_cast<float>(double(d[frame.axis_x]) / double(d[axis]));
    frame.shear_y = static_cast<float>(double(d[frame.axis_y]) / double(d[axis]));
    return frame;
}

}  // namespace

LightFrame make_light_frame(const Light& light, const FrameGrid& grid) {
    if (light.is_directional()) return parallel_frame(light, grid);
    LightFrame frame = make_frame(light, grid, 0, 1.0f);
    frame.perspective = 1;
    return frame;
}

void LightFrameFit::run(cl::Session& session, const LightFrame& light_frame, const cl::Buffer& frame_bounds) {
    projections_.reserve(session, POINT_LIGHT_FRAMES * sizeof(Projection));
    session.launch("receivers/light_frame.cl", "light_frame_fit", cl::Range::groups(1), light_frame, frame_bounds,
                   projections_);
}

}  // namespace gnomon
