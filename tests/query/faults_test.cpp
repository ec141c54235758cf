// SPDX-License-Identifier: MIT
// Faults of the device: every OpenCL call of a frame (camera, shadows, picture, reading back) fails once, by injection
// (host/cl/session.hpp). Each time the error is the documented one and names the call; then the same objects are used
// again and give the right bits, and no device memory is lost.
#include <gtest/gtest.h>

#include <set>
#include <string>
#include <vector>

#include "query/inputs.hpp"
#include "support/environment.hpp"
#include "support/scene_makers.hpp"

namespace {

using gnomon::Device;
using gnomon::Light;
using support::Floats;

constexpr std::uint32_t width = 24, height = 16;
constexpr std::size_t scattered_count = 100;

const Floats& vertices() {
    static const Floats soup = support::soup(60, 0.5f, 3);
    return soup;
}

/// The techniques with code of their own: the other names are settings of shadow-map.
std::vector<gnomon::TechniqueDescription> all_techniques() {
    std::vector<gnomon::TechniqueDescription> chosen;
    for (const gnomon::TechniqueDescription& technique : gnomon::techniques())
        if (technique.exact || technique.name == "shadow-map" || technique.name == "shadow-volumes" ||
            technique.name == "sub-pixel" || technique.name == "conservative-map" ||
            technique.name == "virtual-shadow-map")
            chosen.push_back(technique);
    return chosen;
}

enum class Lists {
    roomy,  ///< never grow: a frame's room depends on the order of the work-items, but kept memory must not
    tight   ///< must grow in the first run
};

/// A technique with small maps.
std::unique_ptr<gnomon::Technique> made(const gnomon::TechniqueDescription& description, const Device& device,
                                        Lists lists) {
    auto technique = gnomon::make_technique(description.name, device);
    for (const gnomon::SettingDescription& setting : description.settings) {
        if (setting.name == "first-capacity" && lists == Lists::tight) technique->set(setting.name, "16");
        if (setting.name == "map-size") technique->set(setting.name, "64");
        if (setting.name == "size") technique->set(setting.name, "128");
    }
    return technique;
}

/// All data that are copied to the host.
struct Bits {
    Floats seen, scattered;  ///< visibility of the view, and of points without a view
    Floats mean;             ///< of several samples per pixel
    std::vector<std::uint8_t> picture;
    gnomon::ViewOnHost view;
    std::uint64_t run_bytes = 0, samples_bytes = 0;  ///< the memory that the runs report

