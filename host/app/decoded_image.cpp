// SPDX-License-Identifier: MIT
#include "decoded_image.hpp"

#include <OpenImageIO/filesystem.h>
#include <OpenImageIO/imageio.h>

#include <algorithm>
#include <memory>
#include <string>
#include <string_view>

#include <gnomon.hpp>

namespace gnomon::app {
namespace {

constexpr int largest_side = 32768;
constexpr std::uint64_t max_texels = std::uint64_t(1) << 28;  ///< a row of bytes each: what a crafted header may take

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

/// An image file in memory, whose header is read.
class OpenImage {
public:
    explicit OpenImage(std::span<const unsigned char> bytes)
        : memory_(const_cast<unsigned char*>(bytes.data()), bytes.size()) {
        const char* const name = format_of(bytes);
        if (name == nullptr) throw Error("it is no PNG, JPEG or WebP file");
        OIIO::ImageSpec config;
        config.attribute("oiio:UnassociatedAlpha", 1);
        input_ = OIIO::ImageInput::create(name);
        if (!input_ || !input_->supports("ioproxy"))
            throw Error("this OpenImageIO cannot read " + std::string(name) + " files");
        if (!input_->set_ioproxy(&memory_) || !input_->open(std::string("image.") + name, spec, config))
            throw Error(input_->geterror());
        if (spec.width < 1 || spec.height < 1 || spec.width > largest_side || spec.height > largest_side ||
            std::uint64_t(spec.width) * std::uint64_t(spec.height) > max_texels)
            throw Error("its " + std::to_string(spec.width) + "x" + std::to_string(spec.height) +
                        " texels are more than 2^28, or than 32768 on a side");
    }
    std::size_t texels() const { return std::size_t(spec.width) * std::size_t(spec.height); }
    /// Channels [first, end), 8 bits each; 16 bits are rounded once.
    std::vector<std::uint8_t> channels(int first, int end) {
        std::vector<std::uint8_t> values(texels() * std::size_t(end - first));
        if (spec.format == OIIO::TypeUInt8) {
            read(first, end, OIIO::TypeUInt8, values.data());
            return values;
        }
        std::vector<std::uint16_t> wide(values.size());
        read(first, end, OIIO::TypeUInt16, wide.data());
        std::ranges::transform(wide, values.begin(), rounded);
        return values;
    }

    OIIO::ImageSpec spec;

private:
    void read(int first, int end, OIIO::TypeDesc type, void* to) {
        if (!input_->read_image(0, 0, first, end, type, to)) throw Error(input_->geterror());
    }

    OIIO::Filesystem::IOMemReader memory_;
    std::unique_ptr<OIIO::ImageInput> input_;
};

}  // namespace

AlphaImage read_alpha(std::span<const unsigned char> bytes) {
    OpenImage image(bytes);
    AlphaImage out{std::uint32_t(image.spec.width), std::uint32_t(image.spec.height), {}};
    const int channel = image.spec.alpha_channel;
    out.alpha = channel < 0 ? std::vector<std::uint8_t>(image.texels(), 255) : image.channels(channel, channel + 1);
    return out;
}

RgbaImage read_colors(std::span<const unsigned char> bytes, std::uint64_t max_bytes) {
    OpenImage image(bytes);
    if (std::uint64_t(4) * image.texels() > max_bytes)
        throw Error("its " + std::to_string(image.spec.width) + "x" + std::to_string(image.spec.height) +
                    " texels do not fit into the memory that the scene may take");
    const int count = image.spec.nchannels, alpha = image.spec.alpha_channel;
    const int colors = alpha == 1 || count < 3 ? 1 : 3;  // grey, or red, green and blue
    const std::vector<std::uint8_t> from = image.channels(0, count);
    RgbaImage out{std::uint32_t(image.spec.width), std::uint32_t(image.spec.height), {}};
    out.rgba.resize(4 * image.texels());
    for (std::size_t i = 0; i < image.texels(); ++i) {
        const std::uint8_t* texel = &from[i * std::size_t(count)];
        for (int k = 0; k < 3; ++k) out.rgba[4 * i + std::size_t(k)] = texel[colors == 1 ? 0 : k];
        out.rgba[4 * i + 3] = alpha < 0 ? 255 : texel[alpha];
    }
    return out;
}

}  // namespace gnomon::app
