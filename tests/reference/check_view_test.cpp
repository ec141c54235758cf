// SPDX-License-Identifier: MIT
// Runs the tool check_view on small files: a right view made by the reference, and copies with one thing broken. The
// channels are written in another order than gnomon's, because they are to be found by name.
#include <OpenImageIO/imageio.h>
#include <gtest/gtest.h>
#include <sys/wait.h>

#include <algorithm>
#include <cstdio>
#include <cstdlib>
#include <filesystem>
#include <fstream>
#include <limits>
#include <memory>
#include <string>

#include "reference/view.hpp"

namespace {

using namespace reference;

struct Outcome {
    int status = -1;
    std::string output;

    /// The count in the row that begins with `name`; -1 if there is no such row.
    long count(const std::string& name) const {
        const std::size_t at = output.find("  " + name + " ");
        return at == std::string::npos ? -1 : std::strtol(output.c_str() + at + 2 + name.size(), nullptr, 10);
    }
};

class CheckView : public testing::Test {
protected:
    CheckView() : view(make_view(triangles, camera, light)) {}

    std::string path(const std::string& name) const {
        const auto* test = testing::UnitTest::GetInstance()->current_test_info();
        return (std::filesystem::temp_directory_path() / ("check_view_" + std::string(test->name()) + "_" + name))
            .string();
    }

    void write_files(OIIO::TypeDesc receiver_type = OIIO::TypeUInt32) const {
        std::ofstream(path("triangles.bin"), std::ios::binary)
            .write(reinterpret_cast<const char*>(triangles.data()), static_cast<std::streamsize>(4 * triangles.size()));
        OIIO::ImageSpec spec(int(camera.width), int(camera.height), 8, OIIO::TypeFloat);
        spec.channelnames = {"visibility", "receiver", "P.Z", "P.Y", "P.X", "N.X", "N.Y", "N.Z"};
        spec.channelformats.assign(8, OIIO::TypeFloat);
        spec.channelformats[1] = receiver_type;
        struct Pixel {
            float visibility;
            std::uint32_t receiver;
            float position[3], normal[3];
        };
        std::vector<Pixel> pixels(view.receiver.size());
        for (std::size_t i = 0; i < pixels.size(); ++i)
            pixels[i] = {view.visibility[i],
                         view.receiver[i],
                         {view.position[3 * i + 2], view.position[3 * i + 1], view.position[3 * i]},
                         {view.normal[3 * i], view.normal[3 * i + 1], view.normal[3 * i + 2]}};
        const auto output = OIIO::ImageOutput::create(path("view.exr"));
        ASSERT_TRUE(output && output->open(path("view.exr"), spec)) << OIIO::geterror();
        ASSERT_TRUE(output->write_image(OIIO::TypeUnknown, pixels.data())) << output->geterror();
        ASSERT_TRUE(output->close());
    }

    void write_samples() const {
        std::ofstream file(path("points.bin"), std::ios::binary);
        for (std::size_t i = 0; i < view.sample_receiver.size(); ++i) {
            file.write(reinterpret_cast<const char*>(&view.sample_position[3 * i]), 12);
            file.write(reinterpret_cast<const char*>(&view.sample_receiver[i]), 4);
        }
    }

    Outcome judge_samples(std::uint32_t samples = 8) const {
        write_samples();
        return judge(std::string(CAMERA_AND_LIGHT) + " --samples " + std::to_string(samples) + " --points " +
                     path("points.bin"));
    }

    /// A pixel with samples on its own receiver, which is the floor, and on another.
    std::size_t pixel_on_several() const {
        for (std::size_t i = 0; i < view.receiver.size(); ++i)
            for (std::size_t k = i; k < view.sample_receiver.size(); k += view.receiver.size())
                if (view.receiver[i] < 2 && view.sample_receiver[k] == 2) return i;
        throw std::logic_error("no pixel does");
    }

    /// The number of a pixel's sample on this receiver.
    std::size_t sample_on(std::uint32_t receiver, std::size_t pixel) const {
        for (std::size_t k = pixel; k < view.sample_receiver.size(); k += view.receiver.size())
            if (view.sample_receiver[k] == receiver) return k;
        throw std::logic_error("no sample is");
    }

    Outcome run(const std::string& arguments) const {
        const std::string command = std::string(CHECK_VIEW) + " " + arguments + " 2>&1";
        Outcome outcome;
        FILE* pipe = popen(command.c_str(), "r");
        char buffer[4096];
        for (std::size_t size; (size = fread(buffer, 1, sizeof buffer, pipe)) > 0;) outcome.output.append(buffer, size);
        const int status = pclose(pipe);
        outcome.status = WIFEXITED(status) ? WEXITSTATUS(status) : -1;
        return outcome;
    }

