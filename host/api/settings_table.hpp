// SPDX-License-Identifier: MIT
// The settings of a technique as a table: one row states a setting's name, default, meaning and how its text is read.
// The fields' first values, set(), describe() and the texts of errors follow from the table:
//
//   struct BlobSettings { float radius; bool soft; };
//   const SettingsTable<BlobSettings> table{
//       {{"radius", "0.5", "of the blob, world units, 0 to 10"}, setting::number(&BlobSettings::radius, 0, 10)},
//       {{"soft", "off", "on or off: the edge fades"}, setting::on_off(&BlobSettings::soft)}};
#pragma once

#include <functional>
#include <gnomon.hpp>
#include <vector>

namespace gnomon {

/// A setting's name and the text given for it. Each reader throws InvalidArgument, naming the setting, what is allowed
/// and the text.
struct SettingText {
    std::string_view name, text;

    /// A number from low to high (both included).
    float number(double low, double high) const;
    /// A whole number from low to high (both included).
    std::uint32_t whole(std::uint32_t low, std::uint32_t high) const;
    /// The same, or 0 for "auto".
    std::uint32_t whole_or_auto(std::uint32_t low, std::uint32_t high) const;
    /// Position of the text among the names.
    std::uint32_t choice(std::span<const std::string_view> names) const;
};

// How a row's text is read into a field. Other ways are lambdas of the same parameters.
namespace setting {

template <typename Settings, typename Field>
auto number(Field Settings::*field, double low, double high) {
    return [=](Settings& settings, const SettingText& value) { settings.*field = value.number(low, high); };
}
template <typename Settings, typename Field>
auto whole(Field Settings::*field, std::uint32_t low, std::uint32_t high) {
    return [=](Settings& settings, const SettingText& value) { settings.*field = value.whole(low, high); };
}
template <typename Settings, typename Field>
auto whole_or_auto(Field Settings::*field, std::uint32_t low, std::uint32_t high) {
    return [=](Settings& settings, const SettingText& value) { settings.*field = value.whole_or_auto(low, high); };
}
/// "auto" leaves the field empty.
template <typename Settings, typename Field>
auto number_or_auto(std::optional<Field> Settings::*field, double low, double high) {
    return [=](Settings& settings, const SettingText& value) {
        settings.*field = value.text == "auto" ? std::nullopt : std::optional<Field>(value.number(low, high));
    };
}
/// `names`: of the field's values, which count from 0. They must outlive the table.
template <typename Settings, typename Field>
auto choice(Field Settings::*field, std::span<const std::string_view> names) {
    return [=](Settings& settings, const SettingText& value) {
        settings.*field = static_cast<Field>(value.choice(names));
    };
}
/// As choice(), where the last name is "auto" and leaves the field empty.
template <typename Settings, typename Field>
auto choice_or_auto(std::optional<Field> Settings::*field, std::span<const std::string_view> names) {
    return [=](Settings& settings, const SettingText& value) {
        const std::uint32_t chosen = value.choice(names);
        settings.*field = chosen + 1 == names.size() ? std::nullopt : std::optional(static_cast<Field>(chosen));
    };
}
template <typename Settings>
auto on_off(bool Settings::*field) {
    static constexpr std::string_view names[] = {"off", "on"};
    return choice(field, names);
}

}  // namespace setting

/// Throws InvalidArgument, naming the technique, the setting that it lacks and those that it has.
[[noreturn]] void throw_no_setting(std::string_view technique, std::string_view name,
                                   std::span<const SettingDescription> settings);

template <typename Settings>
class SettingsTable {
public:
    struct Row {
        SettingDescription description;
        std::function<void(Settings&, const SettingText&)> apply;
    };
    SettingsTable(std::initializer_list<Row> rows) : rows_(rows) {}

    /// Every field as its row's default says.
    Settings defaults() const {
        Settings settings{};
        for (const Row& row : rows_) row.apply(settings, {row.description.name, row.description.default_value});
        return settings;
    }
    /// False where the table has no such row; throws InvalidArgument where the row does not allow the text.
    bool set_if_known(Settings& settings, std::string_view name, std::string_view text) const {
        for (const Row& row : rows_)
            if (row.description.name == name) return row.apply(settings, {name, text}), true;
        return false;
    }
    /// Throws InvalidArgument for the technique of this name where the table has no such row.
    void set(Settings& settings, std::string_view technique, std::string_view name, std::string_view text) const {
        if (!set_if_known(settings, name, text)) throw_no_setting(technique, name, descriptions());
    }
    std::vector<SettingDescription> descriptions() const {
        std::vector<SettingDescription> all;
        for (const Row& row : rows_) all.push_back(row.description);
        return all;
    }

private:
    std::vector<Row> rows_;
};

}  // namespace gnomon
