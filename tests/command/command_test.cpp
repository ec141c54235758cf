// SPDX-License-Identifier: MIT
// The command gnomon, run as a user runs it: the real binary, in a temporary folder, on whatever OpenCL device there
// is. Checked are exit codes, sentences, the files and what is in them. The picture's shadows are those of a scene
// simple enough to know the answer: a square above a floor under a light that falls straight down, where a floor point
// is in shadow exactly if its x and z lie in the square.
#include <OpenImageIO/imageio.h>
#include <fcntl.h>
#include <gtest/gtest.h>
#include <signal.h>
#include <stdlib.h>
#include <sys/stat.h>
#include <sys/wait.h>
#include <unistd.h>

#include <algorithm>
#include <array>
#include <chrono>
#include <cmath>
#include <cstdint>
#include <cstring>
#include <filesystem>
#include <fstream>
#include <functional>
#include <limits>
#include <map>
#include <nlohmann/json.hpp>
#include <regex>
#include <sstream>
#include <string>
#include <thread>
#include <vector>

#include "support/srgb.hpp"
#include "support/temporary_folder.hpp"

namespace {

namespace fs = std::filesystem;
using Arguments = std::vector<std::string>;

// ---- Running the command --------------------------------------------------------------------------------------------

struct Outcome {
    int exit_code = -1;  // -1: ended by a signal
    int signal_number = 0;
    std::string out, err;
};

struct RunOptions {
    std::map<std::string, std::string> environment;
    std::string stdout_to, stderr_to;  ///< a file instead of `out` and `err`
};

/// Lines that say how long a slow step takes: on a slow machine any command may have some.
const std::regex progress("gnomon: [^\n]* \\.\\.\\. [0-9]+ s\n");

std::string text_of(const fs::path& file) {
    std::ifstream stream(file, std::ios::binary);
    return {std::istreambuf_iterator<char>(stream), std::istreambuf_iterator<char>()};
}

/// A folder that lives as long as the test, with the command started inside it.
class Command : public testing::Test {
protected:
    void SetUp() override { fs::create_directory(folder_); }

    fs::path in_folder(const std::string& name) const { return folder_ / name; }

    std::vector<std::string> files() const {
        std::vector<std::string> names;
        for (const auto& entry : fs::directory_iterator(folder_)) names.push_back(entry.path().filename().string());
        std::sort(names.begin(), names.end());
        return names;
    }

    pid_t start(const Arguments& arguments, const RunOptions& options = {}) const {
        std::vector<std::string> words{program_};
        words.insert(words.end(), arguments.begin(), arguments.end());
        std::vector<char*> argv;
        for (std::string& word : words) argv.push_back(word.data());
        argv.push_back(nullptr);
        const std::string out = options.stdout_to.empty() ? (root_ / "stdout").string() : options.stdout_to;
        const std::string err = options.stderr_to.empty() ? (root_ / "stderr").string() : options.stderr_to;
        const pid_t child = fork();
        if (child != 0) return child;
        for (const auto& [name, value] : options.environment) setenv(name.c_str(), value.c_str(), 1);
        const bool ready = chdir(folder_.c_str()) == 0 &&
                           dup2(open(out.c_str(), O_WRONLY | O_CREAT | O_TRUNC, 0600), STDOUT_FILENO) >= 0 &&
                           dup2(open(err.c_str(), O_WRONLY | O_CREAT | O_TRUNC, 0600), STDERR_FILENO) >= 0;
        if (ready) execv(argv[0], argv.data());
        _exit(127);
    }

    Outcome finish(pid_t child) const {
        int status = 0;
        EXPECT_EQ(waitpid(child, &status, 0), child);
        Outcome outcome;
        if (WIFEXITED(status)) outcome.exit_code = WEXITSTATUS(status);
        if (WIFSIGNALED(status)) outcome.signal_number = WTERMSIG(status);
        outcome.out = text_of(root_ / "stdout");
        outcome.err = std::regex_replace(text_of(root_ / "stderr"), progress, "");
        return outcome;
    }

    Outcome run(const Arguments& arguments, const RunOptions& options = {}) const {
        return finish(start(arguments, options));
    }

    /// `gnomon render` that must succeed without a word.
    void render_quietly(Arguments arguments) const {
        arguments.insert(arguments.begin(), "render");
        arguments.emplace_back("--quiet");
        const Outcome outcome = run(arguments);
        EXPECT_EQ(outcome.exit_code, 0) << outcome.err;
        EXPECT_EQ(outcome.out, "");
        EXPECT_EQ(outcome.err, "");
    }

    /// A failure: this exit code, one line on stderr with this in it, nothing on stdout, no file left or changed.
    void expect_failure(const Arguments& arguments, int exit_code, const std::string& sentence,
                        const RunOptions& options = {}) const {
        const std::vector<std::string> before = files();
        const Outcome outcome = run(arguments, options);
        std::string line = "gnomon";
        for (const std::string& argument : arguments) line += " " + argument;
        SCOPED_TRACE(line);
        EXPECT_EQ(outcome.exit_code, exit_code);
        EXPECT_EQ(outcome.err.rfind("gnomon: error: ", 0), 0u) << outcome.err;
        EXPECT_NE(outcome.err.find(sentence), std::string::npos) << outcome.err;
        EXPECT_EQ(std::count(outcome.err.begin(), outcome.err.end(), '\n'), 1) << outcome.err;
        EXPECT_EQ(outcome.out, "");
        EXPECT_EQ(files(), before);
    }

    nlohmann::json statistics(const std::string& name) const { return nlohmann::json::parse(text_of(in_folder(name))); }

