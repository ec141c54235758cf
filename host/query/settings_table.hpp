// SPDX-License-Identifier: MIT
// The settings of a technique as a table: one row has a setting's name, default, meaning and the reader of its text.
// The table determines the fields' first values, set(), describe() and the texts of errors.
// rivals/sub_pixel_shadow_map.cpp has a small one.
#pragma once

#include <functional>
#include <gnomon.hpp>
#include <vector>

namespace gnomon {

/// A setting's name and the text given for it. Each reader throws InvalidArgument, naming the setting, what is allowed
/// (bounds included) and the text.
struct SettingText {
    std::string_view name, text;

    float number(double low, double high) const;
    std::optional<float> number_or_auto(double low, double high) const;
    std::uint32_t whole(std::uint32_t low, std::uint32_t high) const;
    std::uint32_t whole_or_auto(std::uint32_t low, std::uint32_t high) const;  ///< 0 for "auto"
    /// Position of the text among the names.
    std::uint32_t choice(std::span<const std::string_view> names) const;
    /// The same; nothing for the last name, "auto".
    std::optional<std::uint32_t> choice_or_auto(std::span<const std::string_view> names) const;
};

// Each function reads a row's text into a field, by the reader of the same name. Names must outlive the table.
namespace setting {

template <auto Reader, typename S, typename Field, typename... Allowed>
auto read(Field S::*field, const Allowed&... allowed) {
    return [=](S& settings, const SettingText& value) {
        settings.*field = static_cast<Field>((value.*Reader)(allowed...));
    };
}
auto number(auto field, double low, double high) { return read<&SettingText::number>(field, low, high); }
auto number_or_auto(auto field, double low, double high) {
    return read<&SettingText::number_or_auto>(field, low, high);
}
auto whole(auto field, auto low, auto high) { return read<&SettingText::whole>(field, low, high); }
auto whole_or_auto(auto field, auto low, auto high) { return read<&SettingText::whole_or_auto>(field, low, high); }
using Names = std::span<const std::string_view>;
auto choice(auto field, Names names) { return read<&SettingText::choice>(field, names); }
auto choice_or_auto(auto field, Names names) { return read<&SettingText::choice_or_auto>(field, names); }
inline constexpr std::string_view off_on[] = {"off", "on"};
auto on_off(auto field) { return choice(field, off_on); }

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