    std::string files() const { return "--triangles " + path("triangles.bin") + " --aov " + path("view.exr"); }

    static constexpr const char* CAMERA_AND_LIGHT =
        " --eye -3,4,8 --target -.5,1,0 --fovy 60 --light-direction -.25,-1,-.125";
    Outcome judge(const std::string& camera_and_light = CAMERA_AND_LIGHT) const {
        write_files();
        return run(files() + camera_and_light);
    }

    /// The roof is of a material with one texel of this alpha; `triangles_claimed` says how many there are.
    void write_masks(std::uint8_t alpha, std::uint32_t triangles_claimed = 3) const {
        std::ofstream file(path("masks.bin"), std::ios::binary);
        const auto write = [&](const auto& values) {
            file.write(reinterpret_cast<const char*>(values.data()),
                       static_cast<std::streamsize>(values.size() * sizeof values[0]));
        };
        write(std::vector<std::uint32_t>{1, 1, triangles_claimed});
        write(std::vector<std::int32_t>{0, 0, 1, 1});
        write(std::vector<float>{0.5f, 1});
        write(std::vector<std::uint32_t>{1, 1});
        write(std::vector<std::uint8_t>{alpha});
        write(std::vector<std::int32_t>{-1, -1, 0});
        write(std::vector<float>(3 * 9, 1.0f));
    }

    std::size_t pixel_on(std::uint32_t receiver) const {
        for (std::size_t i = 0; i < view.receiver.size(); ++i)
            if (view.receiver[i] == receiver) return i;
        throw std::logic_error("no pixel sees it");
    }

    void TearDown() override {
        std::filesystem::remove(path("triangles.bin"));
        std::filesystem::remove(path("view.exr"));
        std::filesystem::remove(path("masks.bin"));
        std::filesystem::remove(path("points.bin"));
    }