    const support::TemporaryFolder made_;
    const fs::path root_ = made_.path(), folder_ = root_ / "here";
    fs::path program_ = GNOMON_BINARY;
};

// ---- A scene with a known answer ------------------------------------------------------------------------------------

/// Floor (triangles 0 and 1) with corners at +-4, square (2 and 3) with corners at +-0.5 one above it.
std::vector<float> floor_and_square() {
    std::vector<float> vertices;
    for (const auto& [half, height] : {std::pair{4.0f, 0.0f}, std::pair{0.5f, 1.0f}}) {
        const std::array<std::array<float, 2>, 6> corners{
            {{-half, -half}, {-half, half}, {half, half}, {-half, -half}, {half, half}, {half, -half}}};
        for (const auto& corner : corners) vertices.insert(vertices.end(), {corner[0], height, corner[1]});
    }
    return vertices;
}

/// Writes `vertices` as NAME.gltf and NAME.bin, with the cameras "above" and "aside", and the lights "sun" (falls
/// straight down) and "lamp" (a point).
void write_scene(const fs::path& folder, const std::string& name, const std::vector<float>& vertices,
                 const std::string& alpha_mode = "OPAQUE") {
    const std::size_t bytes = vertices.size() * sizeof(float);
    std::ofstream bin(folder / (name + ".bin"), std::ios::binary);
    bin.write(reinterpret_cast<const char*>(vertices.data()), std::streamsize(bytes));
    const double half = std::sqrt(0.5);
    const nlohmann::json down = {-half, 0.0, 0.0, half};  // turns -Z to -Y
    const nlohmann::json lens = {{"type", "perspective"}, {"perspective", {{"yfov", 0.9}, {"znear", 0.01}}}};
    const nlohmann::json lights = {{{"name", "sun"}, {"type", "directional"}}, {{"name", "lamp"}, {"type", "point"}}};
    const auto light = [](int index) { return nlohmann::json{{"KHR_lights_punctual", {{"light", index}}}}; };
    const nlohmann::json gltf = {
        {"asset", {{"version", "2.0"}}},
        {"extensionsUsed", {"KHR_lights_punctual"}},
        {"extensions", {{"KHR_lights_punctual", {{"lights", lights}}}}},
        {"scene", 0},
        {"scenes", {{{"nodes", {0, 1, 2, 3, 4}}}}},
        {"nodes",
         {{{"mesh", 0}},
          {{"name", "above"}, {"camera", 0}, {"translation", {0, 6, 0}}, {"rotation", down}},
          {{"name", "aside"}, {"camera", 0}, {"translation", {0, 1, 9}}},
          {{"name", "sun"}, {"rotation", down}, {"extensions", light(0)}},
          {{"name", "lamp"}, {"translation", {0.25, 3.5, -0.125}}, {"extensions", light(1)}}}},
        {"cameras", {lens}},
        {"materials", {{{"alphaMode", alpha_mode}}}},
        {"meshes", {{{"primitives", {{{"attributes", {{"POSITION", 0}}}, {"material", 0}}}}}}},
        {"buffers", {{{"uri", name + ".bin"}, {"byteLength", bytes}}}},
        {"bufferViews", {{{"buffer", 0}, {"byteOffset", 0}, {"byteLength", bytes}}}},
        {"accessors",
         {{{"bufferView", 0},
           {"componentType", 5126},
           {"count", vertices.size() / 3},
           {"type", "VEC3"},
           {"min", {-4, 0, -4}},
           {"max", {4, 1, 4}}}}},
    };
    std::ofstream(folder / (name + ".gltf")) << gltf.dump(1);
}

// ---- Reading pictures back ------------------------------------------------------------------------------------------

struct Bytes {
    OIIO::ImageSpec spec;
    std::vector<std::uint8_t> values;
};

Bytes read_bytes(const fs::path& file) {
    const auto input = OIIO::ImageInput::open(file.string());
    if (!input) throw std::runtime_error("not a picture: " + file.string());
    Bytes picture{input->spec(), std::vector<std::uint8_t>(input->spec().image_bytes())};
    if (!input->read_image(0, 0, 0, picture.spec.nchannels, OIIO::TypeUInt8, picture.values.data()))
        throw std::runtime_error(input->geterror());
    return picture;
}

/// Width, height and channels.
std::array<int, 3> shape(const OIIO::ImageSpec& spec) { return {spec.width, spec.height, spec.nchannels}; }

struct Pixel {
    std::array<float, 3> position{}, normal{}, albedo{}, shading_normal{};
    float visibility = -1;
    std::uint32_t receiver = 0;
};

/// Reads the channels by name, each in its own format, without conversion.
std::vector<Pixel> read_aov(const fs::path& file, const std::string& value = "visibility") {
    const auto input = OIIO::ImageInput::open(file.string());
    if (!input) throw std::runtime_error("not a picture: " + file.string());
    const OIIO::ImageSpec spec = input->spec();
    const bool has_surfaces = value == "visibility";
    EXPECT_EQ(spec.nchannels, has_surfaces ? 14 : 8);
    EXPECT_EQ(spec.get_string_attribute("compression"), "zip");
    std::vector<char> native(spec.image_bytes(true));
    if (!input->read_image(0, 0, 0, spec.nchannels, OIIO::TypeUnknown, native.data()))
        throw std::runtime_error(input->geterror());
    const std::size_t pixel_bytes = spec.pixel_bytes(true);
    EXPECT_EQ(pixel_bytes, has_surfaces ? 56u : 32u);
    std::vector<Pixel> pixels(std::size_t(spec.width) * std::size_t(spec.height));
    const auto take = [&](const std::string& channel, OIIO::TypeDesc type, auto&& place_of) {
        const int index = spec.channelindex(channel);
        ASSERT_GE(index, 0) << channel;
        EXPECT_EQ(spec.channelformat(index), type) << channel;
        for (std::size_t i = 0; i < pixels.size(); ++i)
            std::memcpy(place_of(pixels[i]), &native[i * pixel_bytes + std::size_t(index) * 4], 4);
    };
    const std::array<std::string, 3> axes{"X", "Y", "Z"};
    for (std::size_t c = 0; c < 3; ++c) {
        take("P." + axes[c], OIIO::TypeFloat, [c](Pixel& pixel) { return &pixel.position[c]; });
        take("N." + axes[c], OIIO::TypeFloat, [c](Pixel& pixel) { return &pixel.normal[c]; });
    }
    const std::array<std::string, 3> colors{"R", "G", "B"};
    for (std::size_t c = 0; c < 3 && has_surfaces; ++c) {
        take("albedo." + colors[c], OIIO::TypeFloat, [c](Pixel& pixel) { return &pixel.albedo[c]; });
        take("Ns." + axes[c], OIIO::TypeFloat, [c](Pixel& pixel) { return &pixel.shading_normal[c]; });
    }
    take(value, OIIO::TypeFloat, [](Pixel& pixel) { return &pixel.visibility; });
    take("receiver", OIIO::TypeUInt32, [](Pixel& pixel) { return &pixel.receiver; });
    return pixels;
}

constexpr std::uint32_t sky = 4294967295u;

double dot(const std::array<float, 3>& a, const std::array<float, 3>& b) {
    return double(a[0]) * b[0] + double(a[1]) * b[1] + double(a[2]) * b[2];
}

// ---- Help, version, lists -------------------------------------------------------------------------------------------

TEST_F(Command, WithoutArgumentsItPrintsTheHelp) {
    const Outcome bare = run({}), help = run({"--help"});
    EXPECT_EQ(bare.exit_code, 0);
    EXPECT_EQ(help.exit_code, 0);
    EXPECT_EQ(bare.out, help.out);
    for (const char* command : {"render", "explain", "devices", "techniques"})
        EXPECT_NE(help.out.find(command), std::string::npos) << command;
}

TEST_F(Command, HelpNamesEveryOption) {
    const Outcome help = run({"render", "--help"});
    EXPECT_EQ(help.exit_code, 0);
    for (const char* option : {"-o,",
                               "--size",
                               "--camera",
                               "--eye",
                               "--target",
                               "--up",
                               "--fovy",
                               "--light-direction",
                               "--light-position",
                               "--light ",
                               "--mask",
                               "--aov",
                               "--dump-triangles",
                               "--dump-points",
                               "--scene",
                               "--time",
                               "--animation",
                               "--frames",
                               "--fps",
                               "--samples",
                               "--technique",
                               "--set",
                               "--conservative-map",
                               "--map-size",
                               "--device",
                               "--memory-limit",
                               "--strict",
                               "--stats",
                               "--profile",
                               "--quiet"})
        EXPECT_NE(help.out.find(option), std::string::npos) << option;
}

TEST_F(Command, VersionIsThreeNumbers) {
    const Outcome version = run({"--version"});
    EXPECT_EQ(version.exit_code, 0);
    int major = -1, minor = -1, patch = -1, read = 0;
    EXPECT_EQ(std::sscanf(version.out.c_str(), "gnomon %d.%d.%d\n%n", &major, &minor, &patch, &read), 3) << version.out;
    EXPECT_EQ(std::size_t(read), version.out.size());
}

TEST_F(Command, DevicesSaysWhichIsTheDefault) {
    const Outcome devices = run({"devices"});
    EXPECT_EQ(devices.exit_code, 0) << devices.err;
    EXPECT_EQ(devices.out.find("0:0"), 0u) << devices.out;
    EXPECT_NE(devices.out.find("the default: "), std::string::npos) << devices.out;
}

TEST_F(Command, TheCheckOfADeviceIsJsonForPrograms) {
    const Outcome check = run({"devices", "--check", "--json"});
    EXPECT_EQ(check.exit_code, 0) << check.err;
    const auto json = nlohmann::json::parse(check.out);
    EXPECT_EQ(json["wrong"], 0);
    std::uint64_t points = 0;
    for (const auto& answer : json["answers"]) {
        EXPECT_EQ(answer["right"], true) << answer["what"];
        points += answer["points"].get<std::uint64_t>();
    }
    EXPECT_EQ(json["points"], points);
    EXPECT_GT(points, 2'000'000u);
    EXPECT_FALSE(json["device"]["driver_version"].get<std::string>().empty());
    EXPECT_GT(json["speed"]["shadows_ms"], 0.0);
}

// Eight views of the golden record, animated and prepared; the page and the file say the same.
TEST_F(Command, BenchComparesWithTheGoldenRecordAndWritesAFileToSend) {
    const Outcome bench = run({"bench", "--seconds", "1", "-o", in_folder("bench.json").string()});
    EXPECT_EQ(bench.exit_code, 0) << bench.err;
    const auto json = statistics("bench.json");
    std::size_t known = 0;
    for (const auto& row : json["rows"]) {
        known += row["experiment"] == "known" ? 1 : 0;
        EXPECT_EQ(row["right"], true) << row["scene"];
        EXPECT_NE(bench.out.find(row["mask_hash"].get<std::string>()), std::string::npos) << row["scene"];
    }
    EXPECT_EQ(known, 16u);
    EXPECT_EQ(json["wrong"], 0);
    EXPECT_NE(bench.out.find("297ad812ba97d535"), std::string::npos) << "city_v0_sun of the golden record";
    EXPECT_NE(bench.out.find("RIGHT"), std::string::npos);
}

TEST_F(Command, TechniquesAreALineEachAndTellTheirSettings) {
    const Outcome list = run({"techniques"});
    EXPECT_EQ(list.exit_code, 0) << list.err;
    EXPECT_EQ(list.out.find("frustum-traced"), 0u) << list.out;
    EXPECT_EQ(list.out.find("--set"), std::string::npos) << list.out;
    for (const Arguments& arguments :
         {Arguments{"techniques", "--verbose"}, Arguments{"techniques", "frustum-traced"}}) {
        const Outcome settings = run(arguments);
        EXPECT_EQ(settings.exit_code, 0) << settings.err;
        EXPECT_NE(settings.out.find("--set map-size="), std::string::npos) << settings.out;
        EXPECT_NE(settings.out.find("--set conservative-map="), std::string::npos) << settings.out;
    }
}

TEST_F(Command, SaysSoWhenTheStandardOutputIsFull) {
    for (const Arguments& arguments : {Arguments{"--help"}, Arguments{"techniques"}}) {
        const Outcome outcome = run(arguments, {{}, "/dev/full", ""});
        EXPECT_EQ(outcome.exit_code, 1);
        EXPECT_NE(outcome.err.find("gnomon: error: cannot write to the standard output"), std::string::npos);
    }
}

// ---- Wrong command lines (exit code 2) ------------------------------------------------------------------------------

TEST_F(Command, WrongCommandLines) {
    struct Wrong {
        Arguments arguments;
        const char* sentence;
    };
    const std::vector<Wrong> all{
        {{"paint"}, "unexpected argument: paint"},
        {{"--paint"}, "unexpected argument: --paint"},
        {{"devices", "now"}, "unexpected argument: now"},
        {{"devices", "--json"}, "--json requires --check"},
        {{"bench", "--seconds", "0"}, "--seconds needs"},
        {{"bench", "-o", "bench.txt"}, "ends in .json"},
        {{"render"}, "nothing to write"},
        {{"render", "-o"}, "--output needs a value"},
        {{"render", "-o", "a.bmp"}, "--output needs a file name that ends in .png"},
        {{"render", "-o", "a"}, "ends in .png"},
        {{"render", "-o", "a.png", "--mask", "m.exr"}, "--mask needs a file name that ends in .png"},
        {{"render", "-o", "a.png", "--aov", "m.png"}, "--aov needs a file name that ends in .exr"},
        {{"render", "-o", "a.png", "--mask", "--quiet"}, "--mask needs a file name"},
        {{"render", "-o", "a.png", "--stats="}, "--stats= has no value"},
        {{"render", "-o", "a.png", "--paint"}, "unexpected argument: --paint"},
        {{"render", "a.glb", "--paint", "3", "-o", "a.png"}, "unexpected argument: --paint 3 (see --help)"},
        {{"render", "-o", "a.png", "one.glb", "two.glb"}, "unexpected argument: two.glb"},
        {{"render", "-o", "a.png", "--exposure", "bright"}, "--exposure needs"},
        {{"render", "-o", "a.png", "--exposure", "31"}, "--exposure needs auto or a number from -30 to 30"},
        {{"render", "--mask", "a.png", "--exposure", "1"}, "--exposure is for the picture"},
        {{"render", "--mask", "a.png", "--ambient", "sky"}, "--ambient is for the picture"},
        {{"render", "-o", "a.png", "--ambient", "blue"}, "--ambient needs constant, sky or sky:N"},
        {{"render", "-o", "a.png", "--ambient", "sky:17"}, "--ambient needs"},
        {{"render", "-o", "a.png", "--size", "0x0"}, "--size needs"},
        {{"render", "-o", "a.png", "--size", "0x5"}, "--size needs"},
        {{"render", "-o", "a.png", "--size", "16385x1"}, "from 1 to 16384"},
        {{"render", "-o", "a.png", "--size", "1x16385"}, "from 1 to 16384"},
        {{"render", "-o", "a.png", "--samples", "2"}, "--samples needs 1, 4, 8, 16 or 32, not \"2\""},
        {{"render", "-o", "a.png", "--samples", "64"}, "--samples needs"},
        {{"render", "-o", "a.png", "--sun-angle", "90"}, "--sun-angle needs degrees above 0 and below 90"},
        {{"render", "-o", "a.png", "--sun-samples", "4"}, "--sun-samples requires --sun-angle"},
        {{"render", "-o", "a.png", "--sun-angle", "1", "--diagnostic", "decided"}, "--sun-angle excludes --diagnostic"},
        {{"render", "-o", "a.png", "--area-light", "0,1,0,1,0,0"}, "--area-light needs nine finite numbers"},
        {{"render", "-o", "a.png", "--area-samples", "9"}, "--area-samples requires --area-light"},
        {{"render", "-o", "a.png", "--area-light", "0,1,0,1,0,0,0,0,1", "--samples", "4"}, "leave out --samples"},
        {{"render", "-o", "a.png", "--area-light", "0,1,0,1,0,0,0,0,1", "--light", "0"},
         "--area-light excludes --light"},
        {{"render", "-o", "a.png", "--area-light", "0,1,0,1,0,0,0,0,1", "--sun-angle", "1"},
         "--area-light excludes --sun-angle"},
        {{"render", "-o", "a.png", "--area-light", "0,1,0,1,0,0,0,0,1", "--diagnostic", "decided"},
         "--area-light excludes --diagnostic"},
        {{"gallery", "--sun-samples", "9"}, "--sun-samples requires --sun-angle"},
        {{"gallery", "--area-light", "0,1,0,1,0,0,0,0,1"}, "unexpected argument: --area-light"},
        {{"render", "-o", "a.png", "--size", "64"}, "--size needs"},
        {{"render", "-o", "a.png", "--size", "64x64x64"}, "--size needs"},
        {{"render", "-o", "a.png", "--size", "64 64"}, "--size needs"},
        {{"render", "-o", "a.png", "--size", "-64x64"}, "--size needs"},
        {{"render", "-o", "a.png", "--size", "99999999999999999999x1"}, "--size needs"},
        {{"render", "-o", "a.png", "--eye", "1,2,3"}, "--eye requires --target"},
        {{"render", "-o", "a.png", "--target", "1,2,3"}, "--target requires --eye"},
        {{"render", "-o", "a.png", "--up", "1,2,3"}, "--up requires --eye"},
        {{"render", "-o", "a.png", "--eye", "1,2,3", "--target", "1,2,3"}, "eye and target coincide"},
        {{"render", "-o", "a.png", "--eye", "1,2,3", "--target", "1,0,3"}, "up is parallel"},
        {{"render", "-o", "a.png", "--camera", "0", "--eye", "1,2,3"}, "--camera excludes --eye: give one of them"},
        {{"render", "-o", "a.png", "--fovy", "0"}, "--fovy needs degrees above 0 and below 180"},
        {{"render", "-o", "a.png", "--fovy", "180"}, "--fovy needs degrees above 0 and below 180"},
        {{"render", "-o", "a.png", "--fovy", "5o"}, "--fovy needs degrees above 0 and below 180, not \"5o\""},
        {{"render", "-o", "a.png", "--fovy", "nan"}, "--fovy needs degrees above 0"},
        {{"render", "-o", "a.png", "--light-direction", "0,-0,0"},
         "--light-direction needs three finite numbers x,y,z that are not all 0"},
        {{"render", "-o", "a.png", "--light-direction", "1,2"}, "--light-direction needs three finite numbers"},
        {{"render", "-o", "a.png", "--light-direction", "1,2,3,4"}, "--light-direction needs three finite numbers"},
        {{"render", "-o", "a.png", "--light-direction", "1,2,"}, "--light-direction needs three finite numbers"},
        {{"render", "-o", "a.png", "--light-direction", "1,2,3x"}, "--light-direction needs three finite numbers"},
        {{"render", "-o", "a.png", "--light-direction", "1,2,1e99"}, "--light-direction needs three finite numbers"},
        {{"render", "-o", "a.png", "--light-direction", "1, 2 3"}, "--light-direction needs three finite numbers"},
        {{"render", "-o", "a.png", "--light-position", "inf,0,0"}, "--light-position needs three finite numbers"},
        {{"render", "-o", "a.png", "--light", "0", "--light-position", "1,2,3"}, "excludes --light"},
        {{"render", "-o", "a.png", "--light-direction", "1,2,3", "--light-position", "1,2,3"}, "excludes --light"},
        {{"render", "-o", "a.png", "--set", "map-size"}, "--set needs key=value"},
        {{"render", "-o", "a.png", "--set", "=5"}, "--set needs key=value"},
        {{"render", "-o", "a.png", "--memory-limit", "0"}, "--memory-limit needs a number of bytes"},
        {{"render", "-o", "a.png", "--memory-limit", "5Q"}, "--memory-limit needs a number of bytes"},
        {{"render", "-o", "a.png", "--memory-limit", "-5"}, "--memory-limit needs a number of bytes"},
        {{"render", "-o", "a.png", "--memory-limit", "18446744073709551615K"}, "--memory-limit needs"},
        {{"render", "-o", "a.png", "--device", ""}, "--device needs a value"},
        {{"render", "-o", "a.png", "--time", "1"}, "--time requires SCENE"},
        {{"render", "-o", "a.png", "--scene", "1"}, "--scene requires SCENE"},
        {{"render", "-o", "a.png", "--frames", "2"}, "--frames requires SCENE"},
        {{"render", "a.glb", "-o", "a.png", "--time", "soon"}, "--time needs a finite number, not \"soon\""},
        {{"render", "a.glb", "-o", "a.png", "--time", "1e999"}, "--time needs a finite number"},
        {{"render", "a.glb", "-o", "a.png", "--frames", "0"}, "--frames needs a whole number from 1"},
        {{"render", "a.glb", "-o", "a.png", "--fps", "25"}, "--fps requires --frames"},
        {{"render", "a.glb", "-o", "a.png", "--frames", "2", "--fps", "0"}, "--fps needs a number above 0"},
        {{"explain"}, "nothing to explain: give --pixel X,Y or --point X,Y,Z"},
        {{"explain", "--pixel"}, "--pixel needs a value"},
        {{"explain", "--pixel", "5"}, "--pixel needs a pixel X,Y"},
        {{"explain", "--pixel", "5,-1"}, "--pixel needs a pixel X,Y"},
        {{"explain", "--pixel", "5,6,7"}, "--pixel needs a pixel X,Y"},
        {{"explain", "--pixel", "32,0", "--size", "32x24"}, "--pixel 32,0 lies outside the picture of 32x24 pixels"},
        {{"explain", "--pixel", "0,24", "--size", "32x24"}, "--pixel 0,24 lies outside the picture of 32x24 pixels"},
        {{"explain", "--pixel", "1,1", "--point", "1,2,3"}, "--pixel excludes --point"},
        {{"explain", "--pixel", "1,1", "--receiver", "3"}, "--receiver requires --point"},
        {{"explain", "--pixel", "1,1", "--samples", "4", "--sample", "4"}, "--sample 4 needs a larger --samples"},
        {{"explain", "--pixel", "1,1", "--eye", "1,2,3"}, "--eye requires --target"},
        {{"explain", "--point", "1,2"}, "--point needs three finite numbers"},
        {{"explain", "--point", "1,2,3", "--target", "1,2,3"}, "--point excludes --target"},
        {{"explain", "--point", "1,2,3", "--receiver", "-1"}, "--receiver needs a whole number from 0"},
        {{"explain", "a.glb", "--triangles", "b", "--point", "1,2,3"}, "SCENE excludes --triangles"},
        {{"explain", "--pixel", "1,1", "--quiet"}, "unexpected argument: --quiet"},
    };
    for (const Wrong& wrong : all) expect_failure(wrong.arguments, 2, wrong.sentence);
}

// ---- Requests that cannot be met (exit code 1) ----------------------------------------------------------------------

TEST_F(Command, OutputsThatCannotBeWrittenAreRefusedBeforeTheWork) {
    fs::create_directory(in_folder("folder.png"));
    std::ofstream(in_folder("file")) << "text";
    expect_failure({"render", "-o", "missing/a.png"}, 1, "the folder missing does not exist");
    expect_failure({"render", "-o", "file/a.png"}, 1, "cannot write file/a.png");
    expect_failure({"render", "-o", "folder.png"}, 1, "cannot write folder.png: it is a folder");
    expect_failure({"render", "-o", "a.png", "--stats", "."}, 1, "cannot write .: it is a folder");
    // No one can make files there, not even root.
    expect_failure({"render", "-o", "/sys/a.png"}, 1, "cannot write /sys/a.png: ");
    // All that, before a scene is even looked for.
    expect_failure({"render", "missing.glb", "-o", "missing/a.png"}, 1, "the folder missing does not exist");
}

TEST_F(Command, OutputsMustDiffer) {
    expect_failure({"render", "-o", "a.png", "--mask", "a.png"}, 1, "cannot write a.png: another output");
    expect_failure({"render", "-o", "a.png", "--mask", "../here/a.png"}, 1, "another output has the same name");
    write_scene(folder_, "square", floor_and_square());
    const std::string before = text_of(in_folder("square.gltf"));
    expect_failure({"render", "square.gltf", "--dump-triangles", "./square.gltf"}, 1,
                   "it is a file that this run reads");
    EXPECT_EQ(text_of(in_folder("square.gltf")), before);
}

TEST_F(Command, AFullDiskIsNamedAndLeavesNothing) {
    fs::create_symlink("/dev/full", in_folder("full.png"));
    fs::create_symlink("/dev/full", in_folder("full.exr"));
    for (const Arguments& output :
         {Arguments{"-o", "full.png"}, Arguments{"--mask", "full.png"}, Arguments{"--aov", "full.exr"},
          Arguments{"--dump-triangles", "/dev/full"}, Arguments{"--stats", "/dev/full"}}) {
        Arguments arguments{"render", "--size", "96x64", "--quiet"};
        arguments.insert(arguments.end(), output.begin(), output.end());
        expect_failure(arguments, 1, "cannot write " + output[1] + ": no space is left");
    }
    // The others of the same run do not appear either.
    expect_failure({"render", "--size", "96x64", "-o", "a.png", "--stats", "/dev/full"}, 1, "no space is left");
    EXPECT_TRUE(fs::is_character_file("/dev/full"));
}

TEST_F(Command, BrokenScenes) {
    std::ofstream(in_folder("text.glb")) << "this is no scene";
    std::ofstream(in_folder("empty.glb"));
    std::ofstream(in_folder("cut.gltf")) << "{ \"asset\": { \"version\": ";
    fs::create_directory(in_folder("folder.glb"));
    write_scene(folder_, "no_bin", floor_and_square());
    fs::remove(in_folder("no_bin.bin"));
    for (const char* scene : {"missing.glb", "text.glb", "empty.glb", "cut.gltf", "folder.glb", "no_bin.gltf"})
        expect_failure({"render", scene, "-o", "a.png", "--size", "16x16"}, 1, scene);
}

TEST_F(Command, UnknownNamesAreAnsweredWithTheListOfWhatExists) {
    write_scene(folder_, "square", floor_and_square());
    const Arguments render{"render", "square.gltf", "-o", "a.png", "--size", "16x16"};
    const auto with = [&](const Arguments& more) {
        Arguments all = render;
        all.insert(all.end(), more.begin(), more.end());
        return all;
    };
    expect_failure(with({"--camera", "below"}), 1,
                   "no camera \"below\": the scene has these: 0 \"above\", 1 \"aside\"");
    expect_failure(with({"--camera", "2"}), 1, "no camera \"2\"");
    expect_failure(with({"--light", "moon"}), 1, "no light \"moon\": the scene has these: 0 \"sun\", 1 \"lamp\"");
    expect_failure(with({"--technique", "magic"}), 1, "frustum-traced");
    expect_failure(with({"--set", "magic=1"}), 1, "magic");
    expect_failure(with({"--conservative-map", "maybe"}), 1, "conservative-map");
    expect_failure(with({"--map-size", "many"}), 1, "map-size");
    expect_failure(with({"--device", "no such device"}), 1, "no such device");
    expect_failure(with({"--device", "99:0"}), 1, "99:0");
    expect_failure({"techniques", "magic"}, 1, "these exist: frustum-traced");
}

TEST_F(Command, AloneItWritesPicturesAndGalleriesButNoExrFiles) {
    program_ = root_ / "gnomon";  // without its module, which alone knows OpenImageIO
    fs::copy_file(GNOMON_BINARY, program_);
    render_quietly({"-o", "picture.png", "--mask", "mask.png", "--size", "32x32"});
    expect_failure({"render", "-o", "other.png", "--aov", "view.exr"}, 1, "gnomon_openimageio.so");
    EXPECT_EQ(run({"gallery", "--technique", "izb", "--runs", "1", "--size", "32x32"}).exit_code, 0);
}

TEST_F(Command, NoOpenClAtAll) {
    const RunOptions none{{{"OCL_ICD_VENDORS", "/nonexistent"}}, "", ""};
    expect_failure({"devices"}, 1, "OpenCL", none);
    expect_failure({"render", "-o", "a.png"}, 1, "OpenCL", none);
}

TEST_F(Command, TooLittleDeviceMemory) {
    expect_failure({"render", "-o", "a.png", "--size", "320x240", "--memory-limit", "100K"}, 1,
                   "out of device memory: ");
}

TEST_F(Command, ASceneThatDoesNotFitIsProcessedInPartsWithTheSameFiles) {
    std::vector<float> vertices = floor_and_square();
    for (int i = 0; i < 100000; ++i) {  // specks over the floor, a few seen and most of them hidden by others
        const float x = float(i % 173) / 23 - 3.7f, y = 0.1f + float(i % 89) / 100,
                    z = float(i / 173 % 173) / 23 - 3.7f;
        for (const float corner : {x, y, z, x + 0.05f, y + 0.01f, z, x, y, z + 0.05f}) vertices.push_back(corner);
    }
    write_scene(folder_, "specks", vertices);
    const Arguments scene{"specks.gltf",        "--size", "160x120", "--light", "lamp", "--map-size", "2048", "--set",
                          "first-capacity=4096"};
    const auto with = [&](const Arguments& more) {
        Arguments all = scene;
        all.insert(all.end(), more.begin(), more.end());
        return all;
    };
    const auto files_of = [](const std::string& name) {
        return Arguments{"-o",    name + ".png", "--mask",  name + "_mask.png",
                         "--aov", name + ".exr", "--stats", name + ".json"};
    };
    render_quietly(with(files_of("whole")));
    const auto peak = statistics("whole.json").at("memory").at("device_peak_bytes").get<std::uint64_t>();
    const std::string limit = std::to_string(peak * 3 / 4);
    Arguments limited = files_of("parts");
    limited.insert(limited.end(), {"--memory-limit", limit});
    render_quietly(with(limited));
    EXPECT_GT(statistics("parts.json").at("shadow_stages").at("counts").at("parts"), 1);
    for (const char* end : {".png", "_mask.png", ".exr"})
        EXPECT_TRUE(text_of(in_folder("whole" + std::string(end))) == text_of(in_folder("parts" + std::string(end))))
            << end;

    // Where parts would not answer for the whole, and where not even one fits.
    const auto expect_too_little = [&](const std::string& bytes, const Arguments& more) {
        Arguments all = with(more);
        all.insert(all.begin(), "render");
        all.insert(all.end(), {"-o", "a.png", "--memory-limit", bytes});
        expect_failure(all, 1, "out of device memory: ");
    };
    expect_too_little(limit, {"--samples", "4"});
    expect_too_little(limit, {"--dump-points", "points.bin"});
    expect_too_little("300K", {});
}

TEST_F(Command, AKillWhileItWritesLeavesTheOldFilesWhole) {
    std::ofstream(in_folder("a.exr")) << "old";
    const pid_t child = start({"render", "--aov", "a.exr", "--size", "3000x2000", "--quiet"});
    const auto has_begun = [&] {
        for (const auto& entry : fs::directory_iterator(folder_))
            if (entry.path().extension() == ".partial" && entry.file_size() > 0) return true;
        return false;
    };
    bool begun = false;
    while (!(begun = has_begun()) && waitpid(child, nullptr, WNOHANG) == 0)
        std::this_thread::sleep_for(std::chrono::milliseconds(1));
    ASSERT_TRUE(begun);
    ASSERT_EQ(kill(child, SIGKILL), 0);
    EXPECT_EQ(finish(child).signal_number, SIGKILL);
    EXPECT_EQ(text_of(in_folder("a.exr")), "old");
}

TEST_F(Command, AnInterruptLeavesNothing) {
    // At once, and in the midst of the work, when drivers have installed signal handlers of their own.
    for (const auto& [signal_number, wait_ms] :
         {std::pair{SIGINT, 0}, std::pair{SIGTERM, 1000}, std::pair{SIGINT, 1000}}) {
        const pid_t child = start({"render", "-o", "a.png", "--aov", "a.exr", "--size", "8192x8192"});
        // The temporaries are there before the long work begins.
        while (files().size() < 2 && waitpid(child, nullptr, WNOHANG) == 0)
            std::this_thread::sleep_for(std::chrono::milliseconds(1));
        std::this_thread::sleep_for(std::chrono::milliseconds(wait_ms));
        ASSERT_EQ(kill(child, signal_number), 0);
        EXPECT_EQ(finish(child).signal_number, signal_number);
        EXPECT_EQ(files(), std::vector<std::string>{});
    }
}

// ---- Rendering ------------------------------------------------------------------------------------------------------

struct DumpedPoint {
    std::array<float, 3> position;
    std::uint32_t receiver;
};
std::vector<DumpedPoint> read_points(const fs::path& file) {
    static_assert(sizeof(DumpedPoint) == 16);
    std::vector<DumpedPoint> points(fs::file_size(file) / sizeof(DumpedPoint));
    std::ifstream stream(file, std::ios::binary);
    stream.read(reinterpret_cast<char*>(points.data()), std::streamsize(points.size() * sizeof(DumpedPoint)));
    return points;
}

// The points of one sample are those of the AOV; of eight, they lie around them, and the mask has eighths.
TEST_F(Command, ASunWithAnAngleHasPenumbrae) {
    const auto shown = [&](std::vector<std::string> more) {
        std::vector<std::string> arguments{"render", "--size", "64x48", "--aov", "a.exr", "--stats", "stats.json"};
        arguments.insert(arguments.end(), more.begin(), more.end());
        const Outcome outcome = run(arguments);
        EXPECT_EQ(outcome.exit_code, 0) << outcome.err;
        return read_aov(in_folder("a.exr"));
    };
    const std::vector<Pixel> hard = shown({}), soft = shown({"--sun-angle", "4", "--sun-samples", "8"});
    std::size_t partly = 0, inside = 0;
    for (std::size_t i = 0; i < soft.size(); ++i) {
        EXPECT_EQ(soft[i].visibility * 8, std::round(soft[i].visibility * 8)) << i;
        partly += soft[i].visibility > 0 && soft[i].visibility < 1;
        inside += soft[i].visibility == hard[i].visibility;
    }
    EXPECT_GT(partly, 20u);
    EXPECT_GT(inside, soft.size() / 2);
    EXPECT_EQ(statistics("stats.json").at("image").at("sun_samples"), 8);
    const Outcome lamp = run({"render", "-o", "a.png", "--light-position", "1,5,1", "--sun-angle", "1"});
    EXPECT_EQ(lamp.exit_code, 1);
    EXPECT_NE(lamp.err.find("--sun-angle is for directional lights"), std::string::npos) << lamp.err;
}

// Under the square (half a side of .5, one above the floor) a vertical sun is hidden; a sun whose light travels one to
// the side for each unit down is hidden one farther in that direction.
TEST_F(Command, HoursOfPointsAndPictures) {
    write_scene(folder_, "square", floor_and_square());
    std::ofstream(in_folder("suns.csv")) << "x,y,z,weight\n0,-1,0,2\n1,-1,0,0.5\n0,1,0,8\n";
    std::ofstream(in_folder("points.csv")) << "x,y,z,nx,ny,nz\n0,0,0,0,1,0\n1,0,0,0,1,0\n2,0,0,0,1,0\n2,0,0,0,-1,0\n";
    const Arguments of_points{"hours", "square.gltf", "--directions", "suns.csv", "--points", "points.csv"};
    const auto with = [](Arguments arguments, const Arguments& more) {
        arguments.insert(arguments.end(), more.begin(), more.end());
        return arguments;
    };
    const Outcome as_text = run(with(of_points, {"-o", "out.csv"}));
    EXPECT_EQ(as_text.exit_code, 0) << as_text.err;
    // Point 0 is below the square, point 1 in the slanted sun's shadow, point 2 sees both; from below only the third
    // sun, whose light rises, is in front, and the floor lies in the point's own plane.
    EXPECT_EQ(text_of(in_folder("out.csv")), "x,y,z,value\n0,0,0,0.5\n1,0,0,2\n2,0,0,2.5\n2,0,0,8\n");
    EXPECT_NE(as_text.out.find("3 suns, 10.5 hours"), std::string::npos) << as_text.out;
    ASSERT_EQ(run(with(of_points, {"-o", "out.npy", "--quiet"})).exit_code, 0);
    const std::string npy = text_of(in_folder("out.npy"));
    ASSERT_EQ(npy.size(), 128u + 4 * sizeof(double));
    EXPECT_EQ(npy.substr(1, 5), "NUMPY");
    EXPECT_NE(npy.find("'<f8'"), std::string::npos);
    EXPECT_NE(npy.find("(4,)"), std::string::npos);
    std::array<double, 4> values{};
    std::memcpy(values.data(), npy.data() + 128, sizeof(values));
    EXPECT_EQ(values, (std::array{0.5, 2.0, 2.5, 8.0}));

    const Arguments of_picture{"hours", "square.gltf", "--directions", "suns.csv", "--camera",
                               "above", "--size",      "600x400",      "--quiet"};
    const Outcome picture = run(with(of_picture, {"-o", "a.png", "--aov", "a.exr", "--write-directions", "used.csv"}));
    EXPECT_EQ(picture.exit_code, 0) << picture.err;
    std::map<float, std::size_t> seen;
    for (const Pixel& pixel : read_aov(in_folder("a.exr"), "value")) {
        const auto [x, y, z] = pixel.position;
        const bool beside = std::abs(std::abs(z) - 0.5f) > 1e-3f && std::abs(std::abs(x) - 0.5f) > 1e-3f &&
                            std::abs(std::abs(x - 1) - 0.5f) > 1e-3f;
        if (pixel.receiver == sky || !beside) continue;
        const bool on_floor = pixel.receiver < 2, in_row = std::abs(z) < 0.5f;
        const float vertical = on_floor && in_row && std::abs(x) < 0.5f ? 0.0f : 2.0f;
        const float slanted = on_floor && in_row && std::abs(x - 1) < 0.5f ? 0.0f : 0.5f;
        EXPECT_EQ(pixel.visibility, vertical + slanted) << x << ' ' << z;
        ++seen[pixel.visibility];
    }
    EXPECT_EQ(seen.size(), 2u);  // the camera stands where the vertical sun does
    EXPECT_GT(seen[2.0f], 300u);
    EXPECT_GT(seen[2.5f], 300u);
    const Bytes png = read_bytes(in_folder("a.png"));
    EXPECT_EQ(shape(png.spec), (std::array{600, 400, 3}));
    // What is written is taken back with the same bits.
    const std::string first = text_of(in_folder("a.exr"));
    EXPECT_EQ(run({"hours", "square.gltf", "--directions", "used.csv", "--camera", "above", "--size", "600x400",
                   "--quiet", "--aov", "a.exr"})
                  .exit_code,
              0);
    EXPECT_EQ(text_of(in_folder("a.exr")), first);
}

// At 4,500,000 float32 has steps of half a metre: decimals of a table move there, and a warning counts them.
TEST_F(Command, PointsOfEarthSizeAreNamed) {
    std::vector<float> vertices = floor_and_square();
    for (std::size_t i = 0; i < vertices.size(); i += 3) vertices[i] += 4'500'000;
    write_scene(folder_, "town", vertices);
    std::ofstream(in_folder("suns.csv")) << "x,y,z\n0,-1,0\n";
    const auto hours = [&](const std::string& rows, Arguments more) {
        std::ofstream(in_folder("points.csv")) << "x,y,z\n" << rows;
        Arguments all{"hours", "town.gltf", "--directions", "suns.csv", "--points", "points.csv", "-o", "out.csv"};
        all.insert(all.end(), more.begin(), more.end());
        return run(all);
    };
    const Outcome held = hours("4500001.5,0.1,0.3\n", {"--strict"});
    EXPECT_EQ(held.exit_code, 0) << held.err;
    const Outcome moved = hours("4500001.5,0,0\n4500001.7,0,0\n4500002.2,0,0\n", {});
    EXPECT_EQ(moved.exit_code, 0);
    EXPECT_NE(moved.err.find("points.csv: float32 moves 2 points far from the origin, the first by 0.2"),
              std::string::npos)
        << moved.err;
    EXPECT_NE(hours("4500001.7,0,0\n", {"--strict"}).err.find("moves 1 point far"), std::string::npos);
}

TEST_F(Command, HoursRefusesWhatHasNoMeaning) {
    std::ofstream(in_folder("suns.csv")) << "0,-1,0\n";
    std::ofstream(in_folder("points.csv")) << "x,y\n0,0\n";
    std::ofstream(in_folder("absent.csv")) << "x,y,z\n0,0,0\n-9999,-9999,5\n";
    std::ofstream(in_folder("absent_height.csv")) << "x,y,z\n0,0,0\n1,-9999,5\n";
    std::ofstream(in_folder("weights.csv")) << "0,-1,0,5\n0,-1,1,-999\n";
    std::ofstream(in_folder("none.csv")) << "x,y,z\n";
    std::ofstream(in_folder("suns.bz2")) << "BZh91AY";
    std::ofstream(in_folder("cut.csv.gz")) << "\x1f\x8b\x08";
    const struct {
        Arguments arguments;
        int exit_code;
        std::string sentence;
    } cases[] = {
        {{"-o", "a.png"}, 2, "no suns: give --directions"},
        {{"-o", "a.png", "--directions", "suns.csv", "--place", "1,2", "--day", "2026-01-01"}, 2, "excludes --place"},
        {{"-o", "a.png", "--place", "1,2"}, 2, "--place needs --day"},
        {{"-o", "a.png", "--place", "91,2", "--day", "2026-01-01"}, 2, "a latitude from -90 to 90"},
        {{"-o", "a.png", "--place", "48°12'N,16°22'E", "--day", "2026-01-01"},
         2,
         "in decimal degrees, such as 48.2,16.4"},
        {{"-o", "a.png", "--place", "48,2,16,4", "--day", "2026-01-01"}, 2, "in decimal degrees, such as 48.2,16.4"},
        {{"-o", "a.png", "--place", "1", "--day", "2026-01-01"}, 2, "--place needs a latitude"},
        {{"-o", "a.png", "--place", "1,2", "--day", "2026-02-30"}, 2, "needs a day as 2026-06-21"},
        {{"-o", "a.png", "--place", "1,2", "--day", "2026-02-20", "--year", "2026"}, 2, "excludes --year"},
        {{"-o", "a.png", "--place", "1,2", "--day", "2026-02-3x"}, 2, "needs a day as 2026-06-21"},
        {{"-o", "a.png", "--place", "1,2", "--year", "2026", "--step", "7"}, 2, "minutes that divide a day"},
        {{"-o", "a.png", "--directions", "suns.csv", "--step", "10"}, 2, "--step requires --place"},
        {{"-o", "a.png", "--epw", "a.epw", "--place", "1,2", "--day", "2026-01-01"}, 2, "excludes --place"},
        {{"-o", "a.png", "--epw", "a.epw", "--directions", "suns.csv"}, 2, "excludes --epw"},
        {{"-o", "a.png", "--epw", "a.epw", "--unit", "Wh"}, 2, "--unit excludes --epw"},
        {{"-o", "a.png", "--epw", "missing.epw"}, 1, "cannot read missing.epw"},
        {{"-o", "a.png", "--epw", "suns.csv"},
         1,
         "suns.csv (no EPW file, so read as a TMY3 table): must have 7 columns"},
        {{"--directions", "suns.csv"}, 2, "nothing to write"},
        {{"-o", "a.csv", "--directions", "suns.csv"}, 2, "ends with .png"},
        {{"-o", "a.png", "--directions", "suns.csv", "--points", "points.csv"}, 2, "ends with .csv or .npy"},
        {{"-o", "a.csv", "--directions", "suns.csv", "--points", "points.csv"}, 1, "points need the columns x, y, z"},
        {{"-o", "a.png", "--directions", "missing.csv"}, 1, "cannot read missing.csv: it does not exist"},
        {{"-o", "a.png", "--directions", "."}, 1, "cannot read .: it is a folder"},
        {{"-o", "a.png", "--directions", "cut.csv.gz"}, 1, "packed with gzip, and cut off or damaged: pack it again"},
        {{"-o", "a.png", "--directions", "suns.bz2"}, 1, "suns.bz2: is packed by bzip2: unpack it (bunzip2)"},
        {{"-o", "a.csv", "--directions", "suns.csv", "--points", "none.csv"}, 1, "none.csv has no points"},
        {{"-o", "a.png", "--directions", "weights.csv"},
         1,
         "weights.csv, line 2 has weight = \"-999\", which stands for no data: write 0"},
        {{"-o", "a.csv", "--directions", "suns.csv", "--points", "absent.csv"},
         1,
         "absent.csv, line 3 has x = \"-9999\", which stands for no data: leave the row out, or move it a little if it "
         "is "
         "a place"},
        {{"-o", "a.csv", "--directions", "suns.csv", "--points", "absent_height.csv"},
         1,
         "absent_height.csv, line 3 has y = \"-9999\", which stands for no data"},
        {{"--aov", "a.exr", "--directions", "suns.csv", "--write-directions", "suns.csv"},
         1,
         "a file that this run reads"},
    };
    for (const auto& [arguments, exit_code, sentence] : cases) {
        Arguments all{"hours"};
        all.insert(all.end(), arguments.begin(), arguments.end());
        expect_failure(all, exit_code, sentence);
    }
}

// The sun is above the square everywhere it is up: a point beside it has a whole polar day, all points have no polar
// night. Places are written as maps copy them.
TEST_F(Command, HoursOfPolarDaysAndNights) {
    write_scene(folder_, "square", floor_and_square());
    std::ofstream(in_folder("points.csv")) << "Easting;Northing;Height\r\n90;1000;0\r\n95;1000;0\r\n";
    std::ofstream(in_folder("night.csv")) << "azimuth,elevation\n3,-1\n";
    const auto hours = [&](const Arguments& suns) {
        Arguments all{"hours", "square.gltf", "--points", "points.csv", "-o", "out.csv"};
        all.insert(all.end(), suns.begin(), suns.end());
        const Outcome outcome = run(all);
        EXPECT_EQ(outcome.exit_code, 0) << outcome.err;
        return text_of(in_folder("out.csv"));
    };
    const std::string head = "x,y,z,value\n", none = "90,1000,0,0\n95,1000,0,0\n", day = "90,1000,0,24\n95,1000,0,24\n";
    EXPECT_EQ(hours({"--directions", "night.csv"}), head + none);
    const Outcome asked = run({"hours", "--place", "1,2", "--day", "2026-01-01", "-o", "a.png", "--size", "8x8"});
    if (asked.err.find("built without ERFA") != std::string::npos) GTEST_SKIP() << "no ERFA";
    EXPECT_EQ(hours({"--place", "78.2, 15.6", "--day", "2026-12-21"}), head + none);
    EXPECT_EQ(hours({"--place", " 78.2 ,15.6 ", "--day", "2026-06-21", "--step", "10"}), head + day);
    EXPECT_EQ(run({"hours", "square.gltf", "--place", "78.2,15.6", "--day", "2026-12-21", "-o", "a.png", "--camera",
                   "above", "--size", "16x16"})
                  .exit_code,
              0)
        << "a picture of a polar night";
}

// One hour of 700 W/m2: the squares of what the six sides of a cube get are the square of .7 kWh/m2, wherever the Sun
// stands; below the square, with the Sun in the zenith, a point gets nothing.
TEST_F(Command, HoursOfAWeatherFile) {
    write_scene(folder_, "square", floor_and_square());
    const auto write_epw = [&](const std::string& place, int month) {
        std::ofstream file(in_folder("a.epw"));
        file << "LOCATION,Made,-,-,-,1," << place << ",0\n\n\n\n\n\n\n\n";
        for (int hour = 1; hour <= 24; ++hour)
            file << "2026," << month << ",21," << hour << ",0,?,9,9,9,9,0,0,0,0," << (hour == 13 ? 700 : 0) << ",0"
                 << ",0,0,0,0,0,0,0,0,0,0,0,0,0,0,0,0,0,0,0\n";
    };
    const auto values = [&](const Arguments& suns) {
        Arguments all{"hours", "square.gltf", "--points", "points.csv", "-o", "out.csv"};
        all.insert(all.end(), suns.begin(), suns.end());
        const Outcome outcome = run(all);
        EXPECT_EQ(outcome.exit_code, 0) << outcome.err;
        std::istringstream text(text_of(in_folder("out.csv")));
        std::vector<double> found;
        std::string line;
        std::getline(text, line);
        while (std::getline(text, line)) found.push_back(std::stod(line.substr(line.rfind(',') + 1)));
        return std::pair(found, outcome.out);
    };
    std::ofstream(in_folder("points.csv")) << "x,y,z,nx,ny,nz\n9,9,9,1,0,0\n9,9,9,-1,0,0\n9,9,9,0,1,0\n9,9,9,0,-1,0\n"
                                              "9,9,9,0,0,1\n9,9,9,0,0,-1\n0,0,0,0,1,0\n3,0,0,0,1,0\n";
    write_epw("48.2,16.4,1", 6);
    const Outcome asked = run({"hours", "--place", "1,2", "--day", "2026-01-01", "-o", "a.png", "--size", "8x8"});
    if (asked.err.find("built without ERFA") != std::string::npos) GTEST_SKIP() << "no ERFA";
    const auto [found, said] = values({"--epw", "a.epw"});
    ASSERT_EQ(found.size(), 8u);
    double squares = 0;
    for (std::size_t i = 0; i < 6; ++i) squares += found[i] * found[i];
    EXPECT_NEAR(std::sqrt(squares), 0.7, 1e-6);
    EXPECT_NE(said.find("1 suns, 0.7 kWh/m2"), std::string::npos) << said;
    EXPECT_NE(said.find("Made (48.2, 16.4), 2026, UTC+1; a sun in the middle of each hour"), std::string::npos) << said;
    // The written table has Wh/m2.
    const std::vector<double> again = values({"--directions", "out.suns.csv", "--cosines"}).first;
    for (std::size_t i = 0; i < found.size(); ++i) EXPECT_NEAR(again[i], 1000 * found[i], 1e-9) << i;
    EXPECT_NE(text_of(in_folder("out.suns.csv")).find("2026-06-21T12:30:00+01:00,"), std::string::npos);

    write_epw("0,-7.5,0", 3);  // 12:30 on the clock is noon there, and the Sun of the equinox near the zenith
    const std::vector<double> zenith = values({"--epw", "a.epw"}).first;
    EXPECT_NEAR(zenith[7], 0.7, 0.001);
    EXPECT_EQ(zenith[6], 0) << "below the square";
    const Arguments picture{"hours", "square.gltf", "--epw", "a.epw", "--camera", "above",  "--size",
                            "64x64", "-o",          "a.png", "--aov", "a.exr",    "--quiet"};
    EXPECT_EQ(run(picture).exit_code, 0);
    std::map<float, std::size_t> seen;
    for (const Pixel& pixel : read_aov(in_folder("a.exr"), "value")) ++seen[pixel.visibility];
    EXPECT_GT(seen[float(zenith[7])], 1000u);
    std::ofstream(in_folder("points.csv")) << "x,y,z\n0,0,0\n";
    expect_failure({"hours", "square.gltf", "--points", "points.csv", "--epw", "a.epw", "-o", "b.csv"}, 1,
                   "points.csv: --epw needs the columns nx, ny, nz");
}

// A wall from north to south hides half of an even sky from the ground beside it, and a patch in the west from all
// ground east of it. A program in the place of gendaymtx says how the sky shines. Normals may have any length.
TEST_F(Command, DiffuseLightOfAWeatherFile) {
    const std::vector<float> wall{0, -9e3f, -9e3f, 0, 9e3f, -9e3f, 0, 9e3f,  9e3f,
                                  0, -9e3f, -9e3f, 0, 9e3f, 9e3f,  0, -9e3f, 9e3f};
    write_scene(folder_, "wall", wall);
    std::ofstream epw(in_folder("a.epw"));
    epw << "LOCATION,Made,-,-,-,1,48,15,1,0\n\n\n\n\n\n\n\n";
    for (int hour = 1; hour <= 24; ++hour)
        epw << "2026,6,21," << hour << ",0,?,9,9,9,9,0,0,0,0,0," << (hour == 13 ? 400 : 0)
            << ",0,0,0,0,0,0,0,0,0,0,0,0,0,0,0,0,0,0,0\n";
    epw.close();
    std::ofstream(in_folder("points.csv")) << "x,y,z,nx,ny,nz\n-1,0,0,0,1,0\n1,0,0,0,7,0\n-1,0,0,-2,0,0\n";
    fs::create_directory(in_folder("bin"));
    std::ofstream(in_folder("bin/gendaymtx")) << "#!/bin/sh\ncat '" << in_folder("sky.mtx").string() << "'\n";
    fs::permissions(in_folder("bin/gendaymtx"), fs::perms::owner_all);
    RunOptions with_program, without_program;
    with_program.environment["PATH"] = in_folder("bin").string() + ":" + std::getenv("PATH");
    without_program.environment["PATH"] = "/nowhere";
    const auto values = [&](const std::function<float(std::size_t patch)>& radiance) {
        std::ofstream matrix(in_folder("sky.mtx"), std::ios::binary);
        for (std::size_t row = 0; row < 146; ++row)
            for (std::size_t i = 0; i < 24 * 3; ++i) {
                const float value = row == 0 ? 0 : radiance(row - 1);
                matrix.write(reinterpret_cast<const char*>(&value), sizeof value);
            }
        matrix.close();
        const Outcome outcome =
            run({"hours", "wall.gltf", "--epw", "a.epw", "--diffuse", "--points", "points.csv", "-o", "out.csv"},
                with_program);
        EXPECT_EQ(outcome.exit_code, 0) << outcome.err;
        std::istringstream text(text_of(in_folder("out.csv")));
        std::string line;
        std::getline(text, line);
        EXPECT_EQ(line, "x,y,z,value,direct,diffuse");
        std::vector<double> found;
        while (std::getline(text, line)) {
            const std::size_t diffuse = line.rfind(','), direct = line.rfind(',', diffuse - 1);
            const std::size_t value = line.rfind(',', direct - 1);
            EXPECT_EQ(std::stod(line.substr(direct + 1)), 0);
            EXPECT_EQ(std::stod(line.substr(value + 1)), std::stod(line.substr(diffuse + 1)));
            found.push_back(std::stod(line.substr(diffuse + 1)));
        }
        return found;
    };
    const Outcome asked = run({"hours", "--place", "1,2", "--day", "2026-01-01", "-o", "a.png", "--size", "8x8"});
    if (asked.err.find("built without ERFA") != std::string::npos) GTEST_SKIP() << "no ERFA";
    const std::vector<double> even = values([](std::size_t) { return 5.0f; });
    ASSERT_EQ(even.size(), 3u);
    EXPECT_NEAR(even[0], 0.2, 1e-6);
    EXPECT_NEAR(even[1], 0.2, 1e-6) << "a normal of length 7";
    EXPECT_NEAR(even[2], 0.2, 0.001) << "an open wall has half of an even sky";
    const std::vector<double> western = values([](std::size_t patch) { return patch == 84 + 18 ? 5.0f : 0.0f; });
    EXPECT_NEAR(western[0], 0.4, 1e-6);
    EXPECT_EQ(western[1], 0);
    expect_failure({"hours", "wall.gltf", "--epw", "a.epw", "--diffuse", "-o", "b.png", "--size", "8x8"}, 1,
                   "needs Radiance's program gendaymtx", without_program);
    expect_failure({"hours", "--place", "1,2", "--day", "2026-01-01", "--diffuse", "-o", "b.png"}, 2,
                   "--diffuse requires --epw");
}

// What is seen badly is said, with what to try.
TEST_F(Command, HintsSayWhatToTry) {
    write_scene(folder_, "square", floor_and_square());
    const auto said = [&](const Arguments& more) {
        Arguments all{"render", "square.gltf", "--size", "8x8", "-o", "a.png"};
        all.insert(all.end(), more.begin(), more.end());
        const Outcome outcome = run(all);
        EXPECT_EQ(outcome.exit_code, 0) << outcome.err;
        return outcome.out;
    };
    const std::string upwards = said({"--eye", "0,9,0", "--target", "0,99,1"});
    EXPECT_NE(upwards.find("the camera sees no triangle: --eye X,Y,Z"), std::string::npos) << upwards;
    EXPECT_NE(upwards.find("1 other light of the scene is unused: --light NAME"), std::string::npos) << upwards;
    const Arguments down{"--eye", "1,2,1", "--target", "1,0,1.01", "--light-direction", "0,1,0"};
    const std::string dark = said(down);
    EXPECT_NE(dark.find("no light reaches what the camera sees"), std::string::npos) << dark;
    EXPECT_EQ(dark.find("unused"), std::string::npos) << dark;
    EXPECT_EQ(said({"--light", "sun"}).find("hint"), std::string::npos);
}

TEST_F(Command, AnEmptyPictureOfHoursSaysWhatToTry) {
    write_scene(folder_, "square", floor_and_square());
    std::ofstream(folder_ / "suns.csv") << "x,y,z,weight\n0,-1,0,1\n0,-1,1,-2\n";
    const auto said = [&](const Arguments& more) {
        Arguments all{"hours", "square.gltf", "--size", "8x8", "-o", "a.png", "--directions", "suns.csv"};
        all.insert(all.end(), more.begin(), more.end());
        const Outcome outcome = run(all);
        EXPECT_EQ(outcome.exit_code, 0) << outcome.err;
        return outcome.out;
    };
    const std::string usual = said({});
    EXPECT_EQ(usual.find("hint"), std::string::npos);
    EXPECT_NE(usual.find("2 suns, -1 hours; 1 of a weight below 0, which lower sums"), std::string::npos) << usual;
    const std::string dark = said({"--eye", "0,-25,0", "--target", "0,0,0.1"});  // backs before the sky
    EXPECT_NE(dark.find("hint: no sun reaches any point"), std::string::npos) << dark;
    const std::string upwards = said({"--eye", "0,9,0", "--target", "0,99,1"});
    EXPECT_NE(upwards.find("hint: the camera sees no triangle: --eye X,Y,Z"), std::string::npos) << upwards;
    write_scene(folder_, "square", std::vector<float>(9, std::numeric_limits<float>::quiet_NaN()));
    const std::string none = said({});
    EXPECT_NE(none.find("hint: the scene has no triangles"), std::string::npos) << none;
}

TEST_F(Command, SamplesAndTheirPoints) {
    const Outcome one = run({"render", "--size", "48x32", "--aov", "a.exr", "--dump-points", "one.bin"});
    EXPECT_EQ(one.exit_code, 0) << one.err;
    const std::vector<Pixel> pixels = read_aov(in_folder("a.exr"));
    const std::vector<DumpedPoint> points = read_points(in_folder("one.bin"));
    ASSERT_EQ(points.size(), 48u * 32u);
    for (std::size_t i = 0; i < points.size(); ++i) {
        ASSERT_EQ(points[i].receiver, pixels[i].receiver) << i;
        if (points[i].receiver != sky)
            ASSERT_EQ(points[i].position, pixels[i].position) << i;
        else
            ASSERT_TRUE(std::isnan(points[i].position[0])) << i;
    }

    const Outcome eight = run({"render", "--size", "48x32", "--samples", "8", "--mask", "m.png", "--aov", "b.exr",
                               "--dump-points", "eight.bin", "--stats", "stats.json"});
    EXPECT_EQ(eight.exit_code, 0) << eight.err;
    EXPECT_EQ(statistics("stats.json").at("image").at("samples"), 8);
    const std::vector<DumpedPoint> samples = read_points(in_folder("eight.bin"));
    ASSERT_EQ(samples.size(), 8 * points.size());
    std::size_t same_receiver = 0;
    for (std::size_t i = 0; i < samples.size(); ++i)
        same_receiver += samples[i].receiver == points[i % points.size()].receiver;
    EXPECT_GT(same_receiver, samples.size() / 2);
    const std::vector<Pixel> means = read_aov(in_folder("b.exr"));
    const Bytes mask = read_bytes(in_folder("m.png"));
    std::size_t partly = 0;
    for (std::size_t i = 0; i < means.size(); ++i) {
        const float eighths = 8 * means[i].visibility;
        ASSERT_EQ(eighths, std::round(eighths)) << i;
        ASSERT_EQ(mask.values[i], std::lround(255 * means[i].visibility)) << i;
        partly += eighths != 0 && eighths != 8;
    }
    EXPECT_GT(partly, 20u);  // a shadow's edge
}

TEST_F(Command, TheDefaultSceneWithEveryOutput) {
    const Outcome outcome = run({"render", "--size", "96x64", "-o", "a.png", "--mask", "mask.png", "--aov", "a.exr",
                                 "--dump-triangles", "triangles.bin", "--stats", "stats.json"});
    EXPECT_EQ(outcome.exit_code, 0) << outcome.err;
    EXPECT_EQ(outcome.err, "");
    EXPECT_EQ(files(), (std::vector<std::string>{"a.exr", "a.png", "mask.png", "stats.json", "triangles.bin"}));

    const nlohmann::json stats = statistics("stats.json");
    const std::size_t triangles = stats.at("triangles");
    EXPECT_GT(triangles, 0u);
    EXPECT_EQ(fs::file_size(in_folder("triangles.bin")), 36 * triangles);

    // The terminal names the light so that it can be given again, and every file.
    EXPECT_NE(outcome.out.find(std::string(stats.at("light").at("option"))), std::string::npos) << outcome.out;
    for (const std::string& file : files()) EXPECT_NE(outcome.out.find(file), std::string::npos) << outcome.out;

    const Bytes picture = read_bytes(in_folder("a.png")), mask = read_bytes(in_folder("mask.png"));
    EXPECT_EQ(shape(picture.spec), (std::array<int, 3>{96, 64, 3}));
    EXPECT_EQ(shape(mask.spec), (std::array<int, 3>{96, 64, 1}));
    EXPECT_EQ(mask.spec.format, OIIO::TypeUInt8);

    const std::array<float, 3> eye = stats.at("camera").at("eye");
    const std::vector<Pixel> pixels = read_aov(in_folder("a.exr"));
    ASSERT_EQ(pixels.size(), 96u * 64u);
    std::size_t lit = 0, in_shadow = 0;
    for (std::size_t i = 0; i < pixels.size(); ++i) {
        const Pixel& pixel = pixels[i];
        ASSERT_TRUE(pixel.visibility == 0 || pixel.visibility == 1) << i;  // an exact technique knows nothing between
        ASSERT_EQ(mask.values[i], pixel.visibility == 1 ? 255 : 0) << i;
        ++(pixel.visibility == 1 ? lit : in_shadow);
        if (pixel.receiver == sky) {
            ASSERT_EQ(pixel.position, (std::array<float, 3>{0, 0, 0})) << i;
            ASSERT_EQ(pixel.normal, (std::array<float, 3>{0, 0, 0})) << i;
            ASSERT_EQ(pixel.visibility, 1) << i;
            continue;
        }
        ASSERT_LT(pixel.receiver, triangles) << i;
        const std::array<float, 3> to_eye{eye[0] - pixel.position[0], eye[1] - pixel.position[1],
                                          eye[2] - pixel.position[2]};
        ASSERT_GT(dot(pixel.normal, to_eye), 0) << i;  // N faces the camera
        // Unit length, but for the rounding of three coordinates to float32 (each at most 2^-25).
        ASSERT_NEAR(dot(pixel.normal, pixel.normal), 1, 4 * std::numeric_limits<float>::epsilon()) << i;
    }
    EXPECT_EQ(stats.at("pixels").at("lit"), lit);
    EXPECT_EQ(stats.at("pixels").at("in_shadow"), in_shadow);
    EXPECT_GT(lit, 0u);
    EXPECT_GT(in_shadow, 0u);  // a sundial without a shadow would be none
}

/// An exposure of +1 doubles the light of all that stays below .8; masks stay.
TEST_F(Command, ExposureDoublesLight) {
    const auto picture = [&](const char* name, const char* exposure) {
        render_quietly({"--size", "64x48", "-o", name, "--mask", "m.png", "--exposure", exposure});
        return read_bytes(in_folder(name)).values;
    };
    const auto plain = picture("a.png", "-2");
    const std::string mask = text_of(in_folder("m.png"));
    const auto doubled = picture("b.png", "-1");
    EXPECT_EQ(text_of(in_folder("m.png")), mask);
    ASSERT_EQ(plain.size(), doubled.size());
    for (std::size_t i = 0; i < plain.size(); ++i)
        ASSERT_NEAR(support::linear_of_srgb(doubled[i]), 2 * support::linear_of_srgb(plain[i]), 0.01);
    // Metered: at most one pixel of twenty of the scene is above .8 (one byte more is .807), and at least one of twenty
    // is there.
    render_quietly({"--size", "64x48", "-o", "c.png", "--exposure", "auto", "--aov", "c.exr", "--stats", "s.json"});
    const auto metered = read_bytes(in_folder("c.png")).values;
    const std::vector<Pixel> pixels = read_aov(in_folder("c.exr"));
    std::size_t seen = 0, above = 0, at_least = 0;
    for (std::size_t i = 0; i < pixels.size(); ++i) {
        if (pixels[i].receiver == sky) continue;
        ++seen;
        const double brightest = support::linear_of_srgb(*std::max_element(&metered[3 * i], &metered[3 * i] + 3));
        above += brightest > 0.803;
        at_least += brightest > 0.79;
    }
    EXPECT_LE(above, seen / 20);
    EXPECT_GE(at_least, seen / 20);
    EXPECT_TRUE(statistics("s.json").at("exposure_ev").is_number());
}

/// The share of the sky that an infinite street between walls as high as half its width sees from its middle:
/// the walls hide all but 45 degrees to each side of the zenith, sin(45) = .707 with cosine weights. Beside it an open
/// field, which sees all, and the outer side of a wall, which sees half.
TEST_F(Command, AStreetSeesItsShareOfTheSky) {
    constexpr float far = 4000;
    std::vector<float> triangles;
    const auto add = [&](std::array<float, 3> a, std::array<float, 3> b, std::array<float, 3> c,
                         std::array<float, 3> d) {
        for (const auto& p : {a, b, c, a, c, d}) triangles.insert(triangles.end(), p.begin(), p.end());
    };
    add({-20, 0, -far}, {-20, 0, far}, {1, 0, far}, {1, 0, -far});
    add({-1, 0, -far}, {-1, 0, far}, {-1, 1, far}, {-1, 1, -far});
    add({1, 0, -far}, {1, 0, far}, {1, 1, far}, {1, 1, -far});
    write_scene(folder_, "street", triangles);
    const auto share = [&](const char* eye, const char* target, const char* ambient) {
        render_quietly({"street.gltf", "--size", "1x1", "--aov", "a.exr", "--eye", eye, "--target", target, "--up",
                        "0,0,1", "--fovy", "1", "--light", "sun", "--ambient", ambient});
        const auto input = OIIO::ImageInput::open(in_folder("a.exr").string());
        const int channel = input->spec().channelindex("sky");
        float value = -1;
        EXPECT_TRUE(channel >= 0 && input->read_image(0, 0, channel, channel + 1, OIIO::TypeFloat, &value));
        return double(value);
    };
    EXPECT_NEAR(share("0,0.5,0", "0,0,0", "sky"), std::sqrt(0.5), 0.04);  // 145 patches
    EXPECT_NEAR(share("0,0.5,0", "0,0,0", "sky:5"), std::sqrt(0.5), 0.01);
    EXPECT_NEAR(share("-15,4,0", "-15,0,0", "sky:5"), 1, 0.01);
    // The wall's outer side: the half of the sky that is on its side.
    EXPECT_NEAR(share("-5,0.5,0", "-1,0.5,0", "sky:5"), 0.5, 0.01);
}

/// The irradiance of an upward point at `p` below a horizontal rectangle of radiance 1 at `height`: Lambert's sum over
/// its edges, of the angle that an edge spans at the point times the vertical part of its plane's normal, halved.
double under_a_rectangle(std::array<double, 2> p, double half, double height) {
    const std::array<std::array<double, 2>, 4> corners{{{-half, -half}, {half, -half}, {half, half}, {-half, half}}};
    double sum = 0;
    for (std::size_t i = 0; i < 4; ++i) {
        const auto &a = corners[i], &b = corners[(i + 1) % 4];
        const double ax = a[0] - p[0], az = a[1] - p[1], bx = b[0] - p[0], bz = b[1] - p[1];
        const double across = std::hypot(height * (bz - az), height * (ax - bx), ax * bz - az * bx);
        const double along = ax * bx + az * bz + height * height;
        sum += std::atan2(across, along) * (ax * bz - az * bx) / across;
    }
    return std::fabs(sum) / 2;
}

// A lamp of 4 x 4 over the floor at a height of 2; the square, of 1 x 1 at a height of 1, hides of it what lies behind
// a square of 2 x 2 as seen from the point below its middle.
TEST_F(Command, AnAreaLightHasItsClosedForm) {
    write_scene(folder_, "square", floor_and_square());
    const auto at = [&](const char* eye, const char* target, const char* lamp) {
        render_quietly({"square.gltf", "--size", "1x1", "--aov", "a.exr", "--eye", eye, "--target", target, "--up",
                        "0,0,1", "--fovy", "0.1", "--area-light", lamp, "--area-samples", "4096"});
        const auto input = OIIO::ImageInput::open(in_folder("a.exr").string());
        const auto value_of = [&](const char* name) {
            const int channel = input->spec().channelindex(name);
            float value = -1;
            EXPECT_TRUE(channel >= 0 && input->read_image(0, 0, channel, channel + 1, OIIO::TypeFloat, &value));
            return double(value);
        };
        return std::pair(value_of("irradiance"), value_of("visibility"));
    };
    const char* const down = "-2,2,-2,4,0,0,0,0,4";  // x cross z points down
    const double whole = under_a_rectangle({0, 0}, 2, 2), hidden = under_a_rectangle({0, 0}, 1, 2);
    const auto [below, share] = at("0,0.5,0", "0,0,0", down);
    EXPECT_NEAR(below, whole - hidden, 0.01 * whole);
    EXPECT_NEAR(share, (whole - hidden) / whole, 0.01);
    const auto [free, free_share] = at("3,0.5,0.5", "3,0,0.5", down);
    EXPECT_NEAR(free, under_a_rectangle({3, 0.5}, 2, 2), 0.01 * free);
    EXPECT_EQ(free_share, 1);
    // From twice as far and half as large: the inverse square, where the lamp is small.
    const double near = at("3,0.5,0.5", "3,0,0.5", "2.9,2,0.4,0.2,0,0,0,0,0.2").first;
    EXPECT_NEAR(at("3,0.5,0.5", "3,0,0.5", "2.9,4,0.4,0.2,0,0,0,0,0.2").first, near / 4, 0.01 * near);
    // Of its back nothing comes.
    const auto [behind, dark_share] = at("0,0.5,0", "0,0,0", "-2,2,-2,0,0,4,4,0,0");
    EXPECT_EQ(behind, 0);
    EXPECT_EQ(dark_share, 0);
}

TEST_F(Command, AnAreaLightIsInPictureMaskAndStatistics) {
    write_scene(folder_, "square", floor_and_square());
    render_quietly({"square.gltf", "--size", "64x48", "--camera", "above", "--mask", "m.png", "-o", "a.png", "--stats",
                    "s.json", "--area-light", "-1,3,-1,2,0,0,0,0,2", "--area-samples", "33"});
    const nlohmann::json stats = statistics("s.json");
    EXPECT_EQ(stats.at("light").at("type"), "area");
    EXPECT_EQ(stats.at("light").at("option"), "--area-light=-1,3,-1,2,0,0,0,0,2");
    EXPECT_EQ(stats.at("image").at("area_samples"), 33);
    EXPECT_GT(stats.at("pixels").at("partly"), 20);
    EXPECT_TRUE(stats.at("exposure_ev").is_number());
    const Bytes mask = read_bytes(in_folder("m.png"));
    EXPECT_EQ(std::ranges::count_if(mask.values, [](auto v) { return v > 0 && v < 255; }) > 20, true);
    const Outcome flat = run({"render", "-o", "b.png", "--area-light", "0,1,0,1,0,0,2,0,0"});
    EXPECT_EQ(flat.exit_code, 1);
    EXPECT_NE(flat.err.find("has no area"), std::string::npos) << flat.err;
    EXPECT_FALSE(fs::exists(in_folder("b.png")));
}

TEST_F(Command, ShadowsOfASquareOverAFloorUnderAVerticalLight) {
    const std::vector<float> vertices = floor_and_square();
    write_scene(folder_, "square", vertices);
    render_quietly({"square.gltf", "--size", "160x120", "--eye", "2,3,6", "--target", "0,0.5,0", "--light-direction",
                    "0,-1,0", "--aov", "a.exr", "--dump-triangles", "t.bin"});
    const std::string dump = text_of(in_folder("t.bin"));
    EXPECT_EQ(dump, text_of(in_folder("square.bin")));  // identity transforms: the file's own floats

    std::array<std::size_t, 4> seen{};  // floor in shadow, floor lit, square, sky
    for (const Pixel& pixel : read_aov(in_folder("a.exr"))) {
        if (pixel.receiver == sky) {
            ++seen[3];
            continue;
        }
        ASSERT_EQ(pixel.normal, (std::array<float, 3>{0, 1, 0}));
        const auto [x, y, z] = pixel.position;
        if (pixel.receiver >= 2) {  // the square's top
            ASSERT_GE(y, 1);
            ASSERT_EQ(pixel.visibility, 1);
            ++seen[2];
            continue;
        }
        // Edges block: the contract's triangles are closed.
        const bool under_the_square = std::fabs(x) <= 0.5f && std::fabs(z) <= 0.5f;
        ASSERT_EQ(pixel.visibility, under_the_square ? 0 : 1) << x << ' ' << y << ' ' << z;
        ++seen[under_the_square ? 0 : 1];
    }
    for (const std::size_t count : seen) EXPECT_GT(count, 50u);
}

TEST_F(Command, SettingsOfTheConservativeMapChangeNoBit) {
    write_scene(folder_, "square", floor_and_square());
    const Arguments render{"square.gltf", "--size", "160x120", "--camera", "above", "--light", "lamp"};
    std::string first;
    int number = 0;
    for (const Arguments& settings : {Arguments{"--conservative-map", "on"}, Arguments{"--conservative-map=off"},
                                      Arguments{"--conservative-map=auto"}, Arguments{"--map-size", "256"},
                                      Arguments{"--set", "map-size=1024", "--set=conservative-map=on"}}) {
        const std::string file = "mask" + std::to_string(number++) + ".png";
        Arguments arguments = render;
        arguments.insert(arguments.end(), settings.begin(), settings.end());
        arguments.insert(arguments.end(), {"--mask", file});
        render_quietly(arguments);
        const std::string bytes = text_of(in_folder(file));
        if (first.empty()) first = bytes;
        EXPECT_FALSE(bytes.empty());
        EXPECT_EQ(bytes, first) << file;
    }
}

TEST_F(Command, BothOptionFormsAlsoForNegativeValues) {
    const Arguments options{"--eye",  "-3,2.5,-4", "--target", "-0.1,0,-0", "--up",   "-0.2,1,0",
                            "--fovy", "45",        "--size",   "40x30",     "--mask", "apart.png",
                            "--aov",  "apart.exr", "--stats",  "apart.json"};
    Arguments apart = options, joined;
    for (std::size_t i = 0; i < options.size(); i += 2) {
        std::string value = options[i + 1];
        if (const std::size_t at = value.find("apart"); at != std::string::npos) value.replace(at, 5, "joined");
        joined.push_back(options[i] + "=" + value);
    }
    apart.insert(apart.end(), {"--light-direction", "-0.1,-2,-1e-3"});
    joined.emplace_back("--light-direction=-0.1,-2,-1e-3");
    render_quietly(apart);
    render_quietly(joined);
    EXPECT_EQ(text_of(in_folder("apart.png")), text_of(in_folder("joined.png")));
    EXPECT_EQ(text_of(in_folder("apart.exr")), text_of(in_folder("joined.exr")));
    const nlohmann::json a = statistics("apart.json"), b = statistics("joined.json");
    EXPECT_EQ(a.at("light"), b.at("light"));
    EXPECT_EQ(a.at("camera"), b.at("camera"));
    // Float32 as strtof reads it, and nine digits that give it back.
    EXPECT_EQ(a.at("light").at("type"), "directional");
    EXPECT_EQ(a.at("light").at("direction"), (nlohmann::json{double(-0.1f), -2.0, double(-1e-3f)}));
    EXPECT_EQ(a.at("light").at("option"), "--light-direction=-0.100000001,-2,-0.00100000005");
    EXPECT_EQ(a.at("camera").at("eye"), (nlohmann::json{-3.0, 2.5, -4.0}));
    EXPECT_EQ(a.at("camera").at("fov_y_radians"), 45 * std::acos(-1.0) / 180);
}

TEST_F(Command, TheShortOutputOptionTakesBothForms) {
    render_quietly({"-o", "a.png", "--size", "8x8"});
    render_quietly({"-o=b.png", "--size=8x8"});
    render_quietly({"--output=c.png", "--size", "9x9", "--size", "8x8"});  // the last one counts
    EXPECT_EQ(files(), (std::vector<std::string>{"a.png", "b.png", "c.png"}));
    EXPECT_EQ(text_of(in_folder("a.png")), text_of(in_folder("b.png")));
    EXPECT_EQ(text_of(in_folder("a.png")), text_of(in_folder("c.png")));
}

TEST_F(Command, CamerasAndLightsByNameAndByIndex) {
    write_scene(folder_, "square", floor_and_square());
    const auto stats_with = [&](Arguments more) {
        more.insert(more.begin(), {"square.gltf", "--size", "16x12", "--stats", "s.json"});
        render_quietly(more);
        return statistics("s.json");
    };
    const nlohmann::json plain = stats_with({}), named = stats_with({"--camera", "aside", "--light", "lamp"}),
                         numbered = stats_with({"--camera", "1", "--light=1"}), wide = stats_with({"--fovy", "90"});
    EXPECT_EQ(plain.at("camera").at("eye"), (nlohmann::json{0.0, 6.0, 0.0}));  // the scene's first
    EXPECT_EQ(plain.at("light").at("type"), "directional");
    EXPECT_EQ(named.at("camera").at("eye"), (nlohmann::json{0.0, 1.0, 9.0}));
    EXPECT_EQ(named.at("camera").at("fov_y_radians"), 0.9);
    EXPECT_EQ(named.at("light").at("type"), "positional");
    EXPECT_EQ(named.at("light").at("position"), (nlohmann::json{0.25, 3.5, -0.125}));
    EXPECT_EQ(numbered.at("camera"), named.at("camera"));
    EXPECT_EQ(numbered.at("light"), named.at("light"));
    EXPECT_EQ(wide.at("camera").at("forward"), plain.at("camera").at("forward"));
    EXPECT_EQ(wide.at("camera").at("fov_y_radians"), std::acos(0.0));
}

TEST_F(Command, StatisticsHaveEveryField) {
    write_scene(folder_, "square", floor_and_square());
    render_quietly(
        {"square.gltf", "--size", "32x24", "-o", "a.png", "--stats", "s.json", "--set", "map-size=512", "--profile"});
    const nlohmann::json stats = statistics("s.json");
    EXPECT_EQ(stats.at("command").at(1), "render");
    EXPECT_EQ("gnomon " + std::string(stats.at("version")) + "\n", run({"--version"}).out);
    EXPECT_EQ(stats.at("scene"), "square.gltf");
    EXPECT_EQ(stats.at("triangles"), 4);
    EXPECT_EQ(stats.at("image"), (nlohmann::json{{"width", 32}, {"height", 24}, {"samples", 1}}));
    EXPECT_EQ(stats.at("technique"), (nlohmann::json{{"name", "frustum-traced"}, {"settings", {{"map-size", "512"}}}}));
    EXPECT_EQ(stats.at("outputs"), (nlohmann::json{{"output", "a.png"}, {"stats", "s.json"}}));
    EXPECT_EQ(stats.at("warnings"), nlohmann::json::array());
    for (const char* field : {"name", "platform", "vendor", "driver_version"})
        EXPECT_FALSE(std::string(stats.at("device").at(field)).empty()) << field;
    EXPECT_GT(stats.at("memory").at("device_peak_bytes"), 4 * 36);  // the triangles alone
    EXPECT_GE(stats.at("memory").at("device_peak_bytes"), stats.at("memory").at("device_bytes"));
    double device_ms = 0;
    for (const char* part : {"camera_stages", "shadow_stages"}) {
        EXPECT_TRUE(stats.at(part).at("counts").is_object());
        EXPECT_FALSE(stats.at(part).at("stages").empty()) << part;
        for (const nlohmann::json& stage : stats.at(part).at("stages")) {
            EXPECT_FALSE(std::string(stage.at("name")).empty());
            EXPECT_TRUE(stage.at("skipped").is_string());
            EXPECT_GE(stage.at("wall_ms"), 0);
            device_ms += double(stage.at("device_ms"));
        }
    }
    EXPECT_GT(device_ms, 0);  // --profile turns the device's own clock on
    // The steps are the whole: what no step took is "other".
    double sum = 0;
    for (const auto& [name, ms] : stats.at("phases_ms").items()) {
        EXPECT_GE(double(ms), 0) << name;
        if (name != "total") sum += double(ms);
    }
    for (const char* const name :
         {"open_device", "load_scene", "kernels", "camera", "shadow", "shade", "write_picture"})
        EXPECT_TRUE(stats.at("phases_ms").contains(name)) << name;
    EXPECT_NEAR(sum, double(stats.at("phases_ms").at("total")), 1e-6 * sum);
}

// Without --profile nothing waits for a stage's end: there is no time of it, in the file or in the table.
TEST_F(Command, StagesHaveTimesOnlyWhereTheyWereMeasured) {
    const Outcome plain = run({"render", "--size", "32x24", "--stats", "s.json"});
    EXPECT_EQ(plain.exit_code, 0) << plain.err;
    for (const char* part : {"camera_stages", "shadow_stages"}) {
        const nlohmann::json all = statistics("s.json").at(part);
        EXPECT_FALSE(all.contains("wall_ms"));
        for (const nlohmann::json& stage : all.at("stages")) {
            EXPECT_TRUE(stage.contains("name"));
            EXPECT_FALSE(stage.contains("wall_ms") || stage.contains("device_ms")) << stage;
        }
    }
    EXPECT_EQ(plain.out.find("camera_visibility"), std::string::npos) << plain.out;
    for (const char* const step : {"open device", "kernels", "camera", "shadow", "other", "total"})
        EXPECT_NE(plain.out.find("\n  " + std::string(step)), std::string::npos) << plain.out;
    const Outcome profiled = run({"render", "--size", "32x24", "--stats", "s.json", "--profile"});
    EXPECT_NE(profiled.out.find("camera_visibility"), std::string::npos) << profiled.out;
}

// ---- Explanations ---------------------------------------------------------------------------------------------------

/// What stands in the output behind `label`, up to a comma or colon.
std::string word_behind(const std::string& out, const std::string& label) {
    const std::size_t first = out.find(label) + label.size();
    return out.substr(first, out.find_first_of(",:\n", first) - first);
}

// Pixels of every colour of the diagnostic "decided": each stage and level, backfacing points and the sky.
TEST_F(Command, ExplanationsAgreeWithTheMask) {
    const Arguments view{"--size", "400x225", "--eye", "2.45,2.95,1.75", "--target", "-0.3,1.6,-0.3"};
    const auto with_view = [&](Arguments arguments) {
        arguments.insert(arguments.end(), view.begin(), view.end());
        return arguments;
    };
    render_quietly(with_view({"--mask", "mask.png", "--diagnostic", "decided", "-o", "decided.png"}));
    const Bytes mask = read_bytes(in_folder("mask.png")), decided = read_bytes(in_folder("decided.png"));
    std::map<std::array<std::uint8_t, 3>, int> of_color;
    std::map<std::string, int> of_stage;
    for (std::size_t at = 0; at < mask.values.size(); ++at) {
        const std::size_t i = at * 7 % mask.values.size();  // all pixels, but neighbours far apart
        if (++of_color[{decided.values[3 * i], decided.values[3 * i + 1], decided.values[3 * i + 2]}] > 2) continue;
        const std::string pixel = std::to_string(i % 400) + "," + std::to_string(i / 400);
        const Outcome outcome = run(with_view({"explain", "--pixel", pixel}));
        ASSERT_EQ(outcome.exit_code, 0) << outcome.err;  // 1 if the signs say otherwise
        EXPECT_EQ(word_behind(outcome.out, "result    "), mask.values[i] == 255 ? "lit" : "in shadow") << pixel;
        const bool is_sky = outcome.out.find("a pixel of the sky") != std::string::npos;
        ++of_stage[is_sky ? "sky" : word_behind(outcome.out, "decided   by the stage ")];
    }
    for (const char* const stage : {"sky", "facing", "conservative_map", "trace", "exact_trace"})
        EXPECT_GT(of_stage[stage], 0) << stage << " decided no pixel of the sample";
}

TEST_F(Command, ExplainsAPointOfDumpedTriangles) {
    write_scene(folder_, "square", floor_and_square());
    render_quietly({"square.gltf", "--dump-triangles", "square.triangles", "--size", "8x8"});
    const Arguments floor_point{"explain",    "--triangles", "square.triangles",  "--point=0.25,0,-0.125",
                                "--receiver", "1",           "--light-direction", "0,-1,0"};
    Outcome outcome = run(floor_point);
    EXPECT_EQ(outcome.exit_code, 0) << outcome.err;
    for (const char* const text : {"0x1p-2,0x0p+0,-0x1p-3", "receiver  triangle 1", "in shadow", "triangle 3", "trace"})
        EXPECT_NE(outcome.out.find(text), std::string::npos) << text << "\n" << outcome.out;
    // Seen from below, its side is turned away from the light.
    Arguments from_below = floor_point;
    from_below.insert(from_below.end(), {"--eye", "0,-1,0"});
    outcome = run(from_below);
    EXPECT_NE(outcome.out.find("backfacing"), std::string::npos) << outcome.out;

    std::ofstream(in_folder("cut.triangles")) << "12345";
    expect_failure({"explain", "--triangles", "cut.triangles", "--point", "0,0,0"}, 1, "holds 5 bytes");
    expect_failure({"explain", "--triangles", "none.triangles", "--point", "0,0,0"}, 1,
                   "cannot read none.triangles: it does not exist");
    expect_failure({"explain", "--triangles", ".", "--point", "0,0,0"}, 1, "cannot read .: it is a folder");
    expect_failure({"explain", "none.glb", "--pixel", "0,0"}, 1, "none.glb");
    expect_failure({"explain", "square.gltf", "--point", "0,0,0", "--receiver", "4"}, 1,
                   "--receiver 4 is no triangle: the scene has 4");
}

TEST_F(Command, ExplainsThatARayPassesAHole) {
    const Arguments point{"explain", GNOMON_SCENES "/leaves.glb", "--light", "straight_down", "--point=2.1,0,1.1"};
    const Outcome outcome = run(point);
    EXPECT_EQ(outcome.exit_code, 0) << outcome.err;
    EXPECT_NE(outcome.out.find("result    lit"), std::string::npos) << outcome.out;
    EXPECT_NE(outcome.out.find("which meets them where their texture is clear, nearest first: 1"), std::string::npos)
        << outcome.out;
    EXPECT_NE(outcome.out.find("1.5 from the point"), std::string::npos) << outcome.out;
}

// Of the techniques that are not exact, two do not test masks.
TEST_F(Command, TechniquesThatDoNotTestMasksAreNamed) {
    const auto arguments = [](const char* technique) {
        return Arguments{"render",      GNOMON_SCENES "/leaves.glb",
                         "--size",      "32x24",
                         "--mask",      "m.png",
                         "--quiet",     "--strict",
                         "--technique", technique};
    };
    expect_failure(arguments("shadow-volumes"), 1, "takes triangles that are cut out by their alpha for opaque ones");
    expect_failure(arguments("conservative-map"), 1, "leaves out triangles that are cut out by their alpha");
    for (const char* const technique : {"frustum-traced", "shadow-map", "sub-pixel"}) {
        const Outcome outcome = run(arguments(technique));
        EXPECT_EQ(outcome.exit_code, 0) << outcome.err;
    }
}

TEST_F(Command, ExplainsASampleOfAPixel) {
    render_quietly({"--size", "16x12", "--samples", "4", "--dump-points", "points.bin", "--mask", "mask.png"});
    const std::vector<DumpedPoint> points = read_points(in_folder("points.bin"));
    const Bytes mask = read_bytes(in_folder("mask.png"));
    ASSERT_EQ(points.size(), 4u * 16 * 12);
    const std::size_t pixel = 6 * 16 + 9;
    int lit = 0;
    for (std::size_t sample = 0; sample < 4; ++sample) {
        const Outcome outcome =
            run({"explain", "--size", "16x12", "--pixel", "9,6", "--samples", "4", "--sample", std::to_string(sample)});
        ASSERT_EQ(outcome.exit_code, 0) << outcome.err;
        const DumpedPoint& point = points[sample * 16 * 12 + pixel];
        std::array<float, 3> p{};
        const std::size_t at = outcome.out.find("point     ");
        ASSERT_EQ(std::sscanf(outcome.out.c_str() + at, "point %f,%f,%f", &p[0], &p[1], &p[2]), 3) << outcome.out;
        EXPECT_EQ(p, point.position) << sample;
        EXPECT_NE(outcome.out.find("receiver  triangle " + std::to_string(point.receiver) + " "), std::string::npos);
        lit += word_behind(outcome.out, "result    ") == "lit";
    }
    EXPECT_EQ(mask.values[pixel], std::lround(255 * lit / 4.0));
}

TEST_F(Command, AnExistingFileIsReplacedWholeAndALinkIsFollowed) {
    std::ofstream(in_folder("old.png")) << "old";
    fs::permissions(in_folder("old.png"), fs::perms::owner_read | fs::perms::owner_write);
    fs::create_symlink("old.png", in_folder("link.png"));
    render_quietly({"-o", "link.png", "--size", "8x8"});
    EXPECT_TRUE(fs::is_symlink(in_folder("link.png")));
    EXPECT_EQ(fs::status(in_folder("old.png")).permissions(), fs::perms::owner_read | fs::perms::owner_write);
    EXPECT_EQ(read_bytes(in_folder("old.png")).spec.width, 8);
    render_quietly({"--stats", "/dev/null", "--size", "8x8"});
    EXPECT_TRUE(fs::is_character_file("/dev/null"));
}

/// A render whose dump of triangles goes to a pipe, so that writing it takes as long as the test wants.
class SlowCommand : public Command {
protected:
    void SetUp() override {
        Command::SetUp();
        std::vector<float> many;
        while (many.size() * sizeof(float) <= 1 << 20) {  // more than a pipe holds
            const std::vector<float> more = floor_and_square();
            many.insert(many.end(), more.begin(), more.end());
        }
        write_scene(folder_, "many", many);
        bytes_ = many.size() * sizeof(float);
        const std::string pipe = in_folder("pipe").string();
        ASSERT_EQ(mkfifo(pipe.c_str(), 0600), 0);
        reader_ = open(pipe.c_str(), O_RDONLY | O_NONBLOCK);
        ASSERT_GE(reader_, 0);
    }
    void TearDown() override { close(reader_); }

