// SPDX-License-Identifier: MIT
#include "facing_suns.hpp"

#include <array>
#include <cmath>

#include "in_parts.hpp"

namespace gnomon::python {
namespace {

using Vector = std::array<double, 3>;

double dot(const double* a, const double* b) { return a[0] * b[0] + a[1] * b[1] + a[2] * b[2]; }
double largest(const Vector& v) { return std::max({std::abs(v[0]), std::abs(v[1]), std::abs(v[2])}); }

// n . d rounds three times in products and twice in sums: it is wrong by less than 5 x 2^-53 x 3 x the largest
// coordinates of n and d.
constexpr double bound_of_dot = 1.7e-15;

// The chosen suns of a word, with the box around them.
struct Word {
    std::size_t number;
    std::vector<std::uint32_t> suns;
    std::uint32_t bits = 0;
    Vector middle, spread;  // no coordinate of a sun is farther from the middle's
    double rounding;        // of n . middle and |n| . spread, for n with the largest coordinate 1
    double error;           // of n . d
};

Word word_of(std::size_t number, std::vector<std::uint32_t> chosen, std::span<const double> suns) {
    Word word{number, std::move(chosen), 0, {}, {}, 0, 0};
    for (std::size_t c = 0; c < 3; ++c) {
        double low = HUGE_VAL, high = -HUGE_VAL;
        for (const std::uint32_t sun : word.suns)
            low = std::min(low, suns[3 * sun + c]), high = std::max(high, suns[3 * sun + c]);
        word.middle[c] = low / 2 + high / 2;
        word.spread[c] = std::max(high - word.middle[c], word.middle[c] - low) * (1 + 0x1p-50);
        word.error = std::max({word.error, std::abs(low), std::abs(high)});
    }
    for (const std::uint32_t sun : word.suns) word.bits |= 1u << sun % 32;
    word.rounding = bound_of_dot * (largest(word.middle) + largest(word.spread)) * (1 + 0x1p-40);
    word.error *= bound_of_dot * (1 + 0x1p-40);
    return word;
}

std::vector<Word> words_of(std::span<const double> suns, std::span<const bool> chosen) {
    std::vector<Word> words;
    for (std::size_t first = 0; first < chosen.size(); first += 32) {
        std::vector<std::uint32_t> some;
        for (std::size_t sun = first; sun < std::min(first + 32, chosen.size()); ++sun)
            if (chosen[sun]) some.push_back(std::uint32_t(sun));
        if (!some.empty()) words.push_back(word_of(first / 32, std::move(some), suns));
    }
    return words;
}

// The bits of the suns that are not above the triangle; appends those that are not certain.
std::uint32_t bits_below(const Word& word, const double* normal, std::uint32_t vertex, std::span<const double> suns,
                         std::vector<std::uint32_t>& unsure) {
    const Vector size{std::abs(normal[0]), std::abs(normal[1]), std::abs(normal[2])};
    const double middle = dot(normal, word.middle.data()), most = largest(size);
    const double bound = dot(size.data(), word.spread.data()) + word.rounding * most;
    if (middle < -bound) return word.bits;
    if (middle > bound) return 0;
    std::uint32_t below = 0;
    for (const std::uint32_t sun : word.suns) {
        const double side = dot(normal, &suns[3 * sun]);
        if (std::abs(side) <= word.error * most)
            unsure.insert(unsure.end(), {vertex, sun});
        else if (side < 0)
            below |= 1u << sun % 32;
    }
    return below;
}

}  // namespace

std::vector<std::uint32_t> clear_below(const TrianglesAtVertices& triangles, std::span<const double> suns,
                                       std::span<const bool> chosen, std::span<std::uint32_t> lit) {
    const std::vector<Word> words = words_of(suns, chosen);
    const std::size_t count = triangles.exist.size();
    std::array<std::vector<std::uint32_t>, most_parts> unsure;
    const std::size_t parts = in_parts(count, 1 << 14, [&](std::size_t first, std::size_t end, std::size_t part) {
        for (const Word& word : words)
            for (std::size_t i = first; i < end; ++i)
                if (triangles.exist[i])
                    lit[word.number * count + i] &=
                        ~bits_below(word, &triangles.normals[3 * i], std::uint32_t(i), suns, unsure[part]);
    });
    for (std::size_t i = 1; i < parts; ++i) unsure[0].insert(unsure[0].end(), unsure[i].begin(), unsure[i].end());
    return std::move(unsure[0]);
}

}  // namespace gnomon::python
