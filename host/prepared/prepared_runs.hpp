// SPDX-License-Identifier: MIT
// Runs over one light, under a prepared light where one was prepared for the same triangles and light.
#pragma once

#include "prepared/prepared_light.hpp"
#include "trace/frustum_tracer.hpp"

namespace gnomon {

class PreparedRuns {
public:
    explicit PreparedRuns(FrustumTracer& tracer) : tracer_(tracer) {}

    /// Prepares a light, where none is prepared. There must be triangles.
    Statistics prepare(const Triangles& triangles, const Light& light);
    void release() { light_.reset(); }

    Statistics run(const Triangles& triangles, const PointInputs& points, const Light& light, cl_mem visibility);
    /// Whether the prepared light is of these, and its grid can separate the triangles.
    bool serves(const Triangles& triangles, const Light& light) const {
        return light_ && light_->is_usable() && light_->is_of(triangles, light);
    }
    /// The lists of the prepared light.
    TraceInputs inputs(const FramedInputs& in) const;

private:
    bool decide(const FramedInputs& in, TracedRun& run);

    FrustumTracer& tracer_;
    std::unique_ptr<PreparedLight> light_;
};

}  // namespace gnomon