    /// Starts it, and returns when the dump has begun.
    void start_dump(const std::string& stderr_to, bool quiet) {
        Arguments arguments{"render", "many.gltf", "--size", "8x8", "--dump-triangles", "pipe"};
        if (quiet) arguments.emplace_back("--quiet");
        child_ = start(arguments, {{}, "", stderr_to});
        for (; dumped_ == 0 && waitpid(child_, nullptr, WNOHANG) == 0; sleep()) read_pipe();
    }

    /// Whether `text` is shown within three seconds; `look` returns what is shown so far.
    static bool is_shown(const std::string& text, const std::function<std::string()>& look) {
        const auto begin = std::chrono::steady_clock::now();
        for (; std::chrono::steady_clock::now() - begin < std::chrono::seconds(3); sleep())
            if (look().find(text) != std::string::npos) return true;
        return false;
    }

    void end_dump() {
        const auto begin = std::chrono::steady_clock::now();
        while (dumped_ < bytes_ && std::chrono::steady_clock::now() - begin < std::chrono::minutes(1)) read_pipe();
        EXPECT_EQ(finish(child_).exit_code, 0);
    }

private:
    static void sleep() { std::this_thread::sleep_for(std::chrono::milliseconds(10)); }

    void read_pipe() {
        std::array<char, 65536> buffer{};
        const ssize_t count = read(reader_, buffer.data(), buffer.size());
        if (count > 0) dumped_ += std::size_t(count);
    }

