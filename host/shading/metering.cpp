// SPDX-License-Identifier: MIT
// Stage metering: the exposure that a picture's light asks for (kernels/shading/metering.h).
#include "kernels/shading/metering.h"

#include <algorithm>
#include <bit>
#include <cmath>

#include "shading/surface.hpp"

namespace gnomon {
namespace {

/// The light that the metered part of the surfaces' pixels does not exceed.
constexpr double metered_light = 0.8, max_metered_ev = 8;

}  // namespace

double metered_ev(cl::Session& session, SurfaceBuffers& buffers, std::size_t pixels) {
    constexpr const char* file = "shading/metering.cl";
    buffers.meter.reserve(session, sizeof(Meter));
    session.reserve_filled(buffers.meter_counts, 0, METER_DIGITS * sizeof(cl_uint));
    for (cl_uint pass = 0; pass < METER_PASSES; ++pass) {
        session.launch(file, "meter_count", cl::Range::items(pixels), pass, cl_uint(pixels), buffers.brightest,
                       buffers.meter, buffers.meter_counts, cl::LocalBytes{METER_DIGITS * sizeof(cl_uint)});
        session.launch(file, "meter_choose", cl::Range::groups(1), pass, buffers.meter_counts, buffers.meter,
                       cl::LocalBytes{session.work_group_size() * sizeof(cl_uint)});
    }
    const auto meter = session.read_value<Meter>(buffers.meter);
    const double light = std::bit_cast<float>(meter.chosen);
    if (meter.count == 0 || !(light > 0)) return 0;
    return std::clamp(std::log2(metered_light / light), -max_metered_ev, max_metered_ev);
}

}  // namespace gnomon
