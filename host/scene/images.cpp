// SPDX-License-Identifier: MIT
#include "images.hpp"

#include "materials.hpp"

namespace gnomon::scene {

Images::Images(const std::filesystem::path& file, const tinygltf::Model& model,
               const std::map<int, ImageSource>& sources, const LoadOptions& options, std::uint64_t memory_bytes)
    : file_(file),
      model_(model),
      sources_(sources),
      decode_alpha_(options.decode_alpha),
      decode_colors_(options.decode_colors),
      bytes_left_(memory_bytes) {}

std::uint32_t Images::colors(int image) {
    if (const auto found = index_of_.find(image); found != index_of_.end()) return found->second;
    if (const auto found = failures_.find(image); found != failures_.end()) throw Error(found->second);
    try {
        images_->push_back(decode_colors_(image_bytes(file_, model_, sources_.at(image)), bytes_left_));
    } catch (const std::bad_alloc&) {
        throw Error(failures_[image] = "it does not fit into this machine's memory");
    } catch (const std::exception& error) {
        throw Error(failures_[image] = error.what());
    }
    bytes_left_ -= std::min<std::uint64_t>(bytes_left_, images_->back().rgba.size());
    return index_of_[image] = std::uint32_t(images_->size() - 1);
}

SceneCutOuts::Texture Images::alpha(int image) {
    if (!decode_colors_) return decode_alpha_(image_bytes(file_, model_, sources_.at(image)));
    const ColorImage& from = (*images_)[colors(image)];
    SceneCutOuts::Texture texture{from.width, from.height, std::vector<std::uint8_t>(from.rgba.size() / 4)};
    for (std::size_t i = 0; i < texture.alpha.size(); ++i) texture.alpha[i] = from.rgba[4 * i + 3];
    return texture;
}

}  // namespace gnomon::scene
