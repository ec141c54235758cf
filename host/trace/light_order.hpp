// SPDX-License-Identifier: MIT
// Stage light_order: points that come in no order are sorted in the light's plane before a run
// (kernels/trace/light_order.h).
#pragma once

#include "kernels/trace/light_order.h"
#include "lists/sort.hpp"
#include "query/inputs.hpp"
#include "query/statistics.hpp"

namespace gnomon {

enum class SortPoints { on, off, automatic };

class LightOrder {
public:
    /// The same points in the light's order, or no value if they stay as they are: there are few, or they are in order
    /// already, or memory is short (automatic), or they have no extent. Their run writes visibility(); scatter() then
    /// puts it in the given order.
    std::optional<PointInputs> sort(cl::Session& session, Statistics& statistics, SortPoints choice,
                                    const LightFrame& light_frame, const PointInputs& points);
    cl_mem visibility() const { return visibility_.get(); }
    void scatter(cl::Session& session, Statistics& statistics, std::size_t count, cl_mem visibility) const;

private:
    PointInputs sorted(cl::Session& session, const LightOrderParams& params, const PointInputs& points);

    Sort sort_;
    cl::Buffer boxes_, codes_, numbers_, positions_, receivers_, visibility_;
};

}  // namespace gnomon
