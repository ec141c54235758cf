// SPDX-License-Identifier: MIT
// Technique sub-pixel: a shadow map of triangles instead of depths (kernels/techniques/sub_pixel_shadow_map.h).
#pragma once

#include "api/settings_table.hpp"
#include "kernels/techniques/sub_pixel_shadow_map.h"
#include "techniques/framed_technique.hpp"

namespace gnomon {

class SubPixelShadowMap final : public FramedTechnique {
public:
    explicit SubPixelShadowMap(const Device& device) : FramedTechnique(device) {}
    void set(std::string_view name, std::string_view value) override {
        settings_table().set(settings_, "sub-pixel", name, value);
    }

    static TechniqueDescription describe();

private:
    struct Settings {
        bool neighbours;
        std::uint32_t map_size;
    };
    static const SettingsTable<Settings>& settings_table();
    FrameGrid grid() const override { return texel_grid(settings_.map_size); }
    void run_frame(Run& run, cl_uint frame) override;
    void begin_counts() override;
    void add_counts(Run& run) const override;
    /// False if the lists of triangles were too short; the lists are longer now.
    bool list_triangles(Run& run);
    void draw(Run& run);
    void decide_points(Run& run, cl_uint frame);

    Settings settings_ = settings_table().defaults();

    std::uint64_t texels_ = 0, texels_with_triangle_ = 0;  ///< in this run
    cl::Buffer map_counters_;
    cl::Buffer heights_, ids_;  ///< per texel
};

}  // namespace gnomon
