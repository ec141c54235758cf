// SPDX-License-Identifier: MIT
// Stage classify_footprints: tests footprints, regions of points on one receiver, against the map and the triangles of
// their bins' lists (kernels/receivers/footprint.h, kernels/samples/classify_footprints.cl); and the samples of those
// that are mixed.
#pragma once

#include "prepared/prepared_runs.hpp"

namespace gnomon {

/// Footprints of samples that one camera made.
struct Footprints {
    const Points& centres;      ///< with receivers and the camera's eye
    const cl::Buffer& buffer;   ///< kernels/receivers/footprint.h
    std::size_t expected;       ///< about as many as there are, and the same number in each run
    const Visibility& classes;  ///< receives one value per footprint
};

/// Decides footprints and samples for the triangles and the light that it was made for. run_samples() makes one for
/// each run.
class FootprintSession {
public:
    virtual ~FootprintSession() = default;
    /// Writes 0 for each footprint whose points are all in shadow, 1 if all are lit, else VISIBILITY_MIXED.
    virtual Statistics classify(const Footprints& footprints) = 0;
    /// The same for footprints within mixed ones of the last classify(), whose class is VISIBILITY_OPEN: others need
    /// not be classified again.
    virtual Statistics classify_parts(const Footprints& footprints) = 0;
    /// As Technique::run(), for samples of mixed footprints of the last classify(). Their visibility is
    /// VISIBILITY_OPEN.
    virtual Statistics trace(const Points& samples, const Visibility& visibility) = 0;
};

/// A session by the lists of a tracer, or of a prepared light. Nothing else may use the tracer meanwhile.
class TracedFootprints final : public FootprintSession {
public:
    TracedFootprints(FrustumTracer& tracer, PreparedRuns& prepared, const Triangles& triangles, const Light& light)
        : tracer_(tracer),
          prepared_(prepared),
          triangles_(triangles),
          light_(light),
          is_prepared_(prepared.serves(triangles, light)) {}
    Statistics classify(const Footprints& footprints) override;
    Statistics classify_parts(const Footprints& footprints) override;
    Statistics trace(const Points& samples, const Visibility& visibility) override;

private:
    /// The lists that classified all footprints: of the tracer's one frame, or of the prepared light.
    struct Lists {
        LightFrame light_frame;
        const cl::Buffer* map;
    };
    void classify_frames(const FramedInputs& in, TracedRun& run);
    void classify_prepared(const FramedInputs& in, TracedRun& run);
    Statistics run_on_lists(const PointInputs& points, const Visibility& visibility, const TracePlan& plan);
    TracePlan plan_of_classes();

    FrustumTracer& tracer_;
    PreparedRuns& prepared_;
    const Triangles& triangles_;
    const Light& light_;
    bool is_prepared_;
    std::optional<Lists> lists_;  ///< none: the footprints lay in several frames, so each frame made lists of its own
};

}  // namespace gnomon
