// SPDX-License-Identifier: MIT
// Technique shadow-volumes: stencil shadow volumes without a stencil buffer (kernels/techniques/shadow_volumes.h).
#pragma once

#include "api/inputs.hpp"
#include "api/settings_table.hpp"
#include "kernels/techniques/shadow_volumes.h"

namespace gnomon {

class ShadowVolumes final : public Technique {
public:
    explicit ShadowVolumes(const Device& device) : device_(device) {}
    /// Throws InvalidArgument unless the points are a picture's (Points::set_camera): volumes are counted along the
    /// rays of pixels.
    Statistics run(const Triangles& triangles, const Points& points, const Light& light,
                   const Visibility& visibility) override;
    void set(std::string_view name, std::string_view value) override {
        settings_table().set(settings_, "shadow-volumes", name, value);
    }

    static TechniqueDescription describe();

private:
    struct Settings {
        bool cancel, both_faces, z_fail;
    };
    static const SettingsTable<Settings>& settings_table();
    VolumeParams params_of(const TriangleInputs& triangles, const Points& points, const Light& light) const;
    cl_uint make_sides(VolumeParams params, cl_mem vertices);
    void reserve_sides(cl_uint count);
    void draw(VolumeParams params, const PointInputs& points, cl_uint side_count);

    Device device_;
    Settings settings_ = settings_table().defaults();

    std::uint64_t kept_bytes_ = 0;  ///< of the buffers below, kept from run to run
    cl::Buffer counters_, slot_edges_, slot_weights_, cursor_, sides_;
    cl::Buffer tile_depths_, tile_counts_, pixel_counts_, pairs_;
    cl_uint side_capacity_ = 0;
};

}  // namespace gnomon
