// SPDX-License-Identifier: MIT
// check_view: is a view that gnomon wrote right? Reads the triangles of `gnomon render --dump-triangles` and the EXR of
// `--aov`, and judges every pixel with the exact reference: visibility, normal, sky, and the camera's three promises
// (tests/reference/camera.hpp). With --samples the mean of every pixel and each sample's receiver, point and shadow,
// from the points of `--dump-points`. Shares no code with gnomon. Exit status: 0 nothing wrong, 1 something is, 2 it
// could not be judged.
#include <OpenImageIO/imageio.h>
#include <fmt/core.h>

#include <CLI/CLI.hpp>
#include <algorithm>
#include <bit>
#include <cctype>
#include <cstdio>
#include <cstdlib>
#include <cstring>
#include <fstream>
#include <memory>
#include <optional>
#include <stdexcept>
#include <string>
#include <vector>

#include "reference/view.hpp"

namespace {

using reference::Float3;

static_assert(std::endian::native == std::endian::little, "the triangles' file is little-endian");

/// Three numbers, each float32 as strtof reads it, and nothing else.
Float3 parse_vector(const std::string& option, const std::string& text) {
    Float3 result;
    const char* at = text.c_str();
    for (int i = 0; i < 3; ++i) {
        char* end = nullptr;
        result[i] = std::strtof(at, &end);
        const bool is_last = i == 2;
        if (end == at || *end != (is_last ? '\0' : ',') || !reference::is_finite(Float3{result[i], 0, 0}))
            throw std::invalid_argument(option + " must be three finite numbers like 1,-2.5,3, not '" + text + "'");
        at = end + 1;
    }
    return result;
}

std::vector<float> read_triangles(const std::string& path) {
    std::ifstream file(path, std::ios::binary | std::ios::ate);
    if (!file) throw std::runtime_error("cannot open " + path);
    const auto bytes = static_cast<std::size_t>(file.tellg());
    if (bytes % 36 != 0) throw std::runtime_error(path + " is no multiple of 36 bytes (9 float32 per triangle)");
    std::vector<float> triangles(bytes / 4);
    file.seekg(0);
    if (!file.read(reinterpret_cast<char*>(triangles.data()), static_cast<std::streamsize>(bytes)))
        throw std::runtime_error("cannot read " + path);
    return triangles;
}

/// Little-endian words of a file, one after the other.
class Words {
public:
    explicit Words(const std::string& path) : path_(path), file_(path, std::ios::binary) {
        if (!file_) throw std::runtime_error("cannot open " + path);
    }
    template <typename Value>
    std::vector<Value> take(std::size_t count) {
        std::vector<Value> values;
        // In steps, so that a wrong count ends with the file and not with the memory.
        for (constexpr std::size_t step = 1 << 20; values.size() < count;) {
            const std::size_t first = values.size(), more = std::min(step, count - first);
            values.resize(first + more);
            if (!file_.read(reinterpret_cast<char*>(&values[first]),
                            static_cast<std::streamsize>(more * sizeof(Value))))
                throw std::runtime_error(path_ + " is too short");
        }
        return values;
    }
    void require_end() {
        if (file_.peek() != std::ifstream::traits_type::eof()) throw std::runtime_error(path_ + " is too long");
    }

private:
    std::string path_;
    std::ifstream file_;
};

/// The masks of as many triangles: the numbers M, T and F; of M materials the texture or -1, the wraps of u and v (0:
/// repeat, 1: mirror, 2: clamp), whether it is linear, cutoff and factor (float); of T textures width, height and their
/// bytes; then of F triangles all materials or -1, all u and v of corners (float), all alphas of corners (float).
reference::Masks read_masks(const std::string& path, std::size_t triangle_count) {
    Words words(path);
    const auto counts = words.take<std::uint32_t>(3);
    if (counts[2] != triangle_count)
        throw std::runtime_error(
            fmt::format("{} has masks for {} triangles, not for {}", path, counts[2], triangle_count));
    reference::Masks masks;
    for (std::uint32_t i = 0; i < counts[0]; ++i) {
        const auto whole = words.take<std::int32_t>(4);
        const auto real = words.take<float>(2);
        const bool is_known = whole[0] >= -1 && whole[0] < std::int64_t(counts[1]) && whole[1] >= 0 && whole[1] <= 2 &&
                              whole[2] >= 0 && whole[2] <= 2;
        if (!is_known) throw std::runtime_error(fmt::format("{}: material {} is none", path, i));
        masks.materials.push_back(
            {whole[0], reference::MaskWrap(whole[1]), reference::MaskWrap(whole[2]), whole[3] != 0, real[0], real[1]});
    }
    for (std::uint32_t i = 0; i < counts[1]; ++i) {
        const auto sides = words.take<std::uint32_t>(2);
        masks.textures.push_back({sides[0], sides[1], words.take<std::uint8_t>(std::size_t(sides[0]) * sides[1])});
    }
    masks.material = words.take<std::uint32_t>(triangle_count);
    for (const std::uint32_t material : masks.material)
        if (material != reference::NO_MATERIAL && material >= counts[0])
            throw std::runtime_error(path + ": a triangle's material is none");
    masks.coordinates = words.take<float>(6 * triangle_count);
    masks.alphas = words.take<float>(3 * triangle_count);
    words.require_end();
    return masks;
}

/// A picture with every channel's bits as they are in the file. OpenImageIO's conversions are kept out: a receiver id
/// that becomes a float loses its low bits.
class NativePicture {
public:
    explicit NativePicture(const std::string& path) : path_(path) {
        const auto input = OIIO::ImageInput::open(path);
        if (!input) throw std::runtime_error("cannot open " + path + ": " + OIIO::geterror());
        spec_ = input->spec();
        bytes_.resize(spec_.image_bytes(true));
        if (!input->read_image(0, 0, 0, spec_.nchannels, OIIO::TypeUnknown, bytes_.data()))
            throw std::runtime_error("cannot read " + path + ": " + input->geterror());
    }

