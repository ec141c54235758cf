// SPDX-License-Identifier: MIT
// The images of a glTF file, each decoded once, for its alpha, its colours, or both.
#pragma once

#include <map>
#include <memory>
#include <string>

#include "gltf.hpp"
#include "scene.hpp"

namespace gnomon::scene {

class Images {
public:
    /// The references must live as long as this.
    Images(const std::filesystem::path& file, const tinygltf::Model& model, const std::map<int, ImageSource>& sources,
           const LoadOptions& options, std::uint64_t memory_bytes);

    bool has_alpha() const { return bool(decode_alpha_); }
    bool has_colors() const { return bool(decode_colors_); }
    /// The alpha of an image of the file. Throws an exception that says why it cannot be read.
    SceneCutOuts::Texture alpha(int image);
    /// The index of its colours among all(). Throws as alpha().
    std::uint32_t colors(int image);
    std::shared_ptr<const std::vector<ColorImage>> all() const { return images_; }

private:
    const std::filesystem::path& file_;
    const tinygltf::Model& model_;
    const std::map<int, ImageSource>& sources_;
    AlphaDecoder decode_alpha_;
    ColorDecoder decode_colors_;
    std::uint64_t bytes_left_;
    std::shared_ptr<std::vector<ColorImage>> images_ = std::make_shared<std::vector<ColorImage>>();
    std::map<int, std::uint32_t> index_of_;
    std::map<int, std::string> failures_;
};

}  // namespace gnomon::scene
