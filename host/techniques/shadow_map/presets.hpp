// SPDX-License-Identifier: MIT
// Named compositions of the shadow-map family: a line each, registered as techniques of their own.
#pragma once

#include <gnomon.hpp>

namespace gnomon {

struct ShadowMapPreset {
    std::string_view name;
    std::string_view summary;   ///< with authors and year
    std::string_view settings;  ///< "key=value key=value": on top of technique shadow-map's defaults
};
std::span<const ShadowMapPreset> shadow_map_presets();

/// The description of technique shadow-map with the preset's name, summary and defaults.
TechniqueDescription describe(const ShadowMapPreset& preset);
std::unique_ptr<Technique> make(const ShadowMapPreset& preset, const Device& device);

}  // namespace gnomon
