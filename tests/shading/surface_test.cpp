// SPDX-License-Identifier: MIT
// Surfaces of a view: textures of which every texel is known, seen where each pixel's area is known.
#include <gtest/gtest.h>

#include <array>
#include <cmath>
#include <optional>

#include "shading/surface.hpp"
#include "support/floor_view.hpp"
#include "support/srgb.hpp"

namespace {

using namespace gnomon;
using support::Floats;

/// The square from (-1, -1, 0) to (1, 1, 0) with (u, v) from `least` to `most`, v down.
struct Square {
    Floats triangles, coordinates;
    Materials materials{{0, 0}, {{1, 1, 1}}};
    std::vector<std::uint8_t> rgba;
    ColorTexture texture;  ///< refers to rgba: a Square with a texture is not copied
    ColorTextureUse use{0};
    Floats colors;
    std::vector<std::uint32_t> normals;

    explicit Square(float least = 0, float most = 1) {
        const auto corner = [&](float x, float y) {
            for (const float c : {x, y, 0.0f}) triangles.push_back(c);
            coordinates.push_back(least + (most - least) * (x + 1) / 2);
            coordinates.push_back(least + (most - least) * (1 - y) / 2);
        };
        for (const auto& [x, y] : {std::pair{-1, -1}, {1, -1}, {1, 1}, {-1, -1}, {1, 1}, {-1, 1}})
            corner(float(x), float(y));
    }
    Square& with_texture(std::uint32_t width, std::uint32_t height, std::vector<std::uint8_t> texels) {
        rgba = std::move(texels);
        texture = {width, height, rgba};
        return *this;
    }
    SurfacesOnHost seen(const Camera& camera, std::uint32_t width, std::uint32_t height,
                        const DeviceOptions& options = {}) const {
        const Device device({}, options);
        const Triangles on_device = Triangles::upload(device, triangles);
        const View view = look(device, on_device, camera, width, height);
        SurfaceDetail detail{coordinates, colors, normals, {}, {}};
        if (!rgba.empty()) {
            detail.texture_uses = {&use, 1};
            detail.textures = {&texture, 1};
        }
        return Surfaces(device, on_device, view, materials, detail).read();
    }
    /// The square fills the picture.
    SurfacesOnHost filling(std::uint32_t side, const DeviceOptions& options = {}) const {
        return seen(Camera::look_at({0, 0, 1}, {0, 0, 0}, {0, 1, 0}, 90), side, side, options);
    }
};

std::vector<std::uint8_t> grey(const std::vector<std::uint8_t>& values) {
    std::vector<std::uint8_t> rgba;
    for (const std::uint8_t value : values) rgba.insert(rgba.end(), {value, value, value, 255});
    return rgba;
}

TEST(Surfaces, AtTexelsCentresTheyAreTheTexels) {
    std::vector<std::uint8_t> rgba;
    for (int i = 0; i < 16; ++i)
        for (const int value : {i * 16, 255 - i * 9, i * i, 0}) rgba.push_back(std::uint8_t(value));
    for (const bool gpu_kernels : {false, true}) {
        const auto seen = Square().with_texture(4, 4, rgba).filling(4, {.gpu_kernels = gpu_kernels});
        for (std::size_t i = 0; i < 16; ++i)
            for (std::size_t k = 0; k < 3; ++k)
                EXPECT_NEAR(seen.albedo[3 * i + k], support::linear_of_srgb(rgba[4 * i + k]), 2e-4) << i << " " << k;
    }
}

TEST(Surfaces, MaterialAndTextureAreMultiplied) {
    Square square;
    square.materials.base_color = {{0.5f, 0.25f, 1}};
    const auto seen = square.with_texture(1, 1, {128, 255, 0, 255}).filling(2);
    EXPECT_NEAR(seen.albedo[0], 0.5 * 0.2158605, 1e-6);  // 128 is a fifth of the light, not half of it
    EXPECT_NEAR(seen.albedo[1], 0.25, 1e-6);
    EXPECT_NEAR(seen.albedo[2], 0, 1e-6);
}

TEST(Surfaces, LargeTexelsAreSquaresOrBlended) {
    const auto of = [](TextureFilter filter) {
        Square square;
        square.use.filter = filter;
        square.use.wrap_u = square.use.wrap_v = TextureWrap::clamp;
        const auto seen = square.with_texture(2, 1, grey({0, 255})).filling(8);
        Floats row;
        for (std::size_t x = 0; x < 8; ++x) row.push_back(seen.albedo[3 * x]);
        return row;
    };
    EXPECT_EQ(of(TextureFilter::nearest), (Floats{0, 0, 0, 0, 1, 1, 1, 1}));
    // The centres of 8 pixels on two texels are 1/8, 3/8 ... from the first texel's centre, in texels, less 1/2.
    const Floats blended = of(TextureFilter::linear), wanted{0, 0, 0.125f, 0.375f, 0.625f, 0.875f, 1, 1};
    for (std::size_t x = 0; x < 8; ++x) EXPECT_NEAR(blended[x], wanted[x], 1e-5) << x;
}

TEST(Surfaces, WrapsAreThoseOfGltf) {
    const auto of = [](TextureWrap wrap) {
        Square square(-1, 2);
        square.use.filter = TextureFilter::nearest;
        square.use.wrap_u = wrap;
        const auto seen = square.with_texture(2, 1, grey({0, 255})).filling(12);
        std::string row;
        for (std::size_t x = 0; x < 12; x += 2) row += seen.albedo[3 * x + 36] > 0.5f ? 'B' : 'A';
        return row;
    };
    EXPECT_EQ(of(TextureWrap::repeat), "ABABAB");
    EXPECT_EQ(of(TextureWrap::mirror), "BAABBA");
    EXPECT_EQ(of(TextureWrap::clamp), "AAABBB");
}

/// The texture's mean, in linear light: not that of the sRGB values, which is a fifth of the light.
TEST(Surfaces, FarAwayTheyAreTheLinearMean) {
    for (const auto& [width, height] : {std::pair{64u, 64u}, {63u, 17u}, {1u, 5u}}) {
        std::vector<std::uint8_t> values;
        double mean = 0;
        for (std::uint32_t i = 0; i < width * height; ++i) {
            values.push_back(i * 7919 % 3 == 0 ? 255 : i % 2 == 0 ? 0 : 40);
            mean += support::linear_of_srgb(values.back()) / (width * height);
        }
        Square square(0, 1);
        square.with_texture(width, height, grey(values));
        // The square is one pixel of nine.
        const auto seen = square.seen(Camera::look_at({0, 0, 3}, {0, 0, 0}, {0, 1, 0}, 90), 3, 3);
        EXPECT_NEAR(seen.albedo[3 * 4], mean, 0.005) << width << "x" << height;  // half a step of the 8 bits
        EXPECT_EQ(seen.albedo[0], 0) << "sky";
    }
}

/// A texture of 8 x 8 texels on a square that fills one pixel of nine: 2 x 2 black or white texels are in its middle.
TEST(Surfaces, SmallTexelsAreFilteredAsTheSamplerSays) {
    const auto of = [](TextureMinification minification, std::size_t white) {
        Square square;
        square.use.minification = minification;
        std::vector<std::uint8_t> values(64, 0);
        values[white] = 255;
        square.with_texture(8, 8, grey(values));
        // A little to the right and up: the pixel's centre lies in texel (3, 4), left of and below the middle.
        const float off = 0.05f;
        return square.seen(Camera::look_at({-off, -off, 3}, {-off, -off, 0}, {0, 1, 0}, 90), 3, 3).albedo[12];
    };
    const auto at = [](std::size_t x, std::size_t y) { return 8 * y + x; };
    // (u, v) of the centre: .5 - .025, .5 + .025, in texels 3.8 and 4.2, from the centre of (3, 4) .3 and -.3.
    EXPECT_EQ(of(TextureMinification::nearest, at(3, 4)), 1);
    for (const std::size_t other : {at(4, 4), at(3, 3), at(4, 3)})
        EXPECT_EQ(of(TextureMinification::nearest, other), 0);
    EXPECT_NEAR(of(TextureMinification::linear, at(3, 4)), 0.49, 1e-4);
    EXPECT_NEAR(of(TextureMinification::linear, at(4, 4)), 0.21, 1e-4);
    EXPECT_NEAR(of(TextureMinification::linear, at(4, 3)), 0.09, 1e-4);
    EXPECT_EQ(of(TextureMinification::linear, at(0, 0)), 0);
    for (const std::size_t any : {at(3, 4), at(0, 0), at(7, 2)})
        EXPECT_NEAR(of(TextureMinification::mean, any), 1 / 64.0, 0.002) << "all texels weigh alike";
}

TEST(Surfaces, ClearTexelsGiveNoColourWhereAlphaWeighs) {
    Square square;
    square.with_texture(2, 2, {255, 0, 0, 255, 0, 255, 0, 0, 0, 255, 0, 0, 0, 255, 0, 0});
    const Camera far = Camera::look_at({0, 0, 3}, {0, 0, 0}, {0, 1, 0}, 90);
    const auto plain = square.seen(far, 3, 3);
    EXPECT_NEAR(plain.albedo[12], 0.25, 0.005);
    EXPECT_NEAR(plain.albedo[13], 0.75, 0.005);
    square.use.weigh_by_alpha = true;
    const auto weighed = square.seen(far, 3, 3);
    EXPECT_NEAR(weighed.albedo[12], 255.0 / 258, 0.01);  // a clear texel weighs 1 / 255, so that it has a colour
    EXPECT_NEAR(weighed.albedo[13], 3.0 / 258, 0.01);
    // Between the centres of large texels, 3/8 of the way from red to clear green.
    square.use.wrap_u = square.use.wrap_v = TextureWrap::clamp;
    const auto near = square.filling(8);
    EXPECT_NEAR(near.albedo[3 * 3], 0.625 / (0.625 + 0.375 / 255), 1e-4);
    square.use.weigh_by_alpha = false;
    EXPECT_NEAR(square.filling(8).albedo[3 * 3], 0.625, 1e-4);
}

/// Stripes across a floor, along the view. At ten times the eye's height a pixel is 1.4 texels wide and 14 long: an
/// area as wide as it is long would make stripes of 8 texels grey.
TEST(Surfaces, StripesAlongTheViewStaySharp) {
    Square square;
    square.triangles = {-99, 0, -1, 99, 0, -1, 99, 0, -99, -99, 0, -1, 99, 0, -99, -99, 0, -99};
    for (std::size_t i = 0; i < 6; ++i) {
        square.coordinates[2 * i] = square.triangles[3 * i] / 4;
        square.coordinates[2 * i + 1] = square.triangles[3 * i + 2] / 4;
    }
    std::vector<std::uint8_t> values;
    for (int i = 0; i < 64 * 64; ++i) values.push_back(i % 16 < 8 ? 255 : 0);
    square.with_texture(64, 64, grey(values));
    const auto seen = square.seen(Camera::look_at({0, 1, 0}, {0, 0, -10}, {0, 1, 0}, 60), 129, 129);
    float least = 1, most = 0;
    for (std::size_t x = 0; x < 129; ++x) {
        const float albedo = seen.albedo[3 * (129 * 64 + x)];
        least = std::min(least, albedo);
        most = std::max(most, albedo);
    }
    EXPECT_LT(least, 0.1f);
    EXPECT_GT(most, 0.9f);
}

/// The middle pixel sees this point of a triangle whose corners are at different depths: what corners have is
/// interpolated by the point's coordinates in space.
TEST(Surfaces, CornersAreInterpolatedInSpace) {
    const std::array<std::array<double, 3>, 3> corners{{{-3, -1, -2}, {2, -2, -9}, {1, 4, -30}}};
    const std::array<double, 3> shares{0.5, 0.3, 0.2};
    Square one;
    one.triangles.clear();
    Float3 target{};
    for (std::size_t i = 0; i < 3; ++i)
        for (std::size_t k = 0; k < 3; ++k) {
            one.triangles.push_back(float(corners[i][k]));
            target[k] += float(shares[i] * corners[i][k]);
        }
    one.coordinates = {0, 0, 1, 0, 0, 1};
    one.materials = {{0}, {{1, 0.5f, 1}}};
    one.colors = {1, 0, 0, 0, 1, 0, 0, 0, 1};
    const std::array<Float3, 3> normals{{{0, 0, 1}, {0.6f, 0, 0.8f}, {0, 2, 0}}};
    for (const Float3& n : normals) one.normals.push_back(pack_normal(n));
    const Camera camera = Camera::look_at({0, 0, 5}, target, {0, 1, 0}, 40);
    const auto seen = one.seen(camera, 65, 65);
    const std::size_t middle = 3 * (65 * 32 + 32);
    EXPECT_NEAR(seen.albedo[middle], 0.5, 1e-4);
    EXPECT_NEAR(seen.albedo[middle + 1], 0.15, 1e-4);
    EXPECT_NEAR(seen.albedo[middle + 2], 0.2, 1e-4);
    const std::array<double, 3> blended{0.3 * 0.6, 0.2, 0.5 + 0.3 * 0.8};  // of unit normals
    const double size = std::hypot(blended[0], blended[1], blended[2]);
    for (std::size_t k = 0; k < 3; ++k) EXPECT_NEAR(seen.normal[middle + k], blended[k] / size, 1e-3) << k;

    // Normals that point away are those of a back: they are turned to the eye. A corner without one: the triangle's.
    for (std::size_t i = 0; i < 3; ++i) one.normals[i] = pack_normal({-normals[i][0], -normals[i][1], -normals[i][2]});
    const auto turned = one.seen(camera, 65, 65);
    for (std::size_t k = 0; k < 3; ++k) EXPECT_NEAR(turned.normal[middle + k], blended[k] / size, 1e-3) << k;
    one.normals[1] = 0;
    const auto flat = one.seen(camera, 65, 65);
    const double u[3] = {5, -1, -7}, v[3] = {4, 5, -28};
    const std::array<double, 3> n{u[1] * v[2] - u[2] * v[1], u[2] * v[0] - u[0] * v[2], u[0] * v[1] - u[1] * v[0]};
    const double n_size = std::hypot(n[0], n[1], n[2]);
    for (std::size_t k = 0; k < 3; ++k) EXPECT_NEAR(std::abs(flat.normal[middle + k]), std::abs(n[k]) / n_size, 1e-5);
}

TEST(Surfaces, PackedNormalsAreNearlyTheNormals) {
    EXPECT_EQ(pack_normal({0, 0, 0}), 0u);
    EXPECT_EQ(pack_normal({NAN, 0, 1}), 0u);
    EXPECT_EQ(pack_normal({INFINITY, 0, 1}), 0u);
    for (int i = 0; i < 200; ++i) {
        const float x = std::sin(float(i)) * 3, y = std::cos(float(7 * i)), z = std::sin(float(3 * i) + 1);
        Square square;
        for (int corner = 0; corner < 6; ++corner) square.normals.push_back(pack_normal({x, y, z}));
        const auto seen = square.filling(1);
        const float size = std::hypot(x, y, z), side = z < 0 ? -1.0f : 1.0f;
        EXPECT_NEAR(seen.normal[0], side * x / size, 2e-4);
        EXPECT_NEAR(seen.normal[1], side * y / size, 2e-4);
        EXPECT_NEAR(seen.normal[2], side * z / size, 2e-4);
        if (i == 20) i = 190;  // a device each
    }
}

TEST(Surfaces, TexturesThatDoNotFitLoseTheirFinestLevels) {
    const Device device({}, {.memory_limit_bytes = 3u << 20});
    const Square square;
    const Triangles triangles = Triangles::upload(device, square.triangles);
    const View view = look(device, triangles, Camera::look_at({0, 0, 1}, {0, 0, 0}, {0, 1, 0}, 90), 8, 8);
    const std::vector<std::uint8_t> white(std::size_t(4) * 2048 * 2048, 255);
    const ColorTexture texture{2048, 2048, white};
    const Surfaces surfaces(
        device, triangles, view, square.materials,
        {.texture_coordinates = square.coordinates, .texture_uses = {&square.use, 1}, .textures = {&texture, 1}});
    EXPECT_GE(surfaces.left_out_levels(), 2u);  // 22 MiB, 5.6 MiB, 1.4 MiB
    EXPECT_LT(surfaces.texture_bytes(), 3u << 20);
    for (const float albedo : surfaces.read().albedo) EXPECT_EQ(albedo, 1);
}

// Two squares, each with a texture of its own, and views of one at a time.
TEST(Surfaces, TexturesAreKeptFromViewToView) {
    const Device device;
    const Square square;
    Floats triangles = square.triangles, coordinates = square.coordinates;
    for (std::size_t i = 0; i < square.triangles.size(); ++i)
        triangles.push_back(square.triangles[i] + (i % 3 == 0 ? 10.0f : 0.0f));
    coordinates.insert(coordinates.end(), square.coordinates.begin(), square.coordinates.end());
    const Triangles on_device = Triangles::upload(device, triangles);
    const Materials materials{{0, 0, 1, 1}, {{1, 1, 1}, {1, 1, 1}}};
    const std::vector<std::uint8_t> texels = grey({10, 60, 110, 160, 210, 240, 200, 90}), others = grey({1, 2, 3, 4});
    std::vector<ColorTexture> textures{{4, 1, std::span(texels).first(16)}, {1, 4, std::span(texels).last(16)}};
    const std::vector<ColorTextureUse> uses{{0}, {1}};
    SurfaceTextures kept;
    const auto expect_same = [&](float x) {
        const View view = look(device, on_device, Camera::look_at({x, 0, 1}, {x, 0, 0}, {0, 1, 0}, 90), 8, 8);
        const SurfaceDetail detail{coordinates, {}, {}, uses, textures};
        const Surfaces alone(device, on_device, view, materials, detail);
        const Surfaces with_kept(device, on_device, view, materials, detail, &kept);
        const Floats wanted = alone.read().albedo;
        EXPECT_EQ(with_kept.read().albedo, wanted);
        EXPECT_NE(wanted[0], wanted[3 * 63]);
        return wanted;
    };
    const Floats left = expect_same(0);
    const auto first = kept.on_device;
    EXPECT_EQ(expect_same(0), left);
    EXPECT_EQ(kept.on_device, first);
    EXPECT_NE(expect_same(10), left);
    const auto both = kept.on_device;
    EXPECT_NE(both, first);
    EXPECT_EQ(expect_same(0), left);
    EXPECT_EQ(kept.on_device, both) << "textures that were shown stay";
    textures[0].rgba = others;
    EXPECT_NE(expect_same(0), left);
    EXPECT_NE(kept.on_device, both);
}

TEST(Surfaces, RefuseWhatDoesNotFitTogether) {
    const Device device;
    Square square;
    square.with_texture(1, 1, {1, 2, 3, 4});
    const Triangles triangles = Triangles::upload(device, square.triangles);
    const View view = look(device, triangles, Camera::look_at({0, 0, 1}, {0, 0, 0}, {0, 1, 0}, 90), 2, 2);
    const SurfaceDetail good{
        .texture_coordinates = square.coordinates, .texture_uses = {&square.use, 1}, .textures = {&square.texture, 1}};
    EXPECT_NO_THROW(Surfaces(device, triangles, view, square.materials, good));
    const auto refuses = [&](auto&& change) {
        SurfaceDetail detail = good;
        change(detail);
        EXPECT_THROW(Surfaces(device, triangles, view, square.materials, detail), InvalidArgument);
    };
    const Floats five(5);
    const std::vector<std::uint32_t> two(2);
    const ColorTexture empty, short_one{2, 2, square.rgba};
    const ColorTextureUse second{1};
    refuses([&](SurfaceDetail& d) { d.texture_coordinates = five; });
    refuses([&](SurfaceDetail& d) { d.texture_coordinates = {}; });
    refuses([&](SurfaceDetail& d) { d.corner_colors = five; });
    refuses([&](SurfaceDetail& d) { d.corner_normals = two; });
    refuses([&](SurfaceDetail& d) { d.textures = {}; });
    refuses([&](SurfaceDetail& d) { d.textures = {&empty, 1}; });
    refuses([&](SurfaceDetail& d) { d.textures = {&short_one, 1}; });
    refuses([&](SurfaceDetail& d) { d.texture_uses = {&second, 1}; });
}

}  // namespace
