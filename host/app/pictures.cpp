// SPDX-License-Identifier: MIT
// PNG and EXR writing in bands of rows, so that a picture of 16384 x 16384 needs no second copy in memory.
#include "pictures.hpp"

#include <OpenImageIO/filesystem.h>
#include <OpenImageIO/imageio.h>
#include <OpenImageIO/strutil.h>

#include <algorithm>
#include <cmath>
#include <memory>
#include <string>
#include <vector>

namespace gnomon::app {
namespace {

/// Rows per band: a multiple of the 16 rows that EXR's zip compresses together.
constexpr std::uint32_t band_rows = 64;

/// OpenImageIO's view of an OutputFile. Failures stay in the file (see OutputFile::write).
class FileProxy final : public OIIO::Filesystem::IOProxy {
public:
    explicit FileProxy(OutputFile& file) : IOProxy(file.target().string(), Write), file_(file) {}
    const char* proxytype() const override { return "gnomon"; }
    void close() override {}
    bool opened() const override { return true; }
    int64_t tell() override { return int64_t(file_.position()); }
    bool seek(int64_t offset) override { return file_.seek(std::size_t(offset)); }
    std::size_t write(const void* bytes, std::size_t count) override { return file_.write(bytes, count); }

private:
    OutputFile& file_;
};

/// One picture being written: opened with a format and a spec, fed with bands, closed.
class PictureWriter {
public:
    PictureWriter(OutputFile& file, const std::string& format, OIIO::ImageSpec spec)
        : file_(file), proxy_(file), output_(OIIO::ImageOutput::create(format)) {
        if (!output_ || !output_->supports("ioproxy"))
            throw Error("cannot write " + file.target().string() + ": this OpenImageIO cannot write " + format);
        spec.attribute("Software", "gnomon " + std::string(version()));
        // The format is named by the argument: the file's own name may be anything (a temporary, a device).
        if (!output_->set_ioproxy(&proxy_) || !output_->open("picture." + format, spec)) fail();
    }

    /// Rows [first, first + rows), packed.
    void write_band(std::uint32_t first, std::uint32_t rows, OIIO::TypeDesc type, const void* pixels,
                    OIIO::stride_t pixel_stride = OIIO::AutoStride) {
        if (!output_->write_scanlines(int(first), int(first + rows), 0, type, pixels, pixel_stride)) fail();
        file_.check();
    }

    void close() {
        if (!output_->close()) fail();
        file_.check();
    }

private:
    [[noreturn]] void fail() {
        file_.check();  // the system's reason, if there is one, says more
        throw Error("cannot write " + file_.target().string() + ": " + output_->geterror());
    }