    std::uint32_t width() const { return static_cast<std::uint32_t>(spec_.width); }
    std::uint32_t height() const { return static_cast<std::uint32_t>(spec_.height); }

    /// Channels of 4-byte values, found by name (files keep them in any order), one after the other in each pixel.
    template <typename Value>
    std::vector<Value> channels(const std::vector<std::string>& names, OIIO::TypeDesc type) const {
        const std::size_t pixels = std::size_t{width()} * height();
        std::vector<Value> values(pixels * names.size());
        for (std::size_t k = 0; k < names.size(); ++k) {
            const std::size_t offset = offset_of(names[k], type);
            for (std::size_t i = 0; i < pixels; ++i)
                std::memcpy(&values[i * names.size() + k], &bytes_[i * spec_.pixel_bytes(true) + offset],
                            sizeof(Value));
        }
        return values;
    }

private:
    std::size_t offset_of(const std::string& name, OIIO::TypeDesc type) const {
        const int channel = spec_.channelindex(name);
        if (channel < 0) throw std::runtime_error(path_ + " has no channel '" + name + "'");
        if (spec_.channelformat(channel) != type)
            throw std::runtime_error(path_ + ": channel '" + name + "' is " + spec_.channelformat(channel).c_str() +
                                     ", not " + type.c_str());
        return spec_.pixel_bytes(0, channel, true);
    }

