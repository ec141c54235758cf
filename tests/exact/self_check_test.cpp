// SPDX-License-Identifier: MIT
// The check of a device's arithmetic at start-up: finds nothing on a sound device, and finds every fault that is put in
// its way, by build options that replace an operation on trial (kernels/exact/self_check.cl).
#include <gtest/gtest.h>

#include <cstdlib>
#include <string>

#include "exact/self_check.hpp"
#include "query/inputs.hpp"
#include "support/environment.hpp"

namespace {

using gnomon::Device;

struct Fault {
    const char* name;
    const char* option;
    const char* clause;
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
        Fault{"fused", "-DTRIED_PRODUCT_PLUS(a,b,c)=fma(a,b,c)", "rounds a * b + c once"},
        Fault{"reordered", "-DTRIED_RESIDUAL(a,b,s)=((a)-(a)+0.0f*(b)*(s))", "reorders sums of floats"},
        Fault{"towards_zero", "-DTRIED_ADD(a,b)=nextafter((a)+(b),0.0f)", "does not round floats to nearest"},
        Fault{"ties_away", "-DTRIED_ADD(a,b)=((a)+2.0f*(b))", "does not round floats to nearest"},
        Fault{"fma_is_not_fused", "-DTRIED_FMA(a,b,c)=((a)*(b)+(c))", "rounds fma() twice"},
        Fault{"fma_without_the_last_bits", "-DTRIED_FMA(a,b,c)=fma(a,b,fabs(c)<1e-10f?0.0f:(c))", "rounds fma() twice"},
        Fault{"flushed_copies", "-DTRIED_COPY(x)=(fabs(x)<FLT_MIN?0.0f:(x))", "changes denormal floats"},
        Fault{"short_products", "-DTRIED_MUL_HI(a,b)=(mul_hi(a,b)&0xFFul)", "64-bit integers"},
        Fault{"signed_minimum", "-DTRIED_MIN(p,x)=atomic_min(p,(x)^0x80000000u)", "atomic_min"},
        Fault{"lost_sign", "-DTRIED_SIGN(a,b,c,d,e,f)=abs(det3_sign_exact(a,b,c,d,e,f))", "exact predicate"},
        Fault{"lost_carry", "-DTRIED_SIGN(a,b,c,d,e,f)=(det3_sign_exact(a,b,c,d,e,f)|1)", "exact predicate"},
        Fault{"one_item_of_many", "-DTRIED_DECISION(a,b,c,d,e,f,l)=(get_local_id(0)==1?1:det3_sign(a,b,c,d,e,f,l))",
              "mixes up work-items"}),
    name_of);

TEST_P(Refused, WithASentenceThatNamesTheFault) {
    const support::Environment options("GNOMON_BUILD_OPTIONS", GetParam().option);
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
    testing::Values(Fault{"fused", "-DTRIED_DOUBLE_PRODUCT_PLUS(a,b,c)=fma(a,b,c)", "rounds a * b + c of doubles once"},
                    Fault{"reordered", "-DTRIED_DOUBLE_RESIDUAL(a,b,s)=0.0", "reorders sums of doubles"},
                    Fault{"sqrt_of_floats", "-DTRIED_SQRT(x)=((double)sqrt((float)(x)))", "does not round doubles"},
                    Fault{"flushed_when_widened", "-DTRIED_WIDEN(x)=((double)((x)<FLT_MIN?0.0f:(x)))",
                          "loses denormal floats"},
                    Fault{"flushed_when_narrowed", "-DTRIED_NARROW(x)=(fabs(x)<FLT_MIN?0.0f:convert_float_rte(x))",
                          "rounds doubles to wrong denormal floats"},
                    Fault{"narrowed_towards_zero", "-DTRIED_NARROW(x)=convert_float_rtz(x)",
                          "rounds doubles to wrong denormal floats"},
                    Fault{"narrowed_ties_away", "-DTRIED_NARROW(x)=convert_float_rte((x)*(1.0+0x1p-50))",
                          "rounds doubles to wrong denormal floats"}),
    name_of);

TEST_P(WithoutDouble, TheDeviceIsUsedAndSaysSo) {
    if (!session_of(Device()).has_fp64()) GTEST_SKIP() << "the device has no double precision";
    const support::Environment options("GNOMON_BUILD_OPTIONS", GetParam().option);
    Device device;
    EXPECT_FALSE(session_of(device).has_fp64());
    EXPECT_NE(device.description().note.find("double precision is not used"), std::string::npos);
    EXPECT_NE(device.description().note.find(GetParam().clause), std::string::npos) << device.description().note;
    // The caller's own context and queue: the same.
    const Device same(device.context(), device.queue());
    EXPECT_EQ(same.description().note, device.description().note);
}

// What PoCL 3.0 says of an AMD CPU with AVX-512: it would end the program where it compiles the kernels for CPUs.
TEST(SelfCheck, ADriverThatCannotCallItsVectorFunctionsGetsTheKernelsForGpus) {
    if (!session_of(Device()).is_cpu() || session_of(Device()).native_floats() < 16)
        GTEST_SKIP() << "the device states no registers of 16 floats";
    const support::Environment options("GNOMON_BUILD_OPTIONS",
                                       "-DTRIED_WIDE_REGISTERS=0 -DTRIED_DOUBLE_RESIDUAL(a,b,s)=0.0");
    Device device;
    EXPECT_FALSE(session_of(device).is_cpu());
    EXPECT_NE(device.description().note.find("the slower kernels for GPUs are used"), std::string::npos);
    EXPECT_NE(device.description().note.find("double precision is not used"), std::string::npos);
}

TEST(SelfCheck, ShadowsAreTheSameWithoutDouble) {
    const support::Environment options("GNOMON_BUILD_OPTIONS", "-DTRIED_DOUBLE_RESIDUAL(a,b,s)=0.0");
    Device device;
    const std::vector<float> triangle{0, 1, 0, 1, 1, 0, 0, 1, 1}, points{0.25f, 0, 0.25f, 0.5f, 0, 0.5f, 1, 0, 1};
    gnomon::Visibility visibility(device, 3);
    gnomon::make_technique("frustum-traced", device)
        ->run(gnomon::Triangles::upload(device, triangle), gnomon::Points::upload(device, points),
              gnomon::Light::directional({0, -1, 0}), visibility);
    EXPECT_EQ(visibility.read(), (std::vector<float>{0, 0, 1}));
}

}  // namespace
