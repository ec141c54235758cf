// SPDX-License-Identifier: MIT
#include "alpha_image.hpp"

#include <OpenImageIO/filesystem.h>
#include <OpenImageIO/imageio.h>

#include <cmath>
#include <cstring>
#include <string>
#include <string_view>

#include <gnomon.hpp>

namespace gnomon::app {
namespace {

constexpr int largest_side = 32768;
constexpr std::uint64_t most_texels = std::uint64_t(1) << 28;  ///< a row of bytes each: what a crafted header may take

/// The format that the first bytes tell: what a file says of itself may be wrong.
const char* format_of(std::span<const unsigned char> bytes) {
    const std::string_view text(reinterpret_cast<const char*>(bytes.data()), std::min<std::size_t>(bytes.size(), 16));
    if (text.starts_with("\x89PNG")) return "png";
    if (text.starts_with("\xFF\xD8")) return "jpeg";
    if (text.starts_with("RIFF") && text.substr(std::min<std::size_t>(8, text.size())).starts_with("WEBP"))
        return "webp";
    return nullptr;
}

std::uint8_t rounded(std::uint16_t value) { return std::uint8_t((std::uint32_t(value) * 255u + 32767u) / 65535u); }

}  // namespace

AlphaImage read_alpha(std::span<const unsigned char> bytes) {
    const char* const name = format_of(bytes);
    if (name == nullptr) throw Error("it is no PNG, JPEG or WebP file");
    OIIO::Filesystem::IOMemReader memory(const_cast<unsigned char*>(bytes.data()), bytes.size());
    OIIO::ImageSpec config;
    config.attribute("oiio:UnassociatedAlpha", 1);
    const auto input = OIIO::ImageInput::create(name);
    if (!input || !input->supports("ioproxy"))
        throw Error("this OpenImageIO cannot read " + std::string(name) + " files");
    OIIO::ImageSpec spec;
    if (!input->set_ioproxy(&memory) || !input->open(std::string("image.") + name, spec, config))
        throw Error(input->geterror());
    if (spec.width < 1 || spec.height < 1 || spec.width > largest_side || spec.height > largest_side ||
        std::uint64_t(spec.width) * std::uint64_t(spec.height) > most_texels)
        throw Error("its " + std::to_string(spec.width) + "x" + std::to_string(spec.height) +
                    " texels are more than 2^28, or than 32768 on a side");
    const std::size_t texels = std::size_t(spec.width) * std::size_t(spec.height);
    AlphaImage image{std::uint32_t(spec.width), std::uint32_t(spec.height), std::vector<std::uint8_t>(texels, 255)};
    if (spec.alpha_channel < 0) return image;
    const int channel = spec.alpha_channel;
    if (spec.format == OIIO::TypeUInt8) {
        if (!input->read_image(0, 0, channel, channel + 1, OIIO::TypeUInt8, image.alpha.data()))
            throw Error(input->geterror());
        return image;
    }
    std::vector<std::uint16_t> wide(texels);
    if (!input->read_image(0, 0, channel, channel + 1, OIIO::TypeUInt16, wide.data())) throw Error(input->geterror());
    for (std::size_t i = 0; i < texels; ++i) image.alpha[i] = rounded(wide[i]);
    return image;
}

}  // namespace gnomon::app
