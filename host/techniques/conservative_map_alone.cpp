// SPDX-License-Identifier: MIT
// Technique conservative-map: the exact pipeline up to its conservative map, without the later stages: a lower bound of
// the shadow (kernels/techniques/conservative_map_alone.cl).
#include "occluders/triangle_setup.hpp"
#include "techniques/framed_technique.hpp"

namespace gnomon {
namespace {

class ConservativeMapAlone final : public FramedTechnique {
public:
    explicit ConservativeMapAlone(const Device& device) : FramedTechnique(device, describe()) {}

    static TechniqueDescription describe() {
        return {"conservative-map",
                "conservative shadow map (Mizoguchi and Tokuyoshi): never wrongly dark, lit wherever it proves nothing",
                false, settings({"cover-test", "map-size"})};
    }

private:
    /// False if the lists of triangles were too short; the lists are longer now.
    bool list_triangles(Run& run) {
        cl::Session& session = device_.session();
        cl::StageTimer timer(session, run.statistics, "triangle_setup");
        session.fill(counters_, 0, sizeof(FrameCounters));
        const cl::Buffer& pyramid = receiver_depth_pyramid_.pyramid();
        setup_.run_bounds(session, frames_.projection(), run.triangles, nullptr, &pyramid, counters_);
        setup_.run_map_tiles(session, frames_.projection(), run.triangles, pyramid, counters_);
        return setup_.fitted(session, session.read_value<FrameCounters>(counters_));
    }

    FrameCounters run_frame(Run& run, cl_uint frame) override {
        cl::Session& session = device_.session();
        make_receiver_depths(run, frame);
        while (!list_triangles(run)) ++run.grown;
        cl::StageTimer timer(session, run.statistics, "conservative_map");
        map_.run(session, run.light_frame, frames_.projection(), setup_, receiver_depth_pyramid_.pyramid(),
                 settings_.cover_test, counters_);
        timer.next("lookup");
        session.launch("techniques/conservative_map_alone.cl", "conservative_map_lookup",
                       cl::Range::items(run.points.layout.count / session.lanes() + 1), params_of(run, frame),
                       frames_.projection(), run.points.positions, map_.map(), run.visibility, counters_);
        return session.read_value<FrameCounters>(counters_);
    }

    decltype(Statistics::counts) counts_of(Run& run) const override {
        return {{"points_decided_by_map", run.counted.decided_by_map},
                {"map_candidates", run.counted.map_candidates},
                {"map_texels_written", run.counted.map_texels}};
    }

    TriangleSetup setup_;
    ConservativeMap map_;
};

}  // namespace

Registered conservative_map_technique() { return registered<ConservativeMapAlone>(); }

}  // namespace gnomon
