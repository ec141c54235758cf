// SPDX-License-Identifier: MIT
// The exact predicates on the device, level by level, against exact arithmetic on the host.
//
// Each level alone must be right wherever it claims to be certain (the exact level: always), and so must the cascade
// and blocks(), with double precision and without. The filters' bounds must neither fail nor be idle: every class of
// inputs says how many cases each level left undecided, and a search that breeds bad cases looks for the largest error.
//
//   GNOMON_PREDICATE_TRIALS  cases per class (default 200000; millions for a long run, batch by batch)
//   GNOMON_PREDICATE_SEED    another seed, other cases (default 1)
#include <gtest/gtest.h>

#include <algorithm>
#include <atomic>
#include <cmath>
#include <cstdlib>
#include <fstream>
#include <functional>
#include <iostream>
#include <mutex>
#include <numeric>
#include <sstream>

#include "exact/predicates/cases.hpp"
#include "exact/predicates/truth.hpp"
#include "query/inputs.hpp"
#include "reference/parallel.hpp"

namespace {

using namespace predicates;

constexpr const char* KERNELS = "predicates_test.cl";
constexpr int UNDECIDED = 2, LEVEL_ABSENT = 3;  // as in predicates.cl
enum Output { by_float, by_double, by_exact, by_cascade, level_of_cascade, OUTPUTS };

std::uint64_t from_environment(const char* name, std::uint64_t otherwise) {
    const char* value = std::getenv(name);
    return value != nullptr ? std::strtoull(value, nullptr, 10) : otherwise;
}

std::uint64_t trials() { return from_environment("GNOMON_PREDICATE_TRIALS", 200000); }
std::uint64_t seed() { return from_environment("GNOMON_PREDICATE_SEED", 1); }

/// A device with the test's kernels.
class Bench {
public:
    explicit Bench(bool hide_fp64 = false) : device_({}, {.hide_fp64 = hide_fp64}) {
        std::ifstream stream(GNOMON_TESTS "/exact/predicates/predicates.cl");
        std::ostringstream text;
        text << stream.rdbuf();
        if (!stream) throw std::runtime_error("cannot read " GNOMON_TESTS "/exact/predicates/predicates.cl");
        session().add_source(KERNELS, text.str());
    }

    gnomon::cl::Session& session() { return session_of(device_); }

    template <typename Value>
    gnomon::cl::Buffer upload(const std::vector<Value>& values) {
        gnomon::cl::Buffer buffer(session(), values.size() * sizeof(Value));
        session().write(buffer.get(), values.data(), values.size() * sizeof(Value));
        return buffer;
    }
    template <typename Value>
    std::vector<Value> read(const gnomon::cl::Buffer& buffer, std::size_t count) {
        std::vector<Value> values(count);
        session().read(buffer.get(), values.data(), count * sizeof(Value));
        return values;
    }

