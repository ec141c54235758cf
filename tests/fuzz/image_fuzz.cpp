// SPDX-License-Identifier: MIT
// Fuzz target: the bytes are an image file of a scene. Whatever they are, decoding ends with as many texels as the
// image says that it has, the same alpha both ways, or with an Error.
#include <cstddef>
#include <cstdint>
#include <optional>

#include <gnomon.hpp>
#include "decoded_image.hpp"
#include "require.hpp"

#ifdef __SANITIZE_ADDRESS__
#define HAS_SANITIZER 1
#elif defined(__has_feature)
#if __has_feature(address_sanitizer)
#define HAS_SANITIZER 1
#endif
#endif
#ifdef HAS_SANITIZER
#include <sanitizer/lsan_interface.h>
#endif

namespace {

using fuzz::require;

constexpr std::uint64_t max_bytes = 16 << 20;

template <typename Decode>
auto decoded(const Decode& decode) -> std::optional<decltype(decode())> {
#ifdef HAS_SANITIZER
    // OpenImageIO 2.4 loses a string where libpng jumps out of its reading callback: 31 bytes per broken PNG.
    const __lsan::ScopedDisabler disabled;
#endif
    try {
        return decode();
    } catch (const gnomon::Error& error) {
        require(*error.what() != '\0', "a reason");
        return std::nullopt;
    }
}

}  // namespace

extern "C" int LLVMFuzzerTestOneInput(const std::uint8_t* data, std::size_t size);
extern "C" int LLVMFuzzerTestOneInput(const std::uint8_t* data, std::size_t size) {
    const auto colors = decoded([&] { return gnomon::app::read_colors({data, size}, max_bytes); });
    if (!colors) return 0;  // what is too large for max_bytes takes long to decode, and may be a valid image
    const std::size_t texels = std::size_t(colors->width) * colors->height;
    require(texels != 0 && 4 * texels <= max_bytes, "a size within its bounds");
    require(colors->rgba.size() == 4 * texels, "four bytes for each texel");
    const auto alpha = decoded([&] { return gnomon::app::read_alpha({data, size}); });
    require(alpha && alpha->width == colors->width && alpha->height == colors->height, "the same size both ways");
    require(alpha->alpha.size() == texels, "an alpha for each texel");
    for (std::size_t i = 0; i < texels; ++i) require(alpha->alpha[i] == colors->rgba[4 * i + 3], "the same alpha");
    return 0;
}
