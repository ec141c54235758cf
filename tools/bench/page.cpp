// SPDX-License-Identifier: MIT
#include "page.hpp"

#include <algorithm>

#include "charts.hpp"
#include "experiments.hpp"
#include "page_style.hpp"
#include "tables.hpp"

namespace gnomon::bench {

namespace {

using Json = nlohmann::ordered_json;

std::string legend_html(const std::vector<std::pair<std::size_t, std::string>>& legend) {
    std::string html = "<ul class=\"legend\">";
    for (const auto& [series, name] : legend)
        html += "<li><span class=\"swatch " + class_of(series) + "\"></span>" + escaped(name) + "</li>";
    return html + "</ul>\n";
}

/// Names in the order they are first seen; their positions are the series' colours.
class Names {
public:
    std::size_t operator()(const std::string& name) {
        const auto found = std::ranges::find(names_, name);
        if (found != names_.end()) return static_cast<std::size_t>(found - names_.begin());
        names_.push_back(name);
        return names_.size() - 1;
    }
    std::string legend() const {
        std::vector<std::pair<std::size_t, std::string>> legend;
        for (std::size_t i = 0; i < names_.size(); ++i) legend.emplace_back(i, names_[i]);
        return legend_html(legend);
    }

private:
    std::vector<std::string> names_;
};

// Families that are there, with their colours.
std::vector<std::pair<std::size_t, std::string>> legend_of(const std::vector<Mark>& marks) {
    std::vector<std::pair<std::size_t, std::string>> legend;
    for (std::size_t i = 0; i < families().size(); ++i)
        if (std::ranges::find(marks, i, &Mark::series) != marks.end()) legend.emplace_back(i, families()[i].name);
    return legend;
}

std::string error_chart(const Comparison& view) {
    const std::vector<Mark> marks = marks_of(view);
    if (marks.empty()) return {};
    std::string html = "<h3>" + escaped(view.title) + "</h3>\n" + legend_html(legend_of(marks)) + scatter(marks);
    html += "<ol class=\"front\">";
    for (const std::size_t i : pareto_front(marks)) html += "<li>" + escaped(marks[i].tip) + "</li>";
    return html + "</ol>\n";
}

std::string image(const std::string& uri, const std::string& text) {
    return "<img src=\"" + uri + "\" alt=\"" + escaped(text) + "\"/>";
}

// A mask and, if it has errors, where they are, side by side.
std::string figure(const Row& row) {
    std::string images = image(row.mask_picture, "mask"), caption = name_of(row);
    if (row.errors->wrong() != 0 || row.errors->mean_absolute != 0) {
        images += image(row.difference_picture, "difference");
        caption += ": " + with_spaces(double(row.errors->wrongly_lit)) + " wrongly lit (orange), " +
                   with_spaces(double(row.errors->wrongly_shadowed)) + " wrongly shadowed (blue)";
    }
    return "<figure><div class=\"pair\">" + images + "</div><figcaption>" + escaped(caption) +
           "</figcaption></figure>\n";
}

std::string gallery(const Comparison& view) {
    std::string html;
    std::vector<std::string> shown;  // masks; the same one again would say nothing new
    for (const Row* row : view.rows) {
        if (row->mask_picture.empty() || std::ranges::find(shown, row->mask_hash) != shown.end()) continue;
        shown.push_back(row->mask_hash);
        html += figure(*row);
    }
    if (html.empty()) return {};
    return "<details open=\"open\"><summary>Masks and differences: " + escaped(view.title) +
           "</summary>\n<div class=\"gallery\">\n" + html + "</div></details>\n";
}

std::string stage_chart(const std::vector<Comparison>& views) {
    Names names;
    std::vector<Bar> all;
    for (const Comparison& view : views)
        for (const Row* row : view.rows) {
            if (row->stages.empty()) continue;
            Bar bar{view_of(*row), name_of(*row), {}, {}};
            for (const auto& [name, ms] : row->stages) {
                if (ms == 0) continue;  // skipped: no colour for it
                bar.parts.emplace_back(names(name), ms);
                bar.part_names.push_back(name);
            }
            all.push_back(std::move(bar));
        }
    return all.empty() ? std::string() : names.legend() + bars(all);
}

// The parts of each frame, by their medians.
std::string frame_chart(const std::vector<Comparison>& views) {
    constexpr std::pair<const char*, RunTimes FrameTimes::*> parts[] = {{"build", &FrameTimes::build},
                                                                        {"camera", &FrameTimes::camera},
                                                                        {"shadow", &FrameTimes::shadow},
                                                                        {"shade", &FrameTimes::shade}};
    Names names;
    std::vector<Bar> all;
    for (const Comparison& view : views)
        for (const Row* row : view.rows) {
            if (!row->frame) continue;
            Bar bar{view_of(*row), name_of(*row), {}, {}};
            for (const auto& [name, part] : parts) {
                const std::size_t series = names(name);
                std::vector<double> ms;
                for (const FrameTimes& run : row->runs) ms.push_back((run.*part).wall_ms);
                const double median_ms = times_of(std::move(ms)).median_ms;
                if (median_ms == 0) continue;
                bar.parts.emplace_back(series, median_ms);
                bar.part_names.push_back(name);
            }
            all.push_back(std::move(bar));
        }
    return all.empty() ? std::string() : names.legend() + bars(all);
}

std::string growth_chart(std::span<const Row> rows, const std::string& experiment) {
    const bool in_points = experiment == "growth_in_points";
    Names names;
    std::vector<Line> all;
    for (const Row& row : rows) {
        if (row.experiment != experiment || !row.failed.empty()) continue;
        // A made scene is named RECIPE_TRIANGLES.
        const std::string stem = in_points ? row.scene : row.scene.substr(0, row.scene.find_last_of('_'));
        const std::string label = stem + " " + row.view + "." + row.light + ", " + row.device;
        auto found = std::ranges::find(all, label, &Line::label);
        if (found == all.end()) found = all.insert(all.end(), {label, names(label), {}});
        found->points.emplace_back(in_points ? double(row.width) * row.height : double(row.triangles),
                                   row.total.median_ms);
    }
    return all.empty() ? std::string() : names.legend() + lines(all, in_points ? "points" : "triangles");
}

std::string charts_of(std::span<const Row> rows, const std::string& experiment) {
    const std::vector<Comparison> views = comparisons_of(rows, experiment);
    std::string html;
    if (experiment.starts_with("growth")) return growth_chart(rows, experiment);
    for (const Comparison& view : views) html += error_chart(view) + gallery(view);
    return html + frame_chart(views) + stage_chart(views);
}

std::string section(std::span<const Row> rows, const std::string& name, const std::string& title,
                    const std::string& idea) {
    if (std::ranges::find(rows, name, &Row::experiment) == rows.end()) return {};
    std::string html = "<h2 id=\"" + name + "\">" + escaped(title) + "</h2>\n<p>" + escaped(idea) + "</p>\n";
    html += charts_of(rows, name);
    for (const Table& table : tables_of(rows, name)) html += bench::html(table);
    return html;
}

std::string machine_table(const Json& machine) {
    std::string html = "<details><summary>Machine and versions</summary><div class=\"scroll\"><table><tbody>\n";
    for (const auto& [key, value] : machine.items())
        html += "<tr><td>" + escaped(key) + "</td><td>" +
                escaped(value.is_string() ? value.get<std::string>() : value.dump()) + "</td></tr>\n";
    return html + "</tbody></table></div></details>\n";
}

}  // namespace

std::string page(const Json& machine, std::span<const Row> rows) {
    const auto text = [&](const char* key) { return escaped(machine[key].get<std::string>()); };
    std::string html =
        "<!DOCTYPE html>\n<html lang=\"en\"><head><meta charset=\"utf-8\"/>\n"
        "<meta name=\"viewport\" content=\"width=device-width, initial-scale=1\"/>\n"
        "<title>gnomon: benchmark</title>\n<style>" +
        std::string(page_style) + "</style></head><body>\n<h1>gnomon: run time against error</h1>\n<p class=\"note\">" +
        text("date") + " · " + text("processor") + ", " +
        (machine["threads"] == 0 ? std::string("all") : machine["threads"].dump()) + " threads · gnomon " +
        text("gnomon") + " (" + text("commit") + ")</p>\n" +
        "<p>Times are medians of wall-clock runs after warm-up, from resident triangles and points to the resident "
        "mask; of frames, from resident triangles to a picture. A wrong point is one whose visibility is on the other "
        "side of one half. Modes: animated keeps nothing "
        "but the raw triangles between runs; moving keeps clusters of triangles; static keeps all that depends on "
        "scene and light.</p>\n" +
        machine_table(machine);
    html += section(rows, "times", "Times", "The scenes of the command line.");
    for (const Experiment& experiment : experiments())
        html += section(rows, experiment.name, experiment.title, experiment.idea);
    return html + "</body></html>\n";
}

std::vector<std::pair<std::string, std::string>> chart_files(std::span<const Row> rows) {
    std::vector<std::pair<std::string, std::string>> files;
    for (const Comparison& view : comparisons_of(rows, "techniques")) {
        const std::vector<Mark> marks = marks_of(view);
        if (marks.empty()) continue;
        const Row& row = *view.rows.front();
        const bool is_again = std::ranges::any_of(files, [&](const auto& file) { return file.first == row.scene; });
        files.emplace_back(is_again ? row.scene + "_" + row.light : row.scene,
                           scatter_file(view.title, marks, legend_of(marks)));
    }
    return files;
}

std::string markdown_report(const Json& machine, std::span<const Row> rows) {
    std::string text = "| machine and versions | |\n| --- | --- |\n";
    for (const auto& [key, value] : machine.items())
        text.append("| ")
            .append(key)
            .append(" | ")
            .append(value.is_string() ? value.get<std::string>() : value.dump())
            .append(" |\n");
    for (const Experiment& experiment : experiments()) {
        const std::vector<Table> tables = tables_of(rows, experiment.name);
        if (!tables.empty())
            text.append("\n## ").append(experiment.title).append("\n\n").append(experiment.idea).append("\n");
        for (const Table& table : tables) text.append("\n").append(markdown(table));
    }
    return text;
}

}  // namespace gnomon::bench
