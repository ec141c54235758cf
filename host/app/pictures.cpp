// SPDX-License-Identifier: MIT
// PNG and JPEG files by stb_image_write; its deflate is zlib's.
#include "pictures.hpp"

#include <dlfcn.h>
#include <zlib.h>

#include <algorithm>
#include <cmath>
#include <cstdlib>
#include <filesystem>
#include <new>
#include <string>
#include <vector>

#include "openimageio.hpp"

namespace {

/// stb's own deflate makes pictures a third larger, and masks twice as large. stb frees the result.
unsigned char* deflated(unsigned char* bytes, int count, int* deflated_count, int) {
    uLongf size = compressBound(uLong(count));
    auto* const result = static_cast<unsigned char*>(std::malloc(size));
    if (result == nullptr || compress2(result, &size, bytes, uLong(count), Z_DEFAULT_COMPRESSION) != Z_OK) {
        std::free(result);
        return nullptr;
    }
    *deflated_count = int(size);
    return result;
}

}  // namespace

#define STBIW_ZLIB_COMPRESS deflated
#define STBI_WRITE_NO_STDIO
#define STB_IMAGE_WRITE_STATIC
#define STB_IMAGE_WRITE_IMPLEMENTATION
#include <stb/stb_image_write.h>

namespace gnomon::app {
namespace {

/// Whether stb wrote the pixels. It keeps the file in memory, so a failure is one of memory.
void require_memory(int is_written) {
    if (is_written == 0) throw std::bad_alloc();
}

void write_png(OutputFile& file, std::uint32_t width, std::uint32_t height, int channels,
               const std::vector<std::uint8_t>& pixels) {
    const auto write = [](void* to, void* bytes, int count) {
        static_cast<OutputFile*>(to)->write(bytes, std::size_t(count));
    };
    require_memory(stbi_write_png_to_func(write, &file, int(width), int(height), channels, pixels.data(), 0));
    file.check();
}

void append(void* to, void* bytes, int count) {
    static_cast<std::string*>(to)->append(static_cast<const char*>(bytes), std::size_t(count));
}

/// The first three bytes of each pixel.
std::vector<std::uint8_t> rgb_of(std::size_t count, std::span<const std::uint8_t> pixels) {
    const std::size_t pixel_bytes = pixels.size() / count;
    std::vector<std::uint8_t> rgb(3 * count);
    for (std::size_t i = 0; i < count; ++i) std::copy_n(&pixels[pixel_bytes * i], 3, &rgb[3 * i]);
    return rgb;
}

std::string base64_of(std::string bytes) {
    constexpr char digits[] = "ABCDEFGHIJKLMNOPQRSTUVWXYZabcdefghijklmnopqrstuvwxyz0123456789+/";
    const std::size_t padding = (3 - bytes.size() % 3) % 3;
    bytes.append(padding, '\0');
    std::string text;
    for (std::size_t i = 0; i < bytes.size(); i += 3) {
        std::uint32_t bits = 0;
        for (std::size_t k = 0; k < 3; ++k) bits = bits << 8 | std::uint8_t(bytes[i + k]);
        for (int shift = 18; shift >= 0; shift -= 6) text += digits[bits >> shift & 63u];
    }
    return text.replace(text.size() - padding, padding, padding, '=');
}

std::uint8_t mask_value(float visibility) {
    return std::uint8_t(std::lround(255.0f * std::clamp(visibility, 0.0f, 1.0f)));
}

/// Beside the command (build folder), or in ../lib/gnomon (installed).
std::filesystem::path module_path() {
    const std::filesystem::path folder = std::filesystem::read_symlink("/proc/self/exe").parent_path();
    const char* const name = "gnomon_openimageio.so";
    const std::filesystem::path beside = folder / name;
    return std::filesystem::exists(beside) ? beside : folder.parent_path() / "lib" / "gnomon" / name;
}

const OpenImageIo& opened_module() {
    // The module is never closed: its objects may live as long as the program.
    void* const module = ::dlopen(module_path().c_str(), RTLD_NOW | RTLD_LOCAL);
    const void* const found = module != nullptr ? ::dlsym(module, "gnomon_openimageio") : nullptr;
    if (found == nullptr)
        throw Error(std::string("cannot open the module for EXR files and images, which is built and "
                                "installed with the command: ") +
                    ::dlerror());
    return *static_cast<const OpenImageIo*>(found);
}

/// The module, opened at the first call. Throws Error if it is not where it was built or installed.
const OpenImageIo& open_image_io() {
    static const OpenImageIo& module = opened_module();
    return module;
}

}  // namespace

void write_picture(OutputFile& file, std::uint32_t width, std::uint32_t height, std::span<const std::uint8_t> rgba) {
    write_png(file, width, height, 3, rgb_of(std::size_t(width) * height, rgba));
}

void write_mask(OutputFile& file, std::uint32_t width, std::uint32_t height, std::span<const float> visibility) {
    std::vector<std::uint8_t> values(visibility.size());
    std::ranges::transform(visibility, values.begin(), mask_value);
    write_png(file, width, height, 1, values);
}

void write_aov(OutputFile& file, std::uint32_t width, std::uint32_t height, const ViewOnHost& view,
               std::span<const float> values, const char* channel, const AovSurfaces& surfaces) {
    open_image_io().write_aov(file, file.target().string(), "gnomon " + std::string(version()), width, height, view,
                              values, channel, surfaces);
}

std::string png_of(std::uint32_t width, std::uint32_t height, std::span<const std::uint8_t> rgba) {
    std::string file;
    require_memory(stbi_write_png_to_func(append, &file, int(width), int(height), 3,
                                          rgb_of(std::size_t(width) * height, rgba).data(), 0));
    return file;
}

std::string data_uri(const std::string& format, std::uint32_t width, std::uint32_t height,
                     std::span<const std::uint8_t> pixels) {
    if (format == "png") return "data:image/png;base64," + base64_of(png_of(width, height, pixels));
    std::string file;
    require_memory(stbi_write_jpg_to_func(append, &file, int(width), int(height), 3,
                                          rgb_of(std::size_t(width) * height, pixels).data(), 90));
    return "data:image/" + format + ";base64," + base64_of(std::move(file));
}

std::string short_data_uri(std::uint32_t width, std::uint32_t height, std::span<const std::uint8_t> rgba) {
    const std::string png = data_uri("png", width, height, rgba), jpeg = data_uri("jpeg", width, height, rgba);
    return png.size() <= jpeg.size() ? png : jpeg;
}

AlphaImage decode_alpha(std::span<const unsigned char> bytes) { return open_image_io().read_alpha(bytes); }

RgbaImage decode_colors(std::span<const unsigned char> bytes, std::uint64_t max_bytes) {
    return open_image_io().read_colors(bytes, max_bytes);
}

void require_openimageio() { open_image_io(); }

}  // namespace gnomon::app