    /// OUTPUTS bytes per case.
    std::vector<signed char> signs(const std::vector<Det3Case>& cases) {
        const gnomon::cl::Buffer in = upload(cases), out(session(), cases.size() * OUTPUTS);
        const auto count = static_cast<cl_uint>(cases.size());
        session().launch(KERNELS, "signs_of_det3", gnomon::cl::Range::items(count), count, in, out);
        return read<signed char>(out, cases.size() * OUTPUTS);
    }
    /// Blocked and level per case.
    std::vector<signed char> blocks(const std::vector<BlocksCase>& cases) {
        const gnomon::cl::Buffer in = upload(cases), out(session(), cases.size() * 2);
        const auto count = static_cast<cl_uint>(cases.size());
        session().launch(KERNELS, "answers_of_blocks", gnomon::cl::Range::items(count), count, in, out);
        return read<signed char>(out, cases.size() * 2);
    }

private:
    gnomon::Device device_;
};

template <std::size_t N>
std::string shown(const std::array<float, N>& numbers) {
    std::ostringstream text;
    text << std::hexfloat;
    for (const float x : numbers) text << ' ' << x;
    return text.str();
}

/// Faults of one class, from all threads; the first few are told.
class Faults {
public:
    void add(const std::string& what) {
        const std::lock_guard lock(mutex_);
        if (++count_ <= 5) text_ += what + '\n';
    }
    void judge() const { EXPECT_EQ(count_, 0u) << text_; }

private:
    std::mutex mutex_;
    std::uint64_t count_ = 0;
    std::string text_;
};

/// Calls body with the numbers of the first and last case, for batches that cover all trials.
void for_batches(const std::function<void(std::uint64_t, std::size_t)>& body) {
    constexpr std::uint64_t batch = 1 << 17;
    for (std::uint64_t first = 0; first < trials(); first += batch)
        body(first, static_cast<std::size_t>(std::min(batch, trials() - first)));
}

class Predicates : public testing::TestWithParam<Class> {};

std::string test_name(const testing::TestParamInfo<Class>& info) {
    std::string name = name_of(info.param);
    std::replace_if(
        name.begin(), name.end(), [](char c) { return c == ' ' || c == '-'; }, '_');
    return name;
}

INSTANTIATE_TEST_SUITE_P(Inputs, Predicates,
                         testing::Values(Class::ordinary, Class::near_degenerate, Class::degenerate, Class::extreme),
                         test_name);

TEST_P(Predicates, DeterminantHasTheRightSignAtEveryLevel) {
    Bench full, without_double(true);
    const bool has_double = full.session().has_fp64();
    Faults faults;
    std::array<std::atomic<std::uint64_t>, 3> of_sign{};  // -1, 0, 1
    std::atomic<std::uint64_t> open_in_float = 0, open_in_double = 0, open_and_not_zero = 0, zero_in_double = 0;
    for_batches([&](std::uint64_t first, std::size_t count) {
        std::vector<Det3Case> cases(count);
        reference::for_chunks(count, 4096, [&](std::size_t begin, std::size_t end) {
            for (std::size_t i = begin; i < end; ++i) cases[i] = det3_case(GetParam(), seed(), first + i);
        });
        const auto with = full.signs(cases), without = without_double.signs(cases);
        reference::for_chunks(count, 1024, [&](std::size_t begin, std::size_t end) {
            for (std::size_t i = begin; i < end; ++i) {
                const signed char *a = &with[OUTPUTS * i], *b = &without[OUTPUTS * i];
                const int truth = sign_of_det3(cases[i]);
                const auto demand = [&](bool holds, const char* what) {
                    if (!holds)
                        faults.add(std::string(what) + ", case " + std::to_string(first + i) + ", sign " +
                                   std::to_string(truth) + ":" + shown(cases[i]));
                };
                demand(a[by_float] == truth || a[by_float] == UNDECIDED, "float filter");
                demand(b[by_float] == a[by_float], "float filter, double precision hidden");
                if (has_double) demand(a[by_double] == truth || a[by_double] == UNDECIDED, "double filter");
                demand(b[by_double] == LEVEL_ABSENT, "double filter, hidden");
                demand(a[by_exact] == truth, "exact level");
                demand(b[by_exact] == truth, "exact level, double precision hidden");
                demand(a[by_cascade] == truth, "cascade");
                demand(b[by_cascade] == truth, "cascade, double precision hidden");
                const bool in_float = a[by_float] != UNDECIDED;
                const bool in_double = has_double && a[by_double] != UNDECIDED;
                demand(a[level_of_cascade] == (in_float ? 0 : in_double ? 1 : 2), "level of the cascade");
                demand(b[level_of_cascade] == (in_float ? 0 : 2), "level of the cascade, double precision hidden");
                ++of_sign[static_cast<std::size_t>(truth + 1)];
                open_in_float += !in_float;
                open_in_double += !in_double;
                open_and_not_zero += !in_float && !in_double && truth != 0;
                zero_in_double += has_double && a[by_double] == 0;
                // The fast truth has a truth of its own.
                if ((first + i) % 257 == 0)
                    demand(det3_in_rationals(cases[i]).sign() == truth, "the test's own truth against rationals");
            }
        });
    });
    faults.judge();
    std::cout << name_of(GetParam()) << ": " << trials() << " determinants (" << of_sign[0] << " negative, "
              << of_sign[1] << " zero, " << of_sign[2] << " positive); left open by float " << open_in_float
              << ", by double " << open_in_double << ", by both though not zero " << open_and_not_zero << '\n';
    // A filter that never says "undecided" was not tried, and one that always does is of no use.
    if (GetParam() == Class::ordinary) {
        EXPECT_LE(open_in_float, trials() / 1000);
        EXPECT_TRUE(!has_double || open_in_double <= trials() / 10000);
    } else {
        EXPECT_GT(open_in_float, 0u);
        EXPECT_TRUE(!has_double || open_in_double > 0);
        // On a lattice what double leaves open is zero; elsewhere it must have been tried with more than zeros.
        EXPECT_TRUE(!has_double || open_and_not_zero > 0 || GetParam() == Class::degenerate);
    }
    // Axis-aligned ties need no integers.
    EXPECT_TRUE(!has_double || zero_in_double > 0 || GetParam() != Class::degenerate);
    EXPECT_GT(of_sign[0], 0u);
    EXPECT_GT(of_sign[2], 0u);
}

TEST_P(Predicates, BlocksSaysWhatTheContractSays) {
    Bench full, without_double(true);
    Faults faults;
    std::array<std::atomic<std::uint64_t>, 3> of_level{};
    std::atomic<std::uint64_t> blocked = 0;
    for_batches([&](std::uint64_t first, std::size_t count) {
        std::vector<BlocksCase> cases(count);
        reference::for_chunks(count, 4096, [&](std::size_t begin, std::size_t end) {
            for (std::size_t i = begin; i < end; ++i) cases[i] = blocks_case(GetParam(), seed(), first + i);
        });
        const auto with = full.blocks(cases), without = without_double.blocks(cases);
        reference::for_chunks(count, 1024, [&](std::size_t begin, std::size_t end) {
            for (std::size_t i = begin; i < end; ++i) {
                const bool truth = is_blocked(cases[i]);
                if (with[2 * i] != truth)
                    faults.add("case " + std::to_string(first + i) + (truth ? " blocks:" : " does not block:") +
                               shown(cases[i]));
                if (without[2 * i] != truth)
                    faults.add("double precision hidden, case " + std::to_string(first + i) +
                               (truth ? " blocks:" : " does not block:") + shown(cases[i]));
                blocked += truth;
                ++of_level[static_cast<std::size_t>(with[2 * i + 1])];
            }
        });
    });
    faults.judge();
    std::cout << name_of(GetParam()) << ": " << trials() << " triangles against points, " << blocked
              << " block; decided by float " << of_level[0] << ", double " << of_level[1] << ", integers "
              << of_level[2] << '\n';
    EXPECT_GT(blocked, 0u);
    EXPECT_LT(blocked, trials());
}

// ---- The filters' bounds --------------------------------------------------------------------------------------------

/// |value - determinant| / bound; 0 where the filter is not used.
double ratio_of(double value, double bound, const Rational& truth) {
    if (!(bound > 0) || !std::isfinite(bound) || !std::isfinite(value)) return 0;
    const Rational ratio = abs(Rational(value) - truth) / Rational(bound);
    return ratio.convert_to<double>();
}

/// Differences for the float filter are made by rounding; those for the double filter need more than 24 bits, so two
/// floats of unlike size.
Det3Case random_parent(Random& random, bool is_for_double) {
    Det3Case numbers;
    for (std::size_t i = 0; i < numbers.size(); ++i)
        numbers[i] = static_cast<float>(random.unit() * (is_for_double && i / 3 % 2 == 1 ? 0x1p-24 : 1.0));
    return numbers;
}

Det3Case mutant(Random& random, const Det3Case& parent, bool is_for_double) {
    Det3Case child = parent;
    const Det3Case other = random_parent(random, is_for_double);
    for (int changes = 1 + random.below(3); changes > 0; --changes) {
        const auto i = static_cast<std::size_t>(random.below(18));
        const float moved = child[i] * static_cast<float>(1 + random.unit() * std::ldexp(1.0, -random.below(24)));
        child[i] = random.once_in(6) ? other[i] : moved;
    }
    return child;
}

double largest_ratio(Bench& bench, bool is_for_double) {
    constexpr std::size_t population = 4096, parents = 64;
    constexpr int generations = 60;
    Random random(seed());
    std::vector<Det3Case> cases(population);
    for (Det3Case& numbers : cases) numbers = random_parent(random, is_for_double);
    double best = 0;
    for (int generation = 0; generation < generations; ++generation) {
        const gnomon::cl::Buffer in = bench.upload(cases);
        const gnomon::cl::Buffer floats(bench.session(), population * 2 * sizeof(float));
        const gnomon::cl::Buffer doubles(bench.session(), population * 2 * sizeof(double));
        bench.session().launch(KERNELS, "values_of_det3", gnomon::cl::Range::items(population), cl_uint{population}, in,
                               floats, doubles);
        const auto in_float = bench.read<float>(floats, 2 * population);
        const auto in_double = bench.read<double>(doubles, 2 * population);
        std::vector<double> ratio(population);
        reference::for_chunks(population, 64, [&](std::size_t begin, std::size_t end) {
            for (std::size_t i = begin; i < end; ++i) {
                const Rational truth = det3_in_rationals(cases[i]);
                ratio[i] = is_for_double ? ratio_of(in_double[2 * i], in_double[2 * i + 1], truth)
                                         : ratio_of(in_float[2 * i], in_float[2 * i + 1], truth);
            }
        });
        std::vector<std::size_t> order(population);
        std::iota(order.begin(), order.end(), std::size_t{0});
        std::partial_sort(order.begin(), order.begin() + parents, order.end(),
                          [&](std::size_t a, std::size_t b) { return ratio[a] > ratio[b]; });
        best = std::max(best, ratio[order[0]]);
        std::vector<Det3Case> next;
        for (std::size_t i = 0; i < parents; ++i) next.push_back(cases[order[i]]);
        while (next.size() < population)
            next.push_back(mutant(random, next[static_cast<std::size_t>(random.below(parents))], is_for_double));
        cases = std::move(next);
    }
    return best;
}

TEST(PredicateBounds, NoBredCaseExceedsTheFloatBound) {
    Bench bench;
    if (!bench.session().has_fp64()) GTEST_SKIP() << "the kernel of this test needs double precision";
    const double ratio = largest_ratio(bench, false);
    std::cout << "float filter: largest |error| / bound found: " << ratio << '\n';
    EXPECT_LE(ratio, 1);
    EXPECT_GT(ratio, 0.25) << "the search did not search, or the bound is far too wide";
}

TEST(PredicateBounds, NoBredCaseExceedsTheDoubleBound) {
    Bench bench;
    if (!bench.session().has_fp64()) GTEST_SKIP() << "the device has no double precision";
    const double ratio = largest_ratio(bench, true);
    std::cout << "double filter: largest |error| / bound found: " << ratio << '\n';
    EXPECT_LE(ratio, 1);
    EXPECT_GT(ratio, 0.25) << "the search did not search, or the bound is far too wide";
}

// ---- The accumulator ------------------------------------------------------------------------------------------------

using Integer = boost::multiprecision::cpp_int;

struct Product {
    float x, y, z, negate;
};
using Sum = std::vector<Product>;

/// Times 2^447.
Integer exact_product(const Product& product) {
    Integer result = product.negate != 0 ? -1 : 1;
    for (const float factor : {product.x, product.y, product.z})
        result *= static_cast<Integer>(Rational(factor) * Rational(Integer(1) << 149));
    return result;
}

Integer integer_of(const std::uint32_t* words) {
    Integer result = 0;
    for (int i = 27; i >= 0; --i) result = (result << 32) + words[i];
    if (words[27] >> 31 != 0) result -= Integer(1) << 896;
    return result;
}

float random_factor(Random& random) {
    const float x = static_cast<float>(std::ldexp(random.unit(), random.below(277) - 148));
    return random.once_in(20) ? std::copysign(random.once_in(2) ? FLT_MAX : 0x1p-149f, x) : x;
}

Sum random_sum(Random& random) {
    Sum sum;
    for (int i = random.below(60); i >= 0; --i)
        sum.push_back(
            {random_factor(random), random_factor(random), random_factor(random), random.once_in(2) ? 1.0f : 0.0f});
    return sum;
}

/// All of it and its negative, in another order: zero. Half of them with one more product, the smallest of all.
Sum cancelling_sum(Random& random) {
    Sum sum = random_sum(random);
    const std::size_t count = sum.size();
    for (std::size_t i = 0; i < count; ++i) sum.push_back({sum[i].y, -sum[i].z, sum[i].x, sum[i].negate});
    std::shuffle(sum.begin(), sum.end(), random);
    if (random.once_in(2)) sum.push_back({0x1p-149f, -0x1p-149f, 0x1p-149f, random.once_in(2) ? 1.0f : 0.0f});
    return sum;
}

/// 2^n - 2^-447 and its like: runs of ones and zeros over many words, and a carry that crosses them.
Sum carrying_sum(Random& random) {
    const float tiny = 0x1p-149f;
    const auto power = [&] {
        return std::array{std::ldexp(1.0f, random.below(277) - 149), std::ldexp(1.0f, random.below(277) - 149)};
    };
    Sum sum;
    const auto [x, y] = power();
    const float negate = random.once_in(2) ? 1.0f : 0.0f;
    sum.push_back({x, y, std::ldexp(1.0f, random.below(277) - 149), negate});
    sum.push_back({tiny, tiny, tiny, 1 - negate});
    if (random.once_in(2)) sum.push_back({tiny, tiny, tiny, negate});
    if (random.once_in(2)) sum.push_back({y, x, sum[0].z, 1 - negate});
    return sum;
}

/// About 2^53 and 2^85 ulps and ties between them: what a conversion to double can get wrong.
Sum hard_to_round(Random& random) {
    Sum sum;
    const int top = random.below(100);
    for (const int below : {0, 21 + random.below(12), 52, 53, 54, 64, 85})
        if (random.once_in(2) || below == 0)
            sum.push_back({std::ldexp(1.0f, top - below), static_cast<float>(1 + random.below(3)), 1.0f, 0.0f});
    sum.push_back({std::ldexp(1.0f, -random.below(149)), 0x1p-149f, 1.0f, random.once_in(2) ? 1.0f : 0.0f});
    return sum;
}

TEST(Accumulator, SumsExactlyAndRoundsWell) {
    Bench bench;
    if (!bench.session().has_fp64()) GTEST_SKIP() << "the kernel of this test needs double precision";
    const auto count = static_cast<std::size_t>(std::clamp<std::uint64_t>(trials() / 10, 100, 1000000));
    Random random(seed());
    std::vector<Sum> sums(count);
    for (std::size_t i = 0; i < count; ++i)
        sums[i] = std::array{random_sum, cancelling_sum, carrying_sum, hard_to_round}[i % 4](random);
    // As many of the largest as there will ever be: 96, and no sum of them overflows.
    sums[0] = Sum(96, {FLT_MAX, FLT_MAX, FLT_MAX, 0.0f});
    sums[1] = Sum(96, {FLT_MAX, FLT_MAX, FLT_MAX, 1.0f});
    std::vector<std::uint32_t> first{0};
    std::vector<Product> products;
    for (const Sum& sum : sums) {
        products.insert(products.end(), sum.begin(), sum.end());
        first.push_back(static_cast<std::uint32_t>(products.size()));
    }
    const gnomon::cl::Buffer first_in = bench.upload(first), products_in = bench.upload(products);
    const gnomon::cl::Buffer words_out(bench.session(), count * 28 * 4), signs_out(bench.session(), count * 4),
        doubles_out(bench.session(), count * 8);
    bench.session().launch(KERNELS, "sums_of_products", gnomon::cl::Range::items(count), static_cast<cl_uint>(count),
                           first_in, products_in, words_out, signs_out, doubles_out);
    const auto words = bench.read<std::uint32_t>(words_out, count * 28);
    const auto signs = bench.read<cl_int>(signs_out, count);
    const auto doubles = bench.read<double>(doubles_out, count);

    Faults faults;
    std::atomic<std::uint64_t> zeros = 0, negatives = 0;
    std::vector<double> error_in_ulps(count);
    reference::for_chunks(count, 256, [&](std::size_t begin, std::size_t end) {
        for (std::size_t i = begin; i < end; ++i) {
            Integer truth = 0;
            for (const Product& product : sums[i]) truth += exact_product(product);
            const auto demand = [&](bool holds, const char* what) {
                if (!holds) faults.add(std::string(what) + " of sum " + std::to_string(i) + ", " + truth.str());
            };
            demand(integer_of(&words[28 * i]) == truth, "words");
            demand(signs[i] == truth.sign(), "sign");
            demand(std::isfinite(doubles[i]), "finite double");
            const Rational exact(truth, Integer(1) << 447);
            if (truth != 0) {
                const Rational error = abs((Rational(doubles[i]) - exact) / exact) * Rational(Integer(1) << 52);
                error_in_ulps[i] = error.convert_to<double>();
                demand(error < 1, "double");
            } else {
                demand(doubles[i] == 0, "double zero");
            }
            zeros += truth == 0;
            negatives += truth < 0;
        }
    });
    faults.judge();
    std::cout << count << " sums of " << products.size() << " products, " << negatives << " negative, " << zeros
              << " zero; largest error of the double " << *std::max_element(error_in_ulps.begin(), error_in_ulps.end())
              << " * 2^-52\n";
    EXPECT_GT(zeros, count / 20);
    EXPECT_GT(negatives, count / 20);
}

}  // namespace
