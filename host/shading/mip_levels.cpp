// SPDX-License-Identifier: MIT
// Stage mip_levels: uploads colour textures, and makes their levels (kernels/shading/mip_levels.h).
#include <algorithm>
#include <optional>

#include "shading/surface.hpp"

namespace gnomon {
namespace {

constexpr const char* file = "shading/mip_levels.cl";

std::uint32_t side_of_level(std::uint32_t side, std::uint32_t level) { return std::max(1u, side >> level); }

/// Makes levels by kernels. Its buffers serve one texture after the other.
class LevelMaker {
public:
    /// Throws OutOfDeviceMemory if there is no room for the lights of a first level of so many texels.
    LevelMaker(cl::Session& session, std::size_t max_texels)
        : session_(session),
          tables_(session, sizeof(MipTables)),
          lights_{cl::Buffer(session, max_texels * sizeof(float4)),
                  cl::Buffer(session, max_texels / 2 * sizeof(float4))} {
        const MipTables tables = mip_tables();
        session.write(tables_.get(), &tables, sizeof(tables));
        taps_.reserve(session, 0);
    }

    /// The texture's levels, from texel `first` of `texels` on.
    void make(const ColorTexture& from, bool weighs_alpha, std::uint64_t first, const cl::Buffer& texels) {
        const std::uint64_t count = std::uint64_t(from.width) * from.height;
        session_.write(texels.get(), from.rgba.data(), from.rgba.size(), first * 4);
        session_.launch(file, "mip_weights", cl::Range::items(count), cl_ulong(first), cl_ulong(count),
                        cl_uint(weighs_alpha), texels);
        MipParams level{};
        level.first_texel = first;
        level.width = from.width;
        level.height = from.height;
        for (std::uint32_t i = 0; level.width > 1 || level.height > 1; ++i) {
            step(level);
            session_.launch(file, "mip_level", cl::Range::items(std::size_t(level.width) * level.height), level,
                            cl_uint(i == 0), tables_, taps_, lights_[(i + 1) % 2], texels, lights_[i % 2]);
        }
    }

private:
    /// To the level after `level`, with its taps.
    void step(MipParams& level) {
        level.first_texel_before = level.first_texel;
        level.first_texel += std::uint64_t(level.width) * level.height;
        level.width_before = level.width;
        level.height_before = level.height;
        level.width = side_of_level(level.width, 1);
        level.height = side_of_level(level.height, 1);
        level.is_even = level.width_before % 2 == 0 && level.height_before % 2 == 0;
        if (level.is_even) return;
        std::vector<MipTaps> taps = taps_of(level.width_before, level.width);
        const std::vector<MipTaps> rows = taps_of(level.height_before, level.height);
        taps.insert(taps.end(), rows.begin(), rows.end());
        session_.upload(taps_, taps);
    }

    cl::Session& session_;
    cl::Buffer tables_, taps_;
    cl::Buffer lights_[2];  ///< of the odd and of the even levels
};

}  // namespace

SurfaceTextures::OnDevice::OnDevice(const Device& on, TextureKeys shown, std::span<const ColorTexture> all,
                                    std::uint32_t max_left_out)
    : device(on), keys(std::move(shown)), sources(sources_of(all)) {
    for (;; ++left_out) try {
            upload(all);
            return;
        } catch (const OutOfDeviceMemory&) {
            if (left_out == max_left_out) throw;
        }
}

std::vector<const std::uint8_t*> SurfaceTextures::OnDevice::sources_of(std::span<const ColorTexture> all) {
    std::vector<const std::uint8_t*> sources;
    for (const ColorTexture& texture : all) sources.push_back(texture.rgba.data());
    return sources;
}

void SurfaceTextures::OnDevice::upload(std::span<const ColorTexture> all) {
    cl::Session& session = session_of(device);
    places.clear();
    std::size_t max_texels = 0;  // of a level that is made
    bytes = 0;
    for (const auto& [which, weighs] : keys) {
        const ColorTexture& from = all[which];
        places.push_back({bytes / 4, side_of_level(from.width, left_out), side_of_level(from.height, left_out)});
        bytes += level_bytes(from.width, from.height, left_out);
        max_texels = std::max(max_texels, std::size_t(side_of_level(from.width, 1)) * side_of_level(from.height, 1));
    }
    texels.reserve(session, bytes);
    std::optional<LevelMaker> maker;
    if (left_out == 0 && !keys.empty()) try {
            maker.emplace(session, max_texels);
        } catch (const OutOfDeviceMemory&) {  // the host makes them
        }
    // One texture at a time on the host.
    std::vector<std::uint8_t> levels;
    for (std::size_t i = 0; i < places.size(); ++i) {
        const auto& [which, weighs] = keys[i];
        const ColorTexture& from = all[which];
        if (maker) {
            maker->make(from, weighs, places[i].first_texel, texels);
            continue;
        }
        levels.resize(level_bytes(from.width, from.height, left_out));
        write_levels(from, weighs, left_out, levels.data());
        session.write(texels.get(), levels.data(), levels.size(), places[i].first_texel * 4);
    }
}

}  // namespace gnomon