    int reader_ = -1;
    std::size_t bytes_ = 0, dumped_ = 0;
    pid_t child_ = 0;
};

class SlowCommandOnATerminal : public SlowCommand, public testing::WithParamInterface<bool> {};

TEST_P(SlowCommandOnATerminal, ShowsProgressAfterASecondUnlessQuietAndClearsIt) {
    const bool quiet = GetParam();
    const int terminal = posix_openpt(O_RDWR | O_NOCTTY | O_NONBLOCK);
    ASSERT_TRUE(terminal >= 0 && grantpt(terminal) == 0 && unlockpt(terminal) == 0);
    const std::string terminal_name = ptsname(terminal);
    // Kept open: what was written to a terminal is lost when its last user closes it.
    const int keeper = open(terminal_name.c_str(), O_RDWR | O_NOCTTY);
    std::string shown;
    const auto look = [&] {
        std::array<char, 4096> buffer{};
        for (ssize_t count = 0; (count = read(terminal, buffer.data(), buffer.size())) > 0;)
            shown.append(buffer.data(), std::size_t(count));
        return shown;
    };
    start_dump(terminal_name, quiet);
    EXPECT_EQ(is_shown("gnomon: writing the triangles ... 2 s", look), !quiet) << shown;
    end_dump();
    look();
    if (quiet) {
        EXPECT_EQ(shown, "");
    } else {
        EXPECT_EQ(shown.substr(shown.size() - 4), "\r\033[K") << shown;  // the line is cleared
    }
    for (const int descriptor : {terminal, keeper}) close(descriptor);
}

INSTANTIATE_TEST_SUITE_P(Quiet, SlowCommandOnATerminal, testing::Bool());

class SlowCommandInAPipe : public SlowCommand, public testing::WithParamInterface<bool> {};

TEST_P(SlowCommandInAPipe, TellsProgressInLinesUnlessQuiet) {
    const bool quiet = GetParam();
    const fs::path errors = in_folder("errors");
    const auto look = [&] { return text_of(errors); };
    start_dump(errors.string(), quiet);
    EXPECT_EQ(is_shown("gnomon: writing the triangles ... 2 s\n", look), !quiet) << look();
    end_dump();
    EXPECT_EQ(look().empty(), quiet);
    EXPECT_EQ(std::regex_replace(look(), progress, ""), "");
}

INSTANTIATE_TEST_SUITE_P(Quiet, SlowCommandInAPipe, testing::Bool());

TEST_F(Command, WarningsAreErrorsUnderStrict) {
    write_scene(folder_, "glass", floor_and_square(), "BLEND");
    std::vector<float> broken = floor_and_square();
    broken[20] = std::numeric_limits<float>::quiet_NaN();
    write_scene(folder_, "broken", broken);
    for (const std::string scene : {"glass", "broken"}) {
        const std::string file = scene + ".gltf";
        const Outcome warned = run({"render", file, "--size", "16x12", "--stats", scene + ".json", "--quiet"});
        EXPECT_EQ(warned.exit_code, 0) << warned.err;
        EXPECT_EQ(warned.err.rfind("gnomon: warning: ", 0), 0u) << warned.err;
        EXPECT_EQ(std::count(warned.err.begin(), warned.err.end(), '\n'), 1) << warned.err;
        EXPECT_EQ(warned.err,
                  "gnomon: warning: " + std::string(statistics(scene + ".json").at("warnings").at(0)) + "\n");
        expect_failure({"render", file, "--size", "16x12", "-o", "b.png", "--strict"}, 1, "--strict");
    }
    EXPECT_EQ(statistics("glass.json").at("non_finite_triangles"), 0);
    EXPECT_EQ(statistics("broken.json").at("non_finite_triangles"), 1);
}

// ---- Animations
// ---------------------------------------------------------------------------------------------------------

/// Writes the scene of write_scene as "moving.gltf": at second T everything has moved by T along x, up to 4 s.
void write_moving_scene(const fs::path& folder) {
    write_scene(folder, "moving", floor_and_square());
    nlohmann::json gltf = nlohmann::json::parse(text_of(folder / "moving.gltf"));
    const std::vector<float> keyframes{0, 4, 0, 0, 0, 4, 0, 0};
    std::ofstream(folder / "keyframes.bin", std::ios::binary)
        .write(reinterpret_cast<const char*>(keyframes.data()), std::streamsize(keyframes.size() * sizeof(float)));
    const auto add = [&](const char* array, const char* text) { gltf[array].push_back(nlohmann::json::parse(text)); };
    add("buffers", R"({"uri": "keyframes.bin", "byteLength": 32})");
    add("bufferViews", R"({"buffer": 1, "byteLength": 32})");
    add("accessors", R"({"bufferView": 1, "componentType": 5126, "count": 2, "type": "SCALAR"})");
    add("accessors", R"({"bufferView": 1, "byteOffset": 8, "componentType": 5126, "count": 2, "type": "VEC3"})");
    add("animations", R"({"name": "walk", "samplers": [{"input": 1, "output": 2}],
                          "channels": [{"sampler": 0, "target": {"node": 0, "path": "translation"}}]})");
    std::ofstream(folder / "moving.gltf") << gltf;
}