    /// Compares without the bytes: the first run may need more, while its lists grow.
    bool operator==(const Bits& other) const {
        return seen == other.seen && scattered == other.scattered && mean == other.mean && picture == other.picture &&
               view.position == other.view.position && view.normal == other.view.normal &&
               view.receiver == other.view.receiver;
    }
};

Bits frame(const Device& device, gnomon::Technique& technique, const Light& light, bool is_for_anything) {
    auto triangles = gnomon::Triangles::upload(device, vertices());
    triangles.keep_clusters(device);
    const auto camera = gnomon::Camera::look_at({0, 1, 4}, {0, 0, 0}, {0, 1, 0}, 40);
    const gnomon::View view = look(device, triangles, camera, width, height);
    const gnomon::Visibility visibility(device, view.points.count());
    Bits bits;
    bits.run_bytes = technique.run(triangles, view.points, light, visibility).device_memory_bytes;
    bits.seen = visibility.read();
    if (is_for_anything) {
        const auto points = gnomon::Points::upload(device, support::random_points(scattered_count, -1, 1, 7),
                                                   std::vector<std::uint32_t>(scattered_count, gnomon::no_receiver));
        const gnomon::Visibility scattered(device, points.count());
        technique.run(triangles, points, light, scattered);
        bits.scattered = scattered.read();
        const gnomon::Visibility mean(device, view.points.count());
        bits.samples_bytes = run_samples(technique, triangles, view, light, 4, mean).device_memory_bytes;
        bits.mean = mean.read();
    }
    gnomon::Materials materials{std::vector<std::uint32_t>(triangles.count(), 0), {{1, 0.5f, 0.25f}}};
    bits.picture = shade(device, triangles, view, visibility, materials, light);
    bits.view = view.read(device, triangles);
    return bits;
}

/// The error of `code`, with the call and the code's name in its sentence.
void expect_documented(const gnomon::OpenClError& error, cl_int code, const std::string& call) {
    const bool is_memory = code == CL_MEM_OBJECT_ALLOCATION_FAILURE;
    const std::string sentence = error.what();
    const std::string wanted = call + " failed with " +
                               (is_memory ? "CL_MEM_OBJECT_ALLOCATION_FAILURE (-4): ask for fewer points at once"
                                          : "CL_DEVICE_NOT_AVAILABLE (-2)");
    EXPECT_EQ(sentence, wanted);
    EXPECT_EQ(error.code(), code);
    EXPECT_EQ(typeid(error) == typeid(gnomon::OutOfDeviceMemory), is_memory) << sentence;
}

struct Case {
    gnomon::TechniqueDescription technique;
    bool has_point_light;
};

std::vector<Case> all_cases() {
    std::vector<Case> cases;
    for (const gnomon::TechniqueDescription& technique : all_techniques())
        for (const bool has_point_light : {false, true}) cases.push_back({technique, has_point_light});
    return cases;
}

std::string case_name(const testing::TestParamInfo<Case>& info) {
    std::string name = info.param.technique.name + (info.param.has_point_light ? "_point_light" : "_sun");
    for (char& c : name)
        if (c == '-') c = '_';
    return name;
}

class EveryCall : public testing::TestWithParam<Case> {};

TEST_P(EveryCall, FailsOnceWithAClearErrorAndNothingIsLost) {
    const auto& [description, has_point_light] = GetParam();
    const Light light = has_point_light ? Light::point({0.1f, 1.5f, 0.2f}) : Light::directional({0.2f, -1, 0.1f});
    const bool is_for_anything = description.name == "frustum-traced";
    const Device device;
    gnomon::cl::Session& session = session_of(device);
    auto technique = made(description, device, Lists::roomy);
    const Bits wanted = frame(device, *technique, light, is_for_anything);
    const std::uint64_t kept = device.memory_bytes();

    std::size_t calls = 0;
    session.inject_faults([&](std::string_view) { return ++calls, CL_SUCCESS; });
    const Bits again = frame(device, *technique, light, is_for_anything);
    ASSERT_EQ(again, wanted);
    ASSERT_GT(calls, 20u);

    for (std::size_t failing = 1; failing <= calls; ++failing) {
        const cl_int code = failing % 2 == 0 ? CL_MEM_OBJECT_ALLOCATION_FAILURE : CL_DEVICE_NOT_AVAILABLE;
        SCOPED_TRACE("call " + std::to_string(failing) + " of " + std::to_string(calls));
        std::size_t call = 0;
        std::string failed;
        session.inject_faults([&](std::string_view what) {
            if (++call != failing) return CL_SUCCESS;
            failed = what;
            return code;
        });
        try {
            frame(device, *technique, light, is_for_anything);
            ADD_FAILURE() << "nothing was thrown where this failed: " << failed;
        } catch (const gnomon::OpenClError& error) {
            expect_documented(error, code, failed);
        }
        session.inject_faults(nullptr);
        const Bits after = frame(device, *technique, light, is_for_anything);
        ASSERT_EQ(after, wanted) << "after a failure of: " << failed;
        ASSERT_EQ(after.run_bytes, again.run_bytes) << "after a failure of: " << failed;
        ASSERT_EQ(after.samples_bytes, again.samples_bytes) << "after a failure of: " << failed;
        ASSERT_EQ(device.memory_bytes(), kept) << "after a failure of: " << failed;
    }
    technique.reset();
    EXPECT_EQ(device.memory_bytes(), 0u);
}

INSTANTIATE_TEST_SUITE_P(Technique, EveryCall, testing::ValuesIn(all_cases()), case_name);

// Steps that happen once per device (programs read and compiled, kernels made) and steps of growing lists.
TEST(FirstRun, EachKindOfCallFailsTheFirstTime) {
    for (const gnomon::TechniqueDescription& description : all_techniques()) {
        const Light light = Light::directional({0.2f, -1, 0.1f});
        const Device sound;
        const Bits wanted = frame(sound, *made(description, sound, Lists::tight), light, false);
        // This device must not load the compiled kernels that the device above stored: it must compile them itself.
        const support::Environment no_cache("GNOMON_CACHE_DIR", "/dev/null/no_folder");
        const Device device;
        auto technique = made(description, device, Lists::tight);
        std::set<std::string> met;
        std::string failed;
        session_of(device).inject_faults([&](std::string_view what) {
            if (!met.insert(std::string(what)).second) return CL_SUCCESS;
            failed = what;
            return CL_DEVICE_NOT_AVAILABLE;
        });
        Bits bits;
        for (bool has_failed = true; has_failed;) {
            has_failed = false;
            try {
                bits = frame(device, *technique, light, false);
            } catch (const gnomon::OpenClError& error) {
                has_failed = true;
                expect_documented(error, CL_DEVICE_NOT_AVAILABLE, failed);
            }
        }
        EXPECT_EQ(bits, wanted) << description.name;
        session_of(device).inject_faults(nullptr);
        // A run without growing lists uses the technique's buffers, and reports their bytes.
        const std::uint64_t run_bytes = frame(device, *technique, light, false).run_bytes;
        EXPECT_EQ(run_bytes, device.memory_bytes()) << description.name;
        for (const std::string call : {"reading kernels/", "compiling kernels/"})  // a CPU's are one program
            EXPECT_TRUE(met.contains(call + "camera/camera.cl") || met.contains(call + "{occluders,camera,trace}/*.cl"))
                << call;
        technique.reset();
        EXPECT_EQ(device.memory_bytes(), 0u) << description.name;
    }
}

}  // namespace
