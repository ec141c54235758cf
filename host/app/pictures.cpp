// SPDX-License-Identifier: MIT
// PNG writing row by row, so that a picture of 16384 x 16384 needs no second copy in memory.
#include "pictures.hpp"

#include <dlfcn.h>
#include <png.h>

#include <algorithm>
#include <cmath>
#include <filesystem>
#include <functional>
#include <string>
#include <vector>

#include "openimageio.hpp"

namespace gnomon::app {
namespace {

std::string software() { return "gnomon " + std::string(version()); }

/// The parameters of a PNG.
struct PngRows {
    std::uint32_t width, height;
    bool is_mask;  ///< one channel of numbers; else sRGB from four bytes per pixel, the fourth is left out
    std::function<const std::uint8_t*(std::uint32_t)> row;
};

// The callbacks keep failures in the file.
void put_bytes(png_structp png, png_bytep bytes, png_size_t count) {
    static_cast<OutputFile*>(png_get_io_ptr(png))->write(bytes, count);
}
void flush_nothing(png_structp) {}

[[noreturn]] void keep_reason(png_structp png, png_const_charp reason) {
    *static_cast<std::string*>(png_get_error_ptr(png)) = reason;
    png_longjmp(png, 1);
}
void ignore_warning(png_structp, png_const_charp) {}

void put_rows(png_structp png, png_infop info, const PngRows& rows, const OutputFile& file, char* made_by) {
    constexpr std::uint32_t rows_between_checks = 64;
    char keyword[] = "Software";
    png_text text{};
    text.compression = PNG_TEXT_COMPRESSION_NONE;
    text.key = keyword;
    text.text = made_by;
    png_set_IHDR(png, info, rows.width, rows.height, 8, rows.is_mask ? PNG_COLOR_TYPE_GRAY : PNG_COLOR_TYPE_RGB,
                 PNG_INTERLACE_NONE, PNG_COMPRESSION_TYPE_DEFAULT, PNG_FILTER_TYPE_DEFAULT);
    if (!rows.is_mask) png_set_sRGB_gAMA_and_cHRM(png, info, PNG_sRGB_INTENT_ABSOLUTE);
    png_set_text(png, info, &text, 1);
    png_write_info(png, info);
    if (!rows.is_mask) png_set_filler(png, 0, PNG_FILLER_AFTER);
    for (std::uint32_t y = 0; y < rows.height; ++y) {
        png_write_row(png, rows.row(y));
        if (y % rows_between_checks == 0) file.check();
    }
    png_write_end(png, nullptr);
}

// False if libpng gave up: it jumps back to this function, so no variable below may have a destructor.
bool try_to_put_rows(png_structp png, png_infop info, const PngRows& rows, const OutputFile& file, char* made_by) {
    if (setjmp(png_jmpbuf(png)) != 0) return false;
    put_rows(png, info, rows, file, made_by);
    return true;
}

void write_png(OutputFile& file, const PngRows& rows) {
    struct Writer {
        std::string reason;
        png_structp png = png_create_write_struct(PNG_LIBPNG_VER_STRING, &reason, keep_reason, ignore_warning);
        png_infop info = png != nullptr ? png_create_info_struct(png) : nullptr;
        ~Writer() { png_destroy_write_struct(&png, &info); }
    } writer;
    if (writer.info == nullptr) throw Error("cannot write " + file.target().string() + ": libpng does not start");
    png_set_write_fn(writer.png, &file, put_bytes, flush_nothing);
    std::string made_by = software();
    const bool is_done = try_to_put_rows(writer.png, writer.info, rows, file, made_by.data());
    file.check();  // first, as the system's reason, if there is one, is more precise
    if (!is_done) throw Error("cannot write " + file.target().string() + ": " + writer.reason);
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
        throw Error(std::string("cannot open the module for EXR files, galleries and images, which is built and "
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
    write_png(file, {width, height, false, [&](std::uint32_t y) { return rgba.data() + std::size_t(4) * width * y; }});
}

void write_mask(OutputFile& file, std::uint32_t width, std::uint32_t height, std::span<const float> visibility) {
    std::vector<std::uint8_t> row(width);
    write_png(file, {width, height, true, [&](std::uint32_t y) {
                         const auto points = visibility.subspan(std::size_t(y) * width, width);
                         std::transform(points.begin(), points.end(), row.begin(), mask_value);
                         return row.data();
                     }});
}

void write_aov(OutputFile& file, std::uint32_t width, std::uint32_t height, const ViewOnHost& view,
               std::span<const float> values, const char* channel, const AovSurfaces& surfaces) {
    open_image_io().write_aov(file, file.target().string(), software(), width, height, view, values, channel, surfaces);
}

std::string data_uri(const char* format, std::uint32_t width, std::uint32_t height,
                     std::span<const std::uint8_t> pixels) {
    return open_image_io().data_uri(format, width, height, pixels, std::ptrdiff_t(pixels.size() / width / height));
}

std::string short_data_uri(std::uint32_t width, std::uint32_t height, std::span<const std::uint8_t> rgba) {
    const std::string png = data_uri("png", width, height, rgba), jpeg = data_uri("jpeg", width, height, rgba);
    return png.size() <= jpeg.size() ? png : jpeg;
}

AlphaImage decode_alpha(std::span<const unsigned char> bytes) { return open_image_io().read_alpha(bytes); }

RgbaImage decode_colors(std::span<const unsigned char> bytes, std::uint64_t most_bytes) {
    return open_image_io().read_colors(bytes, most_bytes);
}

void require_openimageio() { open_image_io(); }

}  // namespace gnomon::app