TEST_F(Command, TheSecondProcessOfAFirstStartIsNotSeen) {
    write_scene(folder_, "plain", floor_and_square());
    write_scene(folder_, "masked", floor_and_square(), "MASK");
    const auto notes = [&](const std::string& cache) {
        std::size_t count = 0;
        if (!fs::exists(root_ / cache)) return count;
        for (const auto& entry : fs::directory_iterator(root_ / cache))
            count += entry.path().filename().string().starts_with("compiled-");
        return count;
    };
    const auto render = [&](const std::string& scene, const std::string& camera, const std::string& picture,
                            const std::string& cache) {
        RunOptions options;
        options.environment["GNOMON_CACHE_DIR"] = (root_ / cache).string();
        return run({"render", scene + ".gltf", "--camera", camera, "-o", picture, "--size", "64x64", "--quiet"},
                   options);
    };
    for (const char* picture : {"first.png", "second.png"}) {
        const Outcome outcome = render("plain", "0", picture, "cache");
        EXPECT_EQ(outcome.exit_code, 0);
        EXPECT_EQ(outcome.out + outcome.err, "");
        EXPECT_EQ(notes("cache"), 1u) << picture;
    }
    EXPECT_EQ(text_of(in_folder("first.png")), text_of(in_folder("second.png")));
    EXPECT_EQ(render("masked", "0", "masked.png", "cache").exit_code, 0);
    EXPECT_EQ(notes("cache"), 2u) << "cut-outs have kernels of their own";
    EXPECT_EQ(render("plain", "none", "none.png", "other").exit_code, 1);
    EXPECT_EQ(notes("other"), 0u) << "no picture was made";
}

