// SPDX-License-Identifier: MIT
#include "energy_sums.hpp"

#include <algorithm>

namespace gnomon::python {
namespace {

constexpr std::size_t suns_of_word = 32;
// As many receivers' normals and sums fit into the first cache.
constexpr std::size_t receivers_at_once = 512;

// The whole number nearest to a value from 0 to below 2^51: the sum has no room for a fraction.
double rounded(double value) {
    constexpr double no_fraction = 0x1p52;
    return (value + no_fraction) - no_fraction;
}

struct Receivers {
    const double *x, *y, *z;  // of their normals
    std::size_t count;
};

// Adds a sun to the sums of the receivers whose words have its bit. The sums of a word's suns stay below 2^51.
void add_sun(const Receivers& at, const std::uint32_t* words, std::uint32_t bit, const WeighedSun& sun, double* sums) {
    const auto [x, y, z] = sun.towards;
    for (std::size_t i = 0; i < at.count; ++i) {
        const double cosine = at.x[i] * x + at.y[i] * y + at.z[i] * z;
        const double counts = double(std::int32_t(words[i] >> bit & 1u));
        sums[i] += rounded(std::max(cosine, 0.0) * sun.weight) * counts;
    }
}

void add_whole(const std::uint32_t* words, std::size_t count, std::uint32_t bit, double weight, double* sums) {
    for (std::size_t i = 0; i < count; ++i) sums[i] += rounded(weight) * double(std::int32_t(words[i] >> bit & 1u));
}

}  // namespace

std::vector<std::int64_t> energy_sums(std::span<const std::uint32_t> planes, std::span<const double> normals,
                                      std::size_t receivers, std::span<const WeighedSun> suns) {
    std::vector<std::int64_t> energies(receivers);
    std::array<double, receivers_at_once> sums;
    for (std::size_t first = 0; first < receivers; first += receivers_at_once) {
        const std::size_t count = std::min(receivers_at_once, receivers - first);
        const double* const x = normals.data() + first;
        const Receivers at{x, x + receivers, x + 2 * receivers, count};
        for (std::size_t sun = 0; sun < suns.size(); ++sun) {
            const auto bit = std::uint32_t(sun % suns_of_word);
            const std::uint32_t* const words = planes.data() + sun / suns_of_word * receivers + first;
            if (bit == 0) sums.fill(0);
            if (normals.empty())
                add_whole(words, count, bit, suns[sun].weight, sums.data());
            else
                add_sun(at, words, bit, suns[sun], sums.data());
            if (bit + 1 == suns_of_word || sun + 1 == suns.size())
                for (std::size_t i = 0; i < count; ++i) energies[first + i] += std::int64_t(sums[i]);
        }
    }
    return energies;
}

}  // namespace gnomon::python