    // A floor of two, and a roof.
    std::vector<float> triangles{-9, 0, -9, 9,  0,  -9, -9, 0, 9, 9,  0, 9, -9, 0,
                                 9,  9, 0,  -9, -3, 2,  -3, 3, 2, -3, 0, 2, 3};
    PinholeCamera camera{{-3, 4, 8}, {-0.5f, 1, 0}, {0, 1, 0}, 60, 40, 30};
    std::array<float, 4> light{0.25f, 1, 0.125f, 0};
    View view;
};

TEST_F(CheckView, RightViewPasses) {
    const Outcome outcome = judge();
    EXPECT_EQ(outcome.status, 0) << outcome.output;
    EXPECT_NE(outcome.output.find("right: nothing wrong"), std::string::npos);
    EXPECT_EQ(outcome.count("WRONG visibility"), 0);
    EXPECT_GT(outcome.count("shadowed"), 10);
    EXPECT_GT(outcome.count("lit"), 100);
    EXPECT_GT(outcome.count("sky"), 10);
}

TEST_F(CheckView, NegativeValuesWorkWithAndWithoutEqualsSign) {
    write_files();
    for (const char* rest : {" --eye=-3,4,8 --target=-.5,1,0 --fovy=60 --light-direction=-.25,-1,-.125",
                             " --eye -3,4,8 --target -.5,1,0 --fovy 60 --light-direction -.25,-1,-.125",
                             " --light-direction -2.5e-1,-1,-0.125 --eye -3.0,4,8 --target -5e-1,1,0 --up -0,1,0 "
                             "--fovy 60 --sample 9999"}) {
        const Outcome outcome = run(files() + rest);
        EXPECT_EQ(outcome.status, 0) << rest << "\n" << outcome.output;
    }
}

TEST_F(CheckView, FlippedVisibilityIsFound) {
    const std::size_t pixel = pixel_on(0);
    view.visibility[pixel] = 1 - view.visibility[pixel];
    const Outcome outcome = judge();
    EXPECT_EQ(outcome.status, 1);
    EXPECT_EQ(outcome.count("WRONG visibility"), 1);
    char place[64];
    std::snprintf(place, sizeof place, "(%zu,%zu)", pixel % camera.width, pixel / camera.width);
    EXPECT_NE(outcome.output.find(place), std::string::npos) << outcome.output;
}

TEST_F(CheckView, PointMovedByFortyUlpIsFound) {
    const std::size_t pixel = pixel_on(0);
    // Along the floor, so that nothing but the distance is wrong; 8 is the largest coordinate of P and eye.
    view.position[3 * pixel] += 40 * 0x1p-20f;
    ASSERT_EQ(ulp_at({view.position[3 * pixel], 0, view.position[3 * pixel + 2]}, camera.eye), 0x1p-20L);
    const Outcome outcome = judge();
    EXPECT_EQ(outcome.status, 1);
    EXPECT_EQ(outcome.count("WRONG distance to the hit (c)"), 1) << outcome.output;
    EXPECT_EQ(outcome.count("WRONG nearest triangle (a)"), 0);
    EXPECT_EQ(outcome.count("WRONG side of the plane (b)"), 0);
}

TEST_F(CheckView, PointUnderItsPlaneIsFound) {
    const std::size_t pixel = pixel_on(0);
    view.position[3 * pixel + 1] = -0x1p-30f;
    const Outcome outcome = judge();
    EXPECT_EQ(outcome.status, 1);
    EXPECT_EQ(outcome.count("WRONG side of the plane (b)"), 1) << outcome.output;
    EXPECT_EQ(outcome.count("WRONG distance to the hit (c)"), 0);
}

TEST_F(CheckView, OtherReceiverIsFound) {
    view.receiver[pixel_on(0)] = 2;
    const Outcome outcome = judge();
    EXPECT_EQ(outcome.status, 1);
    EXPECT_EQ(outcome.count("WRONG nearest triangle (a)"), 1) << outcome.output;
}

TEST_F(CheckView, ReceiversKeepAllTheirBits) {
    // As a float this would become 4294967296 and pass for the sky.
    view.receiver[pixel_on(NO_RECEIVER)] = NO_RECEIVER - 1;
    const Outcome outcome = judge();
    EXPECT_EQ(outcome.status, 1);
    EXPECT_EQ(outcome.count("WRONG nearest triangle (a)"), 1) << outcome.output;
}

TEST_F(CheckView, SkyWhereThereIsATriangleIsFound) {
    const std::size_t pixel = pixel_on(0);
    view.receiver[pixel] = NO_RECEIVER;
    view.visibility[pixel] = 1;
    for (std::size_t k = 0; k < 3; ++k) view.position[3 * pixel + k] = view.normal[3 * pixel + k] = 0;
    const Outcome outcome = judge();
    EXPECT_EQ(outcome.status, 1);
    EXPECT_EQ(outcome.count("WRONG nearest triangle (a)"), 1) << outcome.output;
    EXPECT_EQ(outcome.count("WRONG sky"), 0);
}

TEST_F(CheckView, OtherLightAndOtherCameraAreFound) {
    EXPECT_EQ(judge(" --eye -3,4,8 --target -.5,1,0 --fovy 60 --light-direction .25,-1,-.125").status, 1);
    EXPECT_EQ(judge(" --eye -3,4,8 --target -.5,1,0 --fovy 60.001 --light-direction -.25,-1,-.125").status, 1);
    EXPECT_EQ(judge(" --eye -3,4,8 --target -.5,1,0 --fovy 60 --light-position .25,1,.125").status, 1);
}

TEST_F(CheckView, MasksAreTaken) {
    const std::string camera_and_light = " --eye -3,4,8 --target -.5,1,0 --fovy 60 --light-direction -.25,-1,-.125";
    const std::string with_masks = camera_and_light + " --masks " + path("masks.bin");
    write_masks(128);  // 127.5 is the threshold
    EXPECT_EQ(judge(with_masks).status, 0);
    write_masks(127);
    EXPECT_EQ(judge(with_masks).status, 1) << "the roof is not to be seen";
    std::vector<float> floor_alone = triangles;
    std::fill(floor_alone.end() - 9, floor_alone.end(), std::numeric_limits<float>::quiet_NaN());
    view = make_view(floor_alone, camera, light);
    EXPECT_EQ(judge(with_masks).status, 0);
    EXPECT_EQ(judge(camera_and_light).status, 1);
    write_masks(127, 4);
    Outcome outcome = judge(with_masks);
    EXPECT_EQ(outcome.status, 2);
    EXPECT_NE(outcome.output.find("has masks for 4 triangles, not for 3"), std::string::npos) << outcome.output;
    write_masks(127);
    std::filesystem::resize_file(path("masks.bin"), 100);
    outcome = run(files() + with_masks);
    EXPECT_EQ(outcome.status, 2);
    EXPECT_NE(outcome.output.find("is too short"), std::string::npos) << outcome.output;
}

TEST_F(CheckView, RightSamplesPass) {
    for (const std::uint32_t samples : {4u, 8u, 16u, 32u}) {
        view = make_view(triangles, camera, light, samples);
        const Outcome outcome = judge_samples(samples);
        EXPECT_EQ(outcome.status, 0) << outcome.output;
        EXPECT_EQ(outcome.count("samples judged"), long(samples * camera.width * camera.height));
        EXPECT_GT(outcome.count("samples on others"), 20) << outcome.output;
        EXPECT_GT(outcome.count("samples of sky"), 20);
        EXPECT_GT(outcome.count("pixels partly lit"), 10);
    }
}

TEST_F(CheckView, EveryWrongSampleIsFound) {
    const View right = make_view(triangles, camera, light, 8);
    const auto expect_wrong = [&](const char* row, long count) {
        const Outcome outcome = judge_samples();
        EXPECT_EQ(outcome.status, 1) << row;
        EXPECT_EQ(outcome.count(row), count) << outcome.output;
        view = right;
    };
    view = right;
    const std::size_t pixel = pixel_on_several(), roof = sample_on(2, pixel);
    view.visibility[pixel_on(0)] -= 0.125f;  // one sample's shadow
    expect_wrong("WRONG visibility", 1);
    view.sample_receiver[roof] = NO_RECEIVER;
    expect_wrong("WRONG nearest, samples (a)", 1);
    view.sample_receiver[roof] = 1 - view.receiver[pixel];
    expect_wrong("WRONG nearest, samples (a)", 1);
    // What the sample's ray does not meet, and what it meets behind the pixel's receiver.
    view.sample_receiver[sample_on(view.receiver[pixel], pixel)] = 2;
    expect_wrong("WRONG nearest, samples (a)", 1);
    view.sample_receiver[sample_on(2, pixel_on(2))] = 0;
    expect_wrong("WRONG nearest, samples (a)", 1);
    view.sample_receiver[sample_on(NO_RECEIVER, pixel_on(NO_RECEIVER))] = 0;
    expect_wrong("WRONG nearest, samples (a)", 1);
    view.sample_position[3 * sample_on(0, pixel_on(0)) + 1] = -0x1p-30f;
    expect_wrong("WRONG side, samples (b)", 1);
    view.sample_position[3 * sample_on(0, pixel_on(0))] += 40 * 0x1p-20f;
    expect_wrong("WRONG distance, samples (c)", 1);
    // Two samples of a pixel in each other's place, as if the pattern's order were another.
    const std::size_t on_floor = view.receiver.size() - 20;  // in the middle of the last row
    for (std::size_t k = 0; k < 3; ++k)
        std::swap(view.sample_position[3 * on_floor + k], view.sample_position[3 * (on_floor + 1200) + k]);
    expect_wrong("WRONG distance, samples (c)", 2);
    view.sample_position[3 * sample_on(NO_RECEIVER, pixel_on(NO_RECEIVER))] = 1;
    for (std::size_t k = 1; k < 3; ++k) view.sample_position[3 * sample_on(NO_RECEIVER, pixel_on(NO_RECEIVER)) + k] = 1;
    expect_wrong("WRONG sky", 1);
    write_samples();
    for (const std::string& rest :
         {std::string(" --samples 8"), " --points " + path("points.bin"), " --samples 7 --points " + path("points.bin"),
          " --samples 4 --points " + path("points.bin")})
        EXPECT_EQ(judge(CAMERA_AND_LIGHT + rest).status, 2) << rest;
}

TEST_F(CheckView, WhatCannotBeJudgedIsSaidInOneSentence) {
    const std::string camera_and_light = " --eye -3,4,8 --target 0,1,0 --fovy 60 --light-direction 0,-1,0";
    write_files(OIIO::TypeFloat);
    Outcome outcome = run(files() + camera_and_light);
    EXPECT_EQ(outcome.status, 2);
    EXPECT_NE(outcome.output.find("channel 'receiver' is float, not uint"), std::string::npos) << outcome.output;
    outcome = run("--triangles /nowhere.bin --aov " + path("view.exr") + camera_and_light);
    EXPECT_EQ(outcome.status, 2);
    EXPECT_NE(outcome.output.find("cannot open /nowhere.bin"), std::string::npos) << outcome.output;
    outcome = run("--triangles " + path("triangles.bin") + " --aov /nowhere.exr" + camera_and_light);
    EXPECT_EQ(outcome.status, 2);
    outcome = run(files() + " --eye 1,2 --target 0,1,0 --fovy 60 --light-direction 0,-1,0");
    EXPECT_EQ(outcome.status, 2);
    EXPECT_NE(outcome.output.find("--eye must be three finite numbers"), std::string::npos) << outcome.output;
    EXPECT_EQ(run(files() + " --eye 1,2,3 --target 0,1,0 --fovy 60").status, 2) << "no light";
    EXPECT_EQ(run("--help").status, 0);
}

}  // namespace