TEST_F(Command, FramesAreThePicturesOfTheirTimes) {
    write_moving_scene(folder_);
    const Arguments view{"moving.gltf", "--size", "48x32", "--camera", "aside", "--light", "lamp"};
    Arguments sequence = view;
    sequence.insert(sequence.end(), {"--frames", "3", "--fps", "2", "--time", "0.5", "-o", "p.png", "--mask", "m.png",
                                     "--dump-triangles", "t.bin", "--stats", "s.json"});
    render_quietly(sequence);
    const nlohmann::json stats = statistics("s.json");
    ASSERT_EQ(stats.at("frames").size(), 3u);
    EXPECT_EQ(stats.at("animation").at("name"), "walk");
    EXPECT_EQ(stats.at("animation").at("time_s"), 1.5) << "the last frame's";
    for (int frame = 0; frame < 3; ++frame) {
        const std::string number = "_000" + std::to_string(frame), time = std::to_string(0.5 + 0.5 * frame);
        EXPECT_EQ(stats.at("frames").at(std::size_t(frame)).at("time_s"), 0.5 + 0.5 * frame);
        EXPECT_GT(stats.at("frames").at(std::size_t(frame)).at("phases_ms").at("total"), 0);
        Arguments alone = view;
        alone.insert(alone.end(), {"--time", time, "--animation", "walk", "-o", "alone.png", "--mask", "alone_m.png",
                                   "--dump-triangles", "alone.bin"});
        render_quietly(alone);
        EXPECT_EQ(text_of(in_folder("p" + number + ".png")), text_of(in_folder("alone.png")));
        EXPECT_EQ(text_of(in_folder("m" + number + ".png")), text_of(in_folder("alone_m.png")));
        EXPECT_EQ(text_of(in_folder("t" + number + ".bin")), text_of(in_folder("alone.bin")));
    }
    float x = 0;
    std::memcpy(&x, text_of(in_folder("t_0002.bin")).data(), sizeof x);
    EXPECT_EQ(x, -4 + 1.5f);
    EXPECT_NE(text_of(in_folder("m_0000.png")), text_of(in_folder("m_0002.png")));
}

