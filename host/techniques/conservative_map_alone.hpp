// SPDX-License-Identifier: MIT
// Technique conservative-map: the exact pipeline up to its conservative map, without the later stages: a lower bound of
// the shadow (kernels/occluders/conservative_map_alone.cl).
#pragma once

#include "api/settings_table.hpp"
#include "occluders/conservative_map.hpp"
#include "receivers/receiver_depth_pyramid.hpp"
#include "techniques/framed_technique.hpp"

namespace gnomon {

class ConservativeMapAlone final : public FramedTechnique {
public:
    explicit ConservativeMapAlone(const Device& device) : FramedTechnique(device) {}
    void set(std::string_view name, std::string_view value) override {
        settings_table().set(settings_, "conservative-map", name, value);
    }

    static TechniqueDescription describe();

private:
    struct Settings {
        CoverTest cover_test;
        std::uint32_t map_size;
    };
    static const SettingsTable<Settings>& settings_table();
    FrameGrid grid() const override { return map_grid(device_.session(), settings_.map_size); }
    void run_frame(Run& run, cl_uint frame) override;
    void begin_counts() override { map_candidates_ = map_texels_ = 0; }
    void add_counts(Run& run) const override;
    /// False if the lists of triangles were too short; the lists are longer now.
    bool list_triangles(Run& run);

    Settings settings_ = settings_table().defaults();

    std::uint64_t map_candidates_ = 0, map_texels_ = 0;  ///< in this run
    ReceiverDepthPyramid receiver_depth_pyramid_;
    ConservativeMap map_;
};

}  // namespace gnomon