    OutputFile& file_;
    FileProxy proxy_;
    std::unique_ptr<OIIO::ImageOutput> output_;  // last: it is destroyed before what it writes to
};

/// Calls `write(first_row, row_count)` for all bands of a picture.
template <typename WriteBand>
void for_each_band(std::uint32_t height, WriteBand&& write) {
    for (std::uint32_t first = 0; first < height; first += band_rows) write(first, std::min(band_rows, height - first));
}

/// One pixel of the EXR, as its channels lie in memory. Floats and an unsigned integer, all of 4 bytes: no padding.
struct AovPixel {
    float position[3];
    float normal[3];
    float visibility;
    std::uint32_t receiver;
};
static_assert(sizeof(AovPixel) == 32);

OIIO::ImageSpec aov_spec(std::uint32_t width, std::uint32_t height) {
    OIIO::ImageSpec spec(int(width), int(height), 8, OIIO::TypeFloat);
    spec.channelnames = {"P.X", "P.Y", "P.Z", "N.X", "N.Y", "N.Z", "visibility", "receiver"};
    spec.channelformats.assign(7, OIIO::TypeFloat);
    spec.channelformats.push_back(OIIO::TypeUInt32);
    spec.attribute("compression", "zip");
    spec.attribute("DateTime", "");  // else OpenImageIO writes the time of day, and equal values give unequal files
    return spec;
}

AovPixel aov_pixel(const ViewOnHost& view, std::span<const float> visibility, std::size_t pixel) {
    AovPixel result{};
    std::copy_n(view.position.begin() + std::ptrdiff_t(3 * pixel), 3, result.position);
    std::copy_n(view.normal.begin() + std::ptrdiff_t(3 * pixel), 3, result.normal);
    result.visibility = visibility[pixel];
    result.receiver = view.receiver[pixel];
    return result;
}

/// Three channels in the given format, in memory, as a data URI. `pixel_bytes`: from one pixel to the next.
std::string data_uri(const std::string& format, std::uint32_t width, std::uint32_t height,
                     std::span<const std::uint8_t> pixels, OIIO::stride_t pixel_bytes) {
    std::vector<unsigned char> bytes;
    OIIO::Filesystem::IOVecOutput memory(bytes);
    const auto output = OIIO::ImageOutput::create(format);
    OIIO::ImageSpec spec(int(width), int(height), 3, OIIO::TypeUInt8);
    spec.attribute("oiio:ColorSpace", "sRGB");
    spec.attribute("CompressionQuality", 90);
    if (!output || !output->supports("ioproxy") || !output->set_ioproxy(&memory) ||
        !output->open("picture." + format, spec) || !output->write_image(OIIO::TypeUInt8, pixels.data(), pixel_bytes) ||
        !output->close())
        throw Error("this OpenImageIO cannot write " + format + " into a page" +
                    (output ? ": " + output->geterror() : ""));
    const OIIO::string_view view(reinterpret_cast<const char*>(bytes.data()), bytes.size());
    return "data:image/" + format + ";base64," + OIIO::Strutil::base64_encode(view);
}

std::uint8_t mask_value(float visibility) {
    return std::uint8_t(std::lround(255.0f * std::clamp(visibility, 0.0f, 1.0f)));
}

}  // namespace

void write_picture(OutputFile& file, std::uint32_t width, std::uint32_t height, std::span<const std::uint8_t> rgba) {
    OIIO::ImageSpec spec(int(width), int(height), 3, OIIO::TypeUInt8);
    spec.attribute("oiio:ColorSpace", "sRGB");
    PictureWriter picture(file, "png", spec);
    for_each_band(height, [&](std::uint32_t first, std::uint32_t rows) {
        picture.write_band(first, rows, OIIO::TypeUInt8, rgba.data() + std::size_t(4) * width * first, 4);
    });
    picture.close();
}

void write_mask(OutputFile& file, std::uint32_t width, std::uint32_t height, std::span<const float> visibility) {
    const OIIO::ImageSpec spec(int(width), int(height), 1, OIIO::TypeUInt8);
    PictureWriter picture(file, "png", spec);
    std::vector<std::uint8_t> band;
    for_each_band(height, [&](std::uint32_t first, std::uint32_t rows) {
        const auto points = visibility.subspan(std::size_t(first) * width, std::size_t(rows) * width);
        band.resize(points.size());
        std::transform(points.begin(), points.end(), band.begin(), mask_value);
        picture.write_band(first, rows, OIIO::TypeUInt8, band.data());
    });
    picture.close();
}

void write_aov(OutputFile& file, std::uint32_t width, std::uint32_t height, const ViewOnHost& view,
               std::span<const float> visibility) {
    PictureWriter picture(file, "exr", aov_spec(width, height));
    std::vector<AovPixel> band;
    for_each_band(height, [&](std::uint32_t first, std::uint32_t rows) {
        const std::size_t first_pixel = std::size_t(first) * width;
        band.resize(std::size_t(rows) * width);
        for (std::size_t i = 0; i < band.size(); ++i) band[i] = aov_pixel(view, visibility, first_pixel + i);
        // Unknown means native: each channel's bits as they are, with no conversion between float and integer.
        picture.write_band(first, rows, OIIO::TypeUnknown, band.data());
    });
    picture.close();
}

std::string png_data_uri(std::uint32_t width, std::uint32_t height, std::span<const std::uint8_t> rgb) {
    return data_uri("png", width, height, rgb, 3);
}

std::string jpeg_data_uri(std::uint32_t width, std::uint32_t height, std::span<const std::uint8_t> rgba) {
    return data_uri("jpeg", width, height, rgba, 4);
}

std::string short_data_uri(std::uint32_t width, std::uint32_t height, std::span<const std::uint8_t> rgba) {
    std::string png = data_uri("png", width, height, rgba, 4), jpeg = jpeg_data_uri(width, height, rgba);
    return png.size() <= jpeg.size() ? png : jpeg;
}

}  // namespace gnomon::app