TEST_F(Command, TheDefaultViewSaysWhatItDoesNotFrame) {
    write_moving_scene(folder_);
    nlohmann::json gltf = nlohmann::json::parse(text_of(in_folder("moving.gltf")));
    for (const char* camera : {"/nodes/1/camera", "/nodes/2/camera"})
        gltf = gltf.patch({{{"op", "remove"}, {"path", camera}}});
    gltf["meshes"][0]["name"] = "yard";
    std::ofstream(in_folder("moving.gltf")) << gltf;
    const auto notes = [&](Arguments arguments, const Arguments& more = {}) {
        arguments.insert(arguments.end(), more.begin(), more.end());
        const Outcome outcome = run(arguments);
        EXPECT_EQ(outcome.exit_code, 0) << outcome.err;
        const std::string note = "note: the default view does not frame 2 of 4 triangles, 2 of mesh 'yard': ";
        std::size_t count = 0;
        for (std::size_t at = 0; (at = outcome.err.find(note, at)) != std::string::npos; ++at) ++count;
        return count;
    };
    const Arguments render{"render", "moving.gltf", "--size", "16x16", "-o", "a.png"};
    EXPECT_EQ(notes(render, {"--frames", "3", "--time", "0"}), 1u);
    EXPECT_EQ(notes({"explain", "moving.gltf", "--size", "16x16", "--pixel", "8,8"}), 1u);
    EXPECT_EQ(
        notes({"hours", "moving.gltf", "--size", "4x4", "--place", "10,10", "--day", "2026-06-21", "-o", "a.png"}), 1u);
    EXPECT_EQ(notes(render, {"--quiet"}), 0u);
    EXPECT_EQ(notes(render, {"--eye", "0,9,9", "--target", "0,0,0"}), 0u);
}

