// SPDX-License-Identifier: MIT
// The module gnomon_openimageio. EXR files are written in bands of rows, so that a picture of 16384 x 16384 needs no
// second copy in memory.
#include "openimageio.hpp"

#include <OpenImageIO/filesystem.h>
#include <OpenImageIO/imageio.h>

#include <algorithm>
#include <bit>
#include <memory>
#include <string>
#include <vector>

namespace gnomon::app {
namespace {

/// Rows per band: a multiple of the 16 rows that zip compresses together.
constexpr std::uint32_t band_rows = 64;

/// OpenImageIO's interface to a file. Failures are kept in the file.
class FileProxy final : public OIIO::Filesystem::IOProxy {
public:
    FileProxy(ByteSink& file, const std::string& name) : IOProxy(name, Write), file_(file) {}
    const char* proxytype() const override { return "gnomon"; }
    void close() override {}
    bool opened() const override { return true; }
    int64_t tell() override { return int64_t(file_.position()); }
    bool seek(int64_t offset) override { return file_.seek(std::size_t(offset)); }
    std::size_t write(const void* bytes, std::size_t count) override { return file_.write(bytes, count); }

private:
    ByteSink& file_;
};

/// The first eight channels, and more with surfaces, with shares of the sky, and of an area light.
OIIO::ImageSpec aov_spec(std::uint32_t width, std::uint32_t height, const char* channel, const AovSurfaces& surfaces) {
    OIIO::ImageSpec spec(int(width), int(height), 8, OIIO::TypeFloat);
    spec.channelnames = {"P.X", "P.Y", "P.Z", "N.X", "N.Y", "N.Z", channel, "receiver"};
    if (surfaces.surfaces != nullptr)
        for (const char* name : {"albedo.R", "albedo.G", "albedo.B", "Ns.X", "Ns.Y", "Ns.Z"})
            spec.channelnames.emplace_back(name);
    if (!surfaces.sky_shares.empty()) spec.channelnames.emplace_back("sky");
    if (!surfaces.irradiance.empty()) spec.channelnames.emplace_back("irradiance");
    spec.nchannels = int(spec.channelnames.size());
    spec.channelformats.assign(spec.channelnames.size(), OIIO::TypeFloat);
    spec.channelformats[7] = OIIO::TypeUInt32;
    spec.attribute("compression", "zip");
    spec.attribute("DateTime", "");  // else OpenImageIO writes the time of day, and equal values give unequal files
    return spec;
}

/// Appends the channels of a pixel, floats and an unsigned integer, of 4 bytes each and without gaps.
void put_aov_pixel(const ViewOnHost& view, std::span<const float> values, const AovSurfaces& surfaces,
                   std::size_t pixel, std::vector<std::uint32_t>& band) {
    const auto put = [&](float value) { band.push_back(std::bit_cast<std::uint32_t>(value)); };
    const auto put_three = [&](const std::vector<float>& from) {
        for (std::size_t k = 0; k < 3; ++k) put(from[3 * pixel + k]);
    };
    put_three(view.position);
    put_three(view.normal);
    put(values[pixel]);
    band.push_back(view.receiver[pixel]);
    if (surfaces.surfaces != nullptr) {
        put_three(surfaces.surfaces->albedo);
        put_three(surfaces.surfaces->normal);
    }
    if (!surfaces.sky_shares.empty()) put(surfaces.sky_shares[pixel]);
    if (!surfaces.irradiance.empty()) put(surfaces.irradiance[pixel]);
}

void write_aov(ByteSink& file, const std::string& name, const std::string& software, std::uint32_t width,
               std::uint32_t height, const ViewOnHost& view, std::span<const float> values, const char* channel,
               const AovSurfaces& surfaces) {
    FileProxy proxy(file, name);
    const auto output = OIIO::ImageOutput::create("exr");
    if (!output || !output->supports("ioproxy"))
        throw Error("cannot write " + name + ": this OpenImageIO cannot write exr");
    const auto require = [&](bool is_done) {
        file.check();  // first, as the system's reason, if there is one, is more precise
        if (!is_done) throw Error("cannot write " + name + ": " + output->geterror());
    };
    OIIO::ImageSpec spec = aov_spec(width, height, channel, surfaces);
    spec.attribute("Software", software);
    // The argument names the format: the file's own name may be anything (a temporary, a device).
    require(output->set_ioproxy(&proxy) && output->open("picture.exr", spec));
    std::vector<std::uint32_t> band;
    for (std::uint32_t first = 0; first < height; first += band_rows) {
        const std::uint32_t rows = std::min(band_rows, height - first);
        const std::size_t first_pixel = std::size_t(first) * width;
        band.clear();
        for (std::size_t i = 0; i < std::size_t(rows) * width; ++i)
            put_aov_pixel(view, values, surfaces, first_pixel + i, band);
        // Packed rows, each channel's bits as they are: unknown means native.
        require(output->write_scanlines(int(first), int(first + rows), 0, OIIO::TypeUnknown, band.data()));
    }
    require(output->close());
}

}  // namespace
}  // namespace gnomon::app

extern "C" const gnomon::app::OpenImageIo gnomon_openimageio{gnomon::app::write_aov, gnomon::app::read_alpha,
                                                             gnomon::app::read_colors};
