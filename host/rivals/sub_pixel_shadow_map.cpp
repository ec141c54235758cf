// SPDX-License-Identifier: MIT
// Technique sub-pixel: a shadow map of triangles instead of depths (kernels/rivals/sub_pixel_shadow_map.h).
#include "kernels/rivals/sub_pixel_shadow_map.h"

#include "rivals/framed_technique.hpp"

namespace gnomon {
namespace {

class SubPixelShadowMap final : public FramedTechnique {
public:
    explicit SubPixelShadowMap(const Device& device) : FramedTechnique(device, describe()) {}

    static TechniqueDescription describe() {
        return {"sub-pixel",
                "map of triangles, which lookups test exactly (Dai, Yang and Feng 2008; sub-pixel shadow maps without "
                "their "
                "reconstruction of edges)",
                false, settings({"neighbours", "map-size"})};
    }

private:
    FrameGrid grid() const override { return texel_grid(settings_.map_size); }

    FrameCounters run_frame(Run& run, cl_uint frame) override {
        list_triangles(run, false);
        const SubPixelParams params{.framed = params_of(run, frame),
                                    .reach = settings_.neighbours,
                                    .tile_capacity = setup_.tiles().capacity(),
                                    .stores_ids = 0,
                                    .padding = 0};
        cl::StageTimer timer(session_, run.statistics, "sub_pixel_draw");
        const std::size_t bytes = std::size_t(run.light_frame.width) * run.light_frame.height * sizeof(cl_uint);
        session_.reserve_filled(heights_, 0, bytes);
        session_.reserve_filled(ids_, GN_NO_ID, bytes);
        for (SubPixelParams drawn = params; drawn.stores_ids < 2; ++drawn.stores_ids)
            session_.launch(run.triangles.kernel("rivals/sub_pixel_shadow_map.cl", "sub_pixel_draw"),
                            cl::Range::items(params.tile_capacity), drawn, frames_.projection(), setup_.records(),
                            setup_.bounds(), setup_.tiles().buffer(), run.triangles.vertices, heights_, ids_,
                            counters_);
        timer.next("sub_pixel_lookup");
        session_.launch(run.triangles.kernel("rivals/sub_pixel_shadow_map.cl", "sub_pixel_lookup"),
                        session_.blocks(run.points.layout.count), params, frames_.projection(), run.points.positions,
                        run.points.receivers, run.triangles.vertices, ids_, run.visibility, counters_);
        return session_.read_value<FrameCounters>(counters_);
    }

    decltype(Statistics::counts) counts_of(Run& run) const override {
        return {{"texels", run.frames * run.light_frame.width * run.light_frame.height},
                {"texels_with_triangle", run.counted.map_texels}};
    }

    cl::Buffer heights_, ids_;  ///< per texel
};

}  // namespace

Registered sub_pixel_technique() { return registered<SubPixelShadowMap>(); }

}  // namespace gnomon