    std::string path_;
    OIIO::ImageSpec spec_;
    std::vector<unsigned char> bytes_;
};

/// The points of `gnomon render --dump-points`: x, y, z and receiver, 4 bytes each. Those of the sky are not finite.
struct SamplePoints {
    SamplePoints(const std::string& path, std::size_t count) {
        Words words(path);
        const auto all = words.take<std::uint32_t>(4 * count);
        words.require_end();
        for (std::size_t i = 0; i < count; ++i) {
            for (std::size_t k = 0; k < 3; ++k) position.push_back(std::bit_cast<float>(all[4 * i + k]));
            receiver.push_back(all[4 * i + 3]);
        }
    }
    std::vector<float> position;
    std::vector<std::uint32_t> receiver;
};

struct Options {
    std::uint32_t samples = 1;
    std::string triangles, masks, aov, points, eye, target, up = "0,1,0", light_direction, light_position;
    double fov_y_degrees = 0;
    reference::JudgeOptions judge;
};

/// CLI11 takes "-.5,1,2" after "--eye" for an option. So values that begin like a negative number are tied to the long
/// option before them, which always works.
std::vector<std::string> tied_arguments(int count, char** values) {
    std::vector<std::string> arguments;
    for (int i = 1; i < count; ++i) {
        const std::string value = values[i];
        const bool is_negative = value.size() > 1 && value[0] == '-' &&
                                 (std::isdigit(static_cast<unsigned char>(value[1])) || value[1] == '.');
        const bool follows_option =
            !arguments.empty() && arguments.back().starts_with("--") && arguments.back().find('=') == std::string::npos;
        if (is_negative && follows_option)
            arguments.back() += "=" + value;
        else
            arguments.push_back(value);
    }
    std::reverse(arguments.begin(), arguments.end());  // CLI11 takes a vector from its back
    return arguments;
}

void describe(CLI::App& app, Options& options) {
    app.add_option("--triangles", options.triangles, "world triangles: 9 little-endian float32 each")->required();
    app.add_option("--masks", options.masks,
                   "the triangles' cut-outs, as tests/python/gltf_reference.py writes them; without: all are opaque");
    app.add_option("--aov", options.aov, "EXR with P.X P.Y P.Z N.X N.Y N.Z visibility (float) and receiver (uint)")
        ->required();
    app.add_option("--samples", options.samples, "samples per pixel of visibility and --points: 1, 4, 8, 16 or 32")
        ->capture_default_str();
    app.add_option("--points", options.points, "with --samples: the file of gnomon render --dump-points");
    app.add_option("--eye", options.eye, "the camera's position, x,y,z")->required();
    app.add_option("--target", options.target, "what it looks at, x,y,z")->required();
    app.add_option("--up", options.up, "up, made orthogonal to the view, x,y,z")->capture_default_str();
    app.add_option("--fovy", options.fov_y_degrees, "vertical field of view in degrees")->required();
    auto* light = app.add_option_group("light", "one of");
    light->add_option("--light-direction", options.light_direction, "the way the light travels, x,y,z");
    light->add_option("--light-position", options.light_position, "where the light is, x,y,z");
    light->require_option(1);
    app.add_option("--sample", options.judge.camera_sample,
                   "judge the camera's promises on about N random pixels only (visibility: always all); 0: on all")
        ->capture_default_str();
    app.add_option("--seed", options.judge.seed, "of the sample")->capture_default_str();
    app.add_option("--ray-tolerance", options.judge.ray_tolerance,
                   "how far, relative to its length, a pixel's ray may be off: nearest triangles that differ within it "
                   "count as ambiguous, not wrong. The default, 2^-48, is a camera's whose axes are doubles")
        ->check(CLI::Range(0.0, 0.001));
}

std::array<float, 4> light_of(const Options& options) {
    if (!options.light_position.empty()) {
        const Float3 p = parse_vector("--light-position", options.light_position);
        return {p[0], p[1], p[2], 1};
    }
    const Float3 d = parse_vector("--light-direction", options.light_direction);
    return {-d[0], -d[1], -d[2], 0};
}

unsigned long long number(std::uint64_t value) { return value; }

void print_row(const char* name, std::uint64_t count, std::uint64_t of) {
    std::printf("  %-34s %12llu  %7.3f %%\n", name, number(count),
                of ? 100.0 * static_cast<double>(count) / static_cast<double>(of) : 0.0);
}

void print_faults(const char* name, const reference::Faults& faults, std::uint32_t width) {
    std::printf("  %-34s %12llu", name, number(faults.count));
    for (const std::size_t pixel : faults.first)
        std::printf("%s(%zu,%zu)", pixel == faults.first[0] ? "  at " : " ", pixel % width, pixel / width);
    std::printf("%s\n", faults.count > faults.first.size() ? " ..." : "");
}

void print_report(const reference::ViewReport& report, std::size_t triangle_count,
                  const reference::PinholeCamera& camera, double ray_tolerance) {
    const auto& visibility = report.visibility;
    const std::uint64_t points = visibility.absent + visibility.facing_away + visibility.lit + visibility.shadowed;
    std::printf("%zu triangles, %u x %u pixels\n", triangle_count, camera.width, camera.height);
    print_row("sky", report.sky, report.pixels);
    const std::uint64_t samples = report.samples_of_sky + report.samples_on_own + report.samples_on_others;
    print_row("points", points, samples != 0 ? samples : report.pixels);
    print_row("facing away", visibility.facing_away, points);
    print_row("lit", visibility.lit, points);
    print_row("shadowed", visibility.shadowed, points);
    if (visibility.absent > 0) print_row("not finite", visibility.absent, points);
    print_row("visibility decided by integers", visibility.decided_exactly, points);
    print_row("camera judged", report.camera_pixels, report.pixels);
    print_row("camera decided by integers", report.camera_decided_exactly, report.camera_pixels);
    print_row("camera ambiguous", report.camera_ambiguous, report.camera_pixels);
    if (report.samples_judged != 0) {
        print_row("samples of sky", report.samples_of_sky, samples);
        print_row("samples on their pixel's receiver", report.samples_on_own, samples);
        print_row("samples on others", report.samples_on_others, samples);
        print_row("samples judged", report.samples_judged, samples);
        print_row("samples ambiguous", report.samples_ambiguous, report.samples_judged);
        print_row("pixels partly lit", report.partly_lit, report.pixels);
    }
    std::printf("  %-34s %12.3Lf  (16 allowed)\n", "largest distance to the hit, ulp", report.largest_distance_ulp);
    std::printf("  %-34s %12.3g\n", "ray tolerance", ray_tolerance);
    std::printf("  %-34s %12.1f  visibility, %.1f camera\n", "seconds", report.visibility_seconds,
                report.camera_seconds);
    print_faults("WRONG visibility", report.wrong_visibility, camera.width);
    print_faults("WRONG sky", report.wrong_sky, camera.width);
    print_faults("WRONG normal", report.wrong_normal, camera.width);
    print_faults("WRONG nearest triangle (a)", report.wrong_nearest, camera.width);
    print_faults("WRONG side of the plane (b)", report.wrong_side, camera.width);
    print_faults("WRONG distance to the hit (c)", report.wrong_distance, camera.width);
    if (report.samples_judged != 0) {
        print_faults("WRONG nearest, samples (a)", report.wrong_sample_nearest, camera.width);
        print_faults("WRONG side, samples (b)", report.wrong_sample_side, camera.width);
        print_faults("WRONG distance, samples (c)", report.wrong_sample_distance, camera.width);
    }
    std::printf(report.wrong() == 0 ? "right: nothing wrong\n" : "WRONG\n");
}

int check(const Options& options) {
    reference::PinholeCamera camera{parse_vector("--eye", options.eye), parse_vector("--target", options.target),
                                    parse_vector("--up", options.up), options.fov_y_degrees};
    const auto light = light_of(options);
    const auto triangles = read_triangles(options.triangles);
    const NativePicture picture(options.aov);
    camera.width = picture.width();
    camera.height = picture.height();
    const auto position = picture.channels<float>({"P.X", "P.Y", "P.Z"}, OIIO::TypeFloat);
    const auto normal = picture.channels<float>({"N.X", "N.Y", "N.Z"}, OIIO::TypeFloat);
    const auto visibility = picture.channels<float>({"visibility"}, OIIO::TypeFloat);
    const auto receiver = picture.channels<std::uint32_t>({"receiver"}, OIIO::TypeUInt32);
    reference::Masks masks;
    reference::JudgeOptions how = options.judge;
    if (!options.masks.empty()) {
        masks = read_masks(options.masks, triangles.size() / 9);
        how.masks = &masks;
    }
    reference::ViewClaim claim{position, normal, receiver, visibility, options.samples, {}, {}};
    std::optional<SamplePoints> samples;
    if (options.samples != 1) {
        if (reference::sample_positions(options.samples).empty())
            throw std::invalid_argument("--samples must be 1, 4, 8, 16 or 32");
        if (options.points.empty()) throw std::invalid_argument("--samples needs --points as well");
        samples.emplace(options.points, receiver.size() * options.samples);
        claim.sample_position = samples->position;
        claim.sample_receiver = samples->receiver;
    } else if (!options.points.empty()) {
        throw std::invalid_argument("--points goes with --samples");
    }
    const auto report = reference::judge_view(triangles, camera, light, claim, how);
    print_report(report, triangles.size() / 9, camera, options.judge.ray_tolerance);
    return report.wrong() == 0 ? 0 : 1;
}

}  // namespace

int main(int count, char** values) {
    Options options;
    CLI::App app("Judges a view that gnomon wrote (--aov, --dump-triangles) with exact arithmetic.", "check_view");
    describe(app, options);
    try {
        app.parse(tied_arguments(count, values));
        return check(options);
    } catch (const CLI::ParseError& error) {
        return app.exit(error) == 0 ? 0 : 2;
    } catch (const std::exception& error) {
        std::fprintf(stderr, "check_view: %s\n", error.what());
        return 2;
    }
}
