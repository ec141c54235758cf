// SPDX-License-Identifier: MIT
// Technique conservative-map: the exact pipeline up to its conservative map, without the later stages: a lower bound of
// the shadow (kernels/rivals/conservative_map_alone.cl).
#include "rivals/framed_technique.hpp"

namespace gnomon {
namespace {

class ConservativeMapAlone final : public FramedTechnique {
public:
    explicit ConservativeMapAlone(const Device& device) : FramedTechnique(device, describe()) {}

    static TechniqueDescription describe() {
        return {"conservative-map",
                "conservative shadow map (Mizokuchi and Tokuyoshi): never wrongly dark, lit wherever it proves nothing",
                false, settings({"cover-test", "map-size"})};
    }

private:
    FrameCounters run_frame(Run& run, cl_uint frame) override {
        frames_.reduce_depths(session_, run.statistics, run, frame);
        list_triangles(run, true);
        cl::StageTimer timer(session_, run.statistics, "conservative_map");
        map_.run(session_, run.light_frame, frames_.projection(), setup_, frames_.receiver_depths().pyramid(),
                 settings_.cover_test, counters_);
        timer.next("lookup");
        session_.launch("rivals/conservative_map_alone.cl", "conservative_map_lookup",
                        session_.blocks(run.points.layout.count), params_of(run, frame), frames_.projection(),
                        run.points.positions, map_.map(), run.visibility, counters_);
        return session_.read_value<FrameCounters>(counters_);
    }

    decltype(Statistics::counts) counts_of(Run& run) const override {
        return {{"points_decided_by_map", run.counted.decided_by_map},
                {"map_candidates", run.counted.map_candidates},
                {"map_texels_written", run.counted.map_texels}};
    }

    ConservativeMap map_;
};

}  // namespace

Registered conservative_map_technique() { return registered<ConservativeMapAlone>(); }

}  // namespace gnomon
