// SPDX-License-Identifier: MIT
// The check of a device's arithmetic at start-up: finds nothing on a sound device, and finds every fault that is put in
// its way, by build options that replace an operation on trial (kernels/exact/self_check.cl).
#include <gtest/gtest.h>

#include <filesystem>
#include <fstream>
#include <iterator>
#include <stdexcept>
#include <string>

#include "exact/self_check.hpp"
#include "query/inputs.hpp"
#include "support/environment.hpp"
#include "support/temporary_folder.hpp"

namespace {

using gnomon::Device;

struct Change {
    std::string operation, faulty;
};

struct Fault {
    const char* name;
    Change change;
    const char* clause;
};

/// While it lives, sessions read the kernels from a folder in which an operation of the self-check is faulty.
class FaultyKernels {
public:
    explicit FaultyKernels(const Change& change) {
        std::filesystem::copy(GNOMON_KERNELS, folder_.path(), std::filesystem::copy_options::recursive);
        replace(change);
    }
    void replace(const Change& change) const {
        const std::filesystem::path file = folder_.path() / "exact/self_check.cl";
        std::ifstream stream(file);
        std::string text{std::istreambuf_iterator<char>(stream), {}};
        const std::size_t at = text.find(change.operation);
        if (at == std::string::npos || text.find(change.operation, at + 1) != std::string::npos)
            throw std::runtime_error("self_check.cl must have once: " + change.operation);
        std::ofstream(file) << text.replace(at, change.operation.size(), change.faulty);
    }

private:
    support::TemporaryFolder folder_;
    support::Environment in_use_{"GNOMON_KERNELS_DIR", folder_.path().string()};
};

void PrintTo(const Fault& fault, std::ostream* out) { *out << fault.name; }

std::string name_of(const testing::TestParamInfo<Fault>& info) { return info.param.name; }

TEST(SelfCheck, FindsNothingWrongWithASoundDevice) {
    for (const std::uint32_t work_group_size : {0u, 1u, 3u, 64u}) {
        Device device({}, {.work_group_size = work_group_size});
        const gnomon::ArithmeticFaults faults = gnomon::check_arithmetic(session_of(device));
        EXPECT_EQ(faults.everywhere, std::vector<std::string>{});
        EXPECT_EQ(faults.in_double, std::vector<std::string>{});
        EXPECT_EQ(faults.in_vectors, std::vector<std::string>{});
        // PoCL 3.0 on AMD's Zen 4 is sound but for its vectors (docs/drivers.md).
        EXPECT_EQ(device.description().note.find("double precision"), std::string::npos);
        EXPECT_EQ(session_of(device).has_fp64(), device.description().has_fp64);
    }
}

TEST(SelfCheck, LeavesNoMemoryBehind) {
    Device device;
    EXPECT_EQ(device.memory_bytes(), 0u);
    EXPECT_EQ(device.peak_memory_bytes(), 0u);
}

class Refused : public testing::TestWithParam<Fault> {};

INSTANTIATE_TEST_SUITE_P(
    SelfCheck, Refused,
    testing::Values(
        Fault{"fused", {"as_uint(a * a + minus_square)", "as_uint(fma(a, a, minus_square))"}, "rounds a * b + c once"},
        Fault{"reordered",
              {"as_uint((one - (sum - (sum - one))) + (b - (sum - one)))", "as_uint(one - one + 0.0f * b * sum)"},
              "reorders sums of floats"},
        Fault{"towards_zero",
              {"as_uint(one + half_ulp)", "as_uint(nextafter(one + half_ulp, 0.0f))"},
              "does not round floats to nearest"},
        Fault{"ties_away",
              {"as_uint(one + half_ulp)", "as_uint(one + 2.0f * half_ulp)"},
              "does not round floats to nearest"},
        Fault{"fma_is_not_fused", {"fma(a, a, minus_square)", "(a * a + minus_square)"}, "rounds fma() twice"},
        Fault{"fma_without_the_last_bits", {"fma(a, a, little)", "fma(a, a, 0.0f)"}, "rounds fma() twice"},
        Fault{"flushed_copies",
              {"kept[3] = v.x;", "kept[3] = fabs(v.x) < FLT_MIN ? 0.0f : v.x;"},
              "changes denormal floats"},
        Fault{"short_products", {"mul_hi(ones, ones)", "(mul_hi(ones, ones) & 0xFFul)"}, "64-bit integers"},
        Fault{"signed_minimum", {"&result->min_key, key", "&result->min_key, key ^ 0x80000000u"}, "atomic_min"},
        Fault{"lost_sign",
              {"sign_of_minor(0.0f, tiny, tiny, large, origin)", "abs(sign_of_minor(0.0f, tiny, tiny, large, origin))"},
              "exact predicate"},
        Fault{"lost_carry",
              {"sign_of_minor(large, tiny, large, tiny, origin)",
               "(sign_of_minor(large, tiny, large, tiny, origin) | 1)"},
              "exact predicate"},
        Fault{"one_item_of_many",
              {"int sign = det3_sign(", "int sign = get_local_id(0) == 1 ? 1 : det3_sign("},
              "mixes up work-items"}),
    name_of);

TEST_P(Refused, WithASentenceThatNamesTheFault) {
    const FaultyKernels kernels(GetParam().change);
    try {
        Device device;
        FAIL() << "was not noticed";
    } catch (const gnomon::DeviceNotFound& error) {
        EXPECT_NE(std::string(error.what()).find(GetParam().clause), std::string::npos) << error.what();
        EXPECT_NE(std::string(error.what()).find("choose another device"), std::string::npos) << error.what();
    }
}

class WithoutDouble : public testing::TestWithParam<Fault> {};

INSTANTIATE_TEST_SUITE_P(
    SelfCheck, WithoutDouble,
    testing::Values(Fault{"fused",
                          {"as_ulong(a * a + minus_square)", "as_ulong(fma(a, a, minus_square))"},
                          "rounds a * b + c of doubles once"},
                    Fault{"reordered",
                          {"as_ulong((one - (sum - (sum - one))) + (b - (sum - one)))", "as_ulong(0.0)"},
                          "reorders sums of doubles"},
                    Fault{"sqrt_of_floats", {"sqrt(three)", "(double)sqrt((float)three)"}, "does not round doubles"},
                    Fault{"flushed_when_widened",
                          {"(double)kept[0]", "(double)(kept[0] < FLT_MIN ? 0.0f : kept[0])"},
                          "loses denormal floats"},
                    Fault{"flushed_when_narrowed",
                          {"convert_float_rte(tie)", "fabs(tie) < FLT_MIN ? 0.0f : convert_float_rte(tie)"},
                          "rounds doubles to wrong denormal floats"},
                    Fault{"narrowed_towards_zero",
                          {"convert_float_rte(above_half)", "convert_float_rtz(above_half)"},
                          "rounds doubles to wrong denormal floats"},
                    Fault{"narrowed_ties_away",
                          {"convert_float_rte(tie)", "convert_float_rte(tie * (1.0 + 0x1p-50))"},
                          "rounds doubles to wrong denormal floats"}),
    name_of);

TEST_P(WithoutDouble, TheDeviceIsUsedAndSaysSo) {
    if (!session_of(Device()).has_fp64()) GTEST_SKIP() << "the device has no double precision";
    const FaultyKernels kernels(GetParam().change);
    Device device;
    EXPECT_FALSE(session_of(device).has_fp64());
    EXPECT_NE(device.description().note.find("double precision is not used"), std::string::npos);
    EXPECT_NE(device.description().note.find(GetParam().clause), std::string::npos) << device.description().note;
    // The caller's own context and queue: the same.
    const Device same(device.context(), device.queue());
    EXPECT_EQ(same.description().note, device.description().note);
}

const Change without_double{"as_ulong((one - (sum - (sum - one))) + (b - (sum - one)))", "as_ulong(0.0)"};

// What PoCL 3.0 says of an AMD CPU with AVX-512: it would end the program where it compiles the kernels for CPUs.
TEST(SelfCheck, ADriverThatCannotCallItsVectorFunctionsGetsTheKernelsForGpus) {
    if (!session_of(Device()).is_cpu() || session_of(Device()).native_floats() < 16)
        GTEST_SKIP() << "the device states no registers of 16 floats";
    const FaultyKernels kernels(without_double);
    kernels.replace({"HAS_WIDE_REGISTERS 1", "HAS_WIDE_REGISTERS 0"});
    Device device;
    EXPECT_FALSE(session_of(device).is_cpu());
    EXPECT_NE(device.description().note.find("the slower kernels for GPUs are used"), std::string::npos);
    EXPECT_NE(device.description().note.find("double precision is not used"), std::string::npos);
}

TEST(SelfCheck, ShadowsAreTheSameWithoutDouble) {
    const FaultyKernels kernels(without_double);
    Device device;
    const std::vector<float> triangle{0, 1, 0, 1, 1, 0, 0, 1, 1}, points{0.25f, 0, 0.25f, 0.5f, 0, 0.5f, 1, 0, 1};
    gnomon::Visibility visibility(device, 3);
    gnomon::make_technique("frustum-traced", device)
        ->run(gnomon::Triangles::upload(device, triangle), gnomon::Points::upload(device, points),
              gnomon::Light::directional({0, -1, 0}), visibility);
    EXPECT_EQ(visibility.read(), (std::vector<float>{0, 0, 1}));
}

}  // namespace