TEST_F(Command, AnimationsAndScenesThatAreNotThere) {
    write_moving_scene(folder_);
    write_scene(folder_, "still", floor_and_square());
    expect_failure({"render", "moving.gltf", "-o", "a.png", "--animation", "run"}, 1,
                   "there is no animation 'run': the file has these: 0 'walk'");
    expect_failure({"render", "moving.gltf", "-o", "a.png", "--scene", "1"}, 1, "there is no scene '1'");
    expect_failure({"render", "still.gltf", "-o", "a.png", "--time", "1"}, 1, "has no animations");
    expect_failure({"render", "still.gltf", "-o", "a.png", "--frames", "2"}, 1, "has no animations");
}

// ---- The gallery ----------------------------------------------------------------------------------------------------

/// What the page's script reads.
nlohmann::json page_data(const std::string& html) {
    const std::string open = "<script type=\"application/json\" id=\"data\">";
    const std::size_t begin = html.find(open) + open.size();
    return nlohmann::json::parse(html.substr(begin, html.find("</script>", begin) - begin));
}

// One camera pass serves all lights; each has its own mask and statistics, as if it were alone.
TEST_F(Command, AllLightsOfASceneInOneRun) {
    write_scene(folder_, "square", floor_and_square());
    const Arguments view{"square.gltf", "--camera", "above", "--size", "60x40"};
    const auto with = [&](const Arguments& more) {
        Arguments arguments = view;
        arguments.insert(arguments.end(), more.begin(), more.end());
        return arguments;
    };
    render_quietly(with({"--light", "sun", "--mask", "sun.png", "-o", "sun_lit.png"}));
    render_quietly(with({"--light", "lamp", "--mask", "lamp.png", "-o", "lamp_lit.png"}));
    render_quietly(
        with({"--light", "all", "--mask", "mask.png", "-o", "lit.png", "--stats", "stats.json", "--exposure", "0"}));
    EXPECT_EQ(text_of(in_folder("mask_0.png")), text_of(in_folder("sun.png")));
    EXPECT_EQ(text_of(in_folder("mask_1.png")), text_of(in_folder("lamp.png")));
    EXPECT_NE(text_of(in_folder("mask_0.png")), text_of(in_folder("mask_1.png")));
    EXPECT_FALSE(fs::exists(in_folder("mask.png")));
    const auto both = read_bytes(in_folder("lit.png")).values, sun = read_bytes(in_folder("sun_lit.png")).values,
               lamp = read_bytes(in_folder("lamp_lit.png")).values;
    // From above the square hides the sun's shadow, and the floor is white where the sun reaches it: also where the
    // lamp does not.
    std::size_t than_lamp = 0;
    for (std::size_t i = 0; i < both.size(); ++i) {
        EXPECT_GE(both[i], std::max(sun[i], lamp[i]));
        than_lamp += both[i] > lamp[i];
    }
    EXPECT_GT(than_lamp, 20u);
    const nlohmann::json stats = statistics("stats.json");
    ASSERT_EQ(stats.at("lights").size(), 2u);
    EXPECT_EQ(stats.at("lights").at(0).at("light").at("type"), "directional");
    EXPECT_EQ(stats.at("lights").at(1).at("light").at("type"), "positional");
    for (const nlohmann::json& light : stats.at("lights")) {
        EXPECT_EQ(light.at("shadow_stages").at("counts").at("points"), 60 * 40);
        EXPECT_EQ(int(light.at("pixels").at("lit")) + int(light.at("pixels").at("in_shadow")), 60 * 40);
    }
    EXPECT_FALSE(stats.contains("light"));
    EXPECT_EQ(stats.at("outputs").at("mask_1"), "mask_1.png");
}

TEST_F(Command, AllLightsAreRefusedWhereThereIsButRoomForOne) {
    write_scene(folder_, "square", floor_and_square());
    expect_failure({"render", "square.gltf", "--light", "all", "--aov", "a.exr"}, 2, "--aov");
    expect_failure({"render", "square.gltf", "--light", "all", "--diagnostic", "decided", "-o", "a.png"}, 2, "--light");
    expect_failure({"gallery", "square.gltf", "--light", "all"}, 1, "there is no light \"all\"");
}

TEST_F(Command, AGalleryShowsEachTechniqueBesideTheTruth) {
    // The name would end the script if it went into the page as it is.
    write_scene(folder_, "a<!--<script>b", floor_and_square());
    const Outcome outcome =
        run({"gallery", "a<!--<script>b.gltf", "-o", "page.html", "--size", "40x30", "--runs", "1", "--camera", "above",
             "--technique", "frustum-traced:conservative-map=off,map-size=64", "--technique", "rtw:size=64"});
    ASSERT_EQ(outcome.exit_code, 0) << outcome.err;
    const std::string html = text_of(in_folder("page.html"));
    EXPECT_EQ(html.rfind("<!DOCTYPE html>", 0), 0u);
    EXPECT_EQ(html.find("http"), std::string::npos) << "a self-contained page asks for nothing";
    for (const char* part : {"<svg id=\"chart\"", "function chart()", "if (shown.length) chart();"})
        EXPECT_NE(html.find(part), std::string::npos) << "the page draws no run time against error: " << part;
    const nlohmann::json data = page_data(html);
    EXPECT_EQ(data.at("title"), "gnomon: a<!--<script>b.gltf");
    ASSERT_EQ(data.at("exhibits").size(), 3u);
    EXPECT_EQ(data.at("exhibits").at(1).at("settings"), "conservative-map=off map-size=64");
    for (const nlohmann::json& exhibit : data.at("exhibits")) {
        const bool is_exact = exhibit.at("exact");
        EXPECT_EQ(exhibit.at("name"), is_exact ? "frustum-traced" : "rtw");
        EXPECT_EQ(exhibit.at("points"), 40 * 30);
        if (is_exact) {
            EXPECT_EQ(exhibit.at("wrongly_lit"), 0);
            EXPECT_EQ(exhibit.at("wrongly_shadowed"), 0);
        }
        std::string diagnostics;
        for (const nlohmann::json& diagnostic : exhibit.at("diagnostics")) {
            diagnostics += std::string(diagnostic.at("name")) + " ";
            EXPECT_EQ(std::string(diagnostic.at("picture")).rfind("data:image/", 0), 0u);
        }
        EXPECT_EQ(diagnostics, is_exact ? "decided " : "aliasing grid views depth warp ");
        EXPECT_GT(exhibit.at("median_ms"), 0);
        EXPECT_EQ(std::string(exhibit.at("picture")).rfind("data:image/jpeg;base64,/9j/", 0), 0u);
        EXPECT_EQ(std::string(exhibit.at("difference")).rfind("data:image/png;base64,iVBORw0KGgo", 0), 0u);
    }
}

TEST_F(Command, AGallerysMapsFitTheReceiversUnlessAsked) {
    write_scene(folder_, "square", floor_and_square());
    const Outcome outcome = run({"gallery", "square.gltf", "-o", "page.html", "--size", "40x30", "--runs", "1",
                                 "--technique", "pssm", "--technique", "pssm:fit=frustum", "--technique", "sdsm"});
    ASSERT_EQ(outcome.exit_code, 0) << outcome.err;
    const nlohmann::json data = page_data(text_of(in_folder("page.html")));
    const nlohmann::json& exhibits = data.at("exhibits");
    ASSERT_EQ(exhibits.size(), 4u);
    EXPECT_EQ(exhibits.at(1).at("settings"), "fit=receivers");
    EXPECT_EQ(exhibits.at(2).at("settings"), "fit=frustum");
    EXPECT_EQ(exhibits.at(3).at("settings"), "");  // it has fitted the receivers before
}

TEST_F(Command, AGalleryOfADiskMeasuresPenumbrae) {
    write_scene(folder_, "square", floor_and_square());
    const Arguments soft{"gallery",       "square.gltf", "-o",          "page.html",   "--size",
                         "240x160",       "--runs",      "1",           "--light",     "sun",
                         "--sun-angle",   "8",           "--technique", "pcss",        "--eye",
                         "2,3,6",         "--target",    "0,0.5,0",     "--technique", "pcss:light-size=0.5",
                         "--sun-samples", "100"};
    const Outcome outcome = run(soft);
    ASSERT_EQ(outcome.exit_code, 0) << outcome.err;
    const nlohmann::json data = page_data(text_of(in_folder("page.html")));
    const nlohmann::json& exhibits = data.at("exhibits");
    ASSERT_EQ(exhibits.size(), 4u);
    EXPECT_EQ(exhibits.at(0).at("settings"), "soft: 100 lights on the disk");
    EXPECT_EQ(exhibits.at(0).at("exact"), true);
    EXPECT_EQ(exhibits.at(0).at("penumbra_mean_absolute"), 0);
    EXPECT_EQ(exhibits.at(1).at("exact"), false);                                              // the hard shadow
    EXPECT_EQ(std::string(exhibits.at(2).at("settings")).substr(0, 17), "light-size=0.1405");  // tan(8 degrees)
    EXPECT_EQ(exhibits.at(3).at("settings"), "light-size=0.5");
    for (const nlohmann::json& exhibit : exhibits) EXPECT_GT(exhibit.at("penumbra_points"), 20);
    for (std::size_t i = 1; i < 4; ++i) EXPECT_GT(exhibits.at(i).at("penumbra_mean_absolute"), 0);
    expect_failure({"gallery", "square.gltf", "--light", "lamp", "--sun-angle", "1"}, 1, "for directional lights");
}

TEST_F(Command, AGalleryRefusesWhatItCannotShow) {
    expect_failure({"gallery", "--technique", "magic"}, 2, "there is no technique \"magic\"");
    expect_failure({"gallery", "--technique", "frustum-traced:map-size"}, 2, "key=value");
    expect_failure({"gallery", "--technique", "frustum-traced:map-size=9"}, 1, "map-size");
    expect_failure({"gallery", "--runs", "0"}, 2, "whole number from 1 to 1000");
    expect_failure({"gallery", "-o", "page.png"}, 2, ".html");
    expect_failure({"gallery", "none.glb"}, 1, "none.glb");
}

}  // namespace
