// SPDX-License-Identifier: MIT
#include "no_data.hpp"

#include <algorithm>
#include <cmath>
#include <map>
#include <utility>

namespace gnomon::scene {
namespace {

constexpr double too_large = 1e30;

/// As floats: float tables hold them rounded.
template <typename Numbers>
bool is_among(double number, const Numbers& numbers) {
    return std::ranges::any_of(numbers, [number](double n) { return float(n) == float(number); });
}

template <typename Value>
class Places {
public:
    Places(std::span<const Value> values, std::size_t columns) : values_(values), columns_(columns) {}

    std::optional<NoData> first_absent() {
        for (std::size_t i = 0; i < values_.size(); ++i) {
            const double number = values_[i];
            const bool is_absent =
                std::fabs(number) >= too_large
                    ? columns_ > 1 && is_large_pair(i / columns_, number)
                    : may_stand_for_no_data(number) && is_among(number, no_data) && is_alone(i % columns_, number);
            if (is_absent) return NoData{i / columns_, i % columns_};
        }
        return std::nullopt;
    }

private:
    bool is_alone(std::size_t column, double number) {
        const auto [found, is_new] = is_alone_.try_emplace({column, number}, true);
        if (is_new) found->second = has_none_near(column, number);
        return found->second;
    }

    bool has_none_near(std::size_t column, double number) const {
        bool has_other = false;
        for (std::size_t i = column; i < values_.size(); i += columns_) {
            if (is_near(i, number) || std::fabs(double(values_[i]) + number) <= 1) return false;
            has_other = has_other || double(values_[i]) != number;
        }
        for (std::size_t i = 0; i < values_.size() && !has_other; ++i)
            if (is_near(i, number)) return false;
        return true;
    }

    bool is_near(std::size_t i, double number) const {
        const double ratio = double(values_[i]) / number;
        return ratio >= 0.5 && ratio <= 2 && ratio != 1;
    }

    bool has_twice(std::size_t row, double number) const {
        return std::ranges::count(values_.subspan(row * columns_, columns_), Value(number)) >= 2;
    }

    bool is_large_pair(std::size_t row, double number) const {
        if (!has_twice(row, number)) return false;
        for (std::size_t i = 0; i < values_.size(); ++i)
            if (double(values_[i]) / number >= 0.5 && !has_twice(i / columns_, number)) return false;
        return true;
    }

    std::span<const Value> values_;
    std::size_t columns_;
    std::map<std::pair<std::size_t, double>, bool> is_alone_;  ///< of columns' numbers
};

}  // namespace

template <typename Value>
std::optional<NoData> first_absent_place(std::span<const Value> values, std::size_t columns) {
    return Places<Value>(values, columns).first_absent();
}
template std::optional<NoData> first_absent_place(std::span<const float>, std::size_t);
template std::optional<NoData> first_absent_place(std::span<const double>, std::size_t);

std::optional<std::size_t> first_absent_weight(std::span<const double> weights) {
    for (std::size_t i = 0; i < weights.size(); ++i) {
        const double number = weights[i];
        const bool is_usual = number > -98.0 && number < 9998.0;
        if (is_usual ||
            !(std::fabs(number) >= too_large || is_among(number, no_data) || is_among(number, no_data_beside_places)))
            continue;
        const bool is_alone =
            std::ranges::none_of(weights, [number](double other) { return other != number && other / number >= 0.5; });
        if (is_alone) return i;
    }
    return std::nullopt;
}

}  // namespace gnomon::scene
