// SPDX-License-Identifier: MIT
#include "tables.hpp"

#include <algorithm>
#include <cctype>
#include <cmath>
#include <cstdio>

#include "published.hpp"
#include "sweep.hpp"

namespace gnomon::bench {

namespace {

using Rows = std::vector<const Row*>;

std::string percent(double share) { return share == 0 ? "0" : three_digits(100 * share) + " %"; }

std::string five_decimals(double value) {
    char text[32];
    std::snprintf(text, sizeof(text), "%.5f", value);
    return text;
}

std::string times_text(const Times& times) {
    if (times.runs == 1) return three_digits(times.median_ms) + " (1 run)";
    return three_digits(times.median_ms) + " ± " + three_digits(times.spread_ms / 2);
}

std::string size_of(const Row& row) { return std::to_string(row.width) + "x" + std::to_string(row.height); }

/// A share of the points, in percent.
double decided_by_map(const Row& row) {
    const double points = double(row.count("points")) - double(row.count("points_absent"));
    return points > 0 ? double(row.count("points_decided_by_map")) / points : 0;
}

// Every stage of any of the rows, in the order of the pipeline as far as the rows tell it.
std::vector<std::string> stages_of(const Rows& rows) {
    std::vector<std::string> names;
    for (const Row* row : rows)
        for (const auto& [name, ms] : row->stages)
            if (std::ranges::find(names, name) == names.end()) names.push_back(name);
    return names;
}

double stage_ms(const Row& row, const std::string& name) {
    for (const auto& [stage, ms] : row.stages)
        if (stage == name) return ms;
    return 0;
}

Rows rows_of(std::span<const Row> rows, const std::string& experiment) {
    Rows found;
    for (const Row& row : rows)
        if (row.experiment == experiment) found.push_back(&row);
    return found;
}

// ---- One kind of table each -----------------------------------------------------------------------------------------

Table error_table(const Comparison& view) {
    Table table{view.title,
                "",
                {"technique", "ms", "wrong", "share", "wrongly lit", "wrongly shadowed", "mean absolute", "SSIM",
                 "worst tile", "memory, MB"},
                {}};
    for (const Row* row : view.rows) {
        if (!row->failed.empty()) {
            table.lines.push_back({name_of(*row), row->failed});
            continue;
        }
        std::vector<std::string> line{name_of(*row), times_text(row->total)};
        if (row->errors) {
            const measure::VisibilityErrors& e = *row->errors;
            for (const std::string& cell :
                 {with_spaces(double(e.wrong())), percent(e.wrong_share()), with_spaces(double(e.wrongly_lit)),
                  with_spaces(double(e.wrongly_shadowed)), three_digits(e.mean_absolute), five_decimals(e.ssim),
                  three_digits(e.worst_tile)})
                line.push_back(cell);
        } else {
            line.resize(9);
        }
        line.push_back(three_digits(double(row->device_memory_bytes) / 1e6));
        table.lines.push_back(std::move(line));
    }
    for (const Row* row : view.rows)
        if (row->oracle && table.note.empty())
            table.note = "Of the exact technique's answers, " + with_spaces(double(row->oracle->points)) +
                         " were put to the independent oracle: " + with_spaces(double(row->oracle->wrong)) + " wrong.";
    return table;
}

Table soft_table(const Comparison& view) {
    Table table{view.title,
                "Mean absolute errors of the visibility, and points that are wrong by half or more.",
                {"technique", "ms", "error in penumbrae", "error everywhere", "wrong", "share of points in penumbrae"},
                {}};
    for (const Row* row : view.rows) {
        if (!row->failed.empty() || !row->errors) continue;
        const measure::VisibilityErrors& e = *row->errors;
        table.lines.push_back({name_of(*row), times_text(row->total), three_digits(e.penumbra_mean_absolute),
                               three_digits(e.mean_absolute), percent(e.wrong_share()),
                               percent(double(e.penumbra_points) / double(std::max<std::uint64_t>(e.points, 1)))});
    }
    return table;
}

Table bias_table(const Comparison& view) {
    Table table{view.title,
                "Acne: points that are lit and called dark. Peter-panning: points in shadow that are called lit. Both "
                "hold what the texels' size gets wrong along edges, whatever the bias.",
                {"technique", "ms", "acne (wrongly shadowed)", "share", "peter-panning (wrongly lit)", "share"},
                {}};
    for (const Row* row : view.rows) {
        if (!row->failed.empty() || !row->errors) continue;
        const auto share = [&](std::uint64_t count) { return percent(double(count) / double(row->errors->points)); };
        const std::uint64_t acne = row->errors->wrongly_shadowed, panning = row->errors->wrongly_lit;
        table.lines.push_back({name_of(*row), times_text(row->total), with_spaces(double(acne)), share(acne),
                               with_spaces(double(panning)), share(panning)});
    }
    return table;
}

Table stage_table(const Rows& rows) {
    Table table{"",
                "Total: median and half the quartile distance of wall-clock runs. Stages: device time by events, in "
                "separate profiled runs. Milliseconds.",
                {"view", "size", "triangles", "technique", "total"},
                {}};
    const std::vector<std::string> stages = stages_of(rows);
    table.heads.insert(table.heads.end(), stages.begin(), stages.end());
    table.heads.push_back("points decided by the map");
    for (const Row* row : rows) {
        if (!row->failed.empty() || row->stages.empty()) continue;
        std::vector<std::string> line{row->scene + " " + row->view + "." + row->light, size_of(*row),
                                      with_spaces(double(row->triangles)), name_of(*row), times_text(row->total)};
        for (const std::string& stage : stages) line.push_back(three_digits(stage_ms(*row, stage)));
        line.push_back(percent(decided_by_map(*row)));
        table.lines.push_back(std::move(line));
    }
    return table;
}

const Row* row_with(const Comparison& view, const std::string& technique, const std::string& settings,
                    const std::string& mode) {
    for (const Row* row : view.rows)
        if (row->failed.empty() && row->technique == technique && row->mode == mode &&
            text_of(row->settings).starts_with(settings))
            return row;
    return nullptr;
}

// Of one row's time over another's, in each round: median and spread. No runs if the two did not take turns.
Times ratio_by_turns(const Row& row, const Row& other, Part part, double RunTimes::*clock = &RunTimes::wall_ms) {
    std::vector<double> ratios;
    for (std::size_t i = 0; i < std::min(row.runs.size(), other.runs.size()); ++i)
        ratios.push_back(part_ms(row.runs[i], part, clock) / part_ms(other.runs[i], part, clock));
    return ratios.empty() ? Times{} : times_of(std::move(ratios));
}

double median_of(const Row& row, Part part) {
    std::vector<double> ms;
    for (const FrameTimes& run : row.runs) ms.push_back(part_ms(run, part));
    return times_of(std::move(ms)).median_ms;
}

// The rival's row of that mode with the fastest tree for a part of a frame.
const Row* best_rival(const Comparison& view, const char* mode, Part part) {
    const Row* best = nullptr;
    for (const Row* row : view.rows)
        if (row->technique == "embree" && row->failed.empty() && row->mode == mode && row->frame &&
            (best == nullptr || median_of(*row, part) < median_of(*best, part)))
            best = row;
    return best;
}

std::string ratio_text(const Row& row, const Row& rival, Part part, double RunTimes::*clock = &RunTimes::wall_ms) {
    return times_text(ratio_by_turns(row, rival, part, clock));
}

// One line for each view and mode. Without rivals it has none.
Table rival_table(const std::vector<Comparison>& views) {
    Table table{
        "gnomon beside Embree",
        "Milliseconds, medians. A frame is camera, shadow and shade. Ratios: gnomon's time over Embree's in each "
        "round, "
        "median and half the quartile distance; below 1 gnomon is ahead. Animated: Embree's tree of low quality is "
        "built in each run, and its build counts in each column. Moving and static: the build does not count, and the "
        "tree is the fastest of its qualities for the part. By processor time: of all threads, which other programs on "
        "the machine change least.",
        {"view", "mode", "camera", "Embree", "ratio", "by processor time", "shadow", "Embree", "ratio",
         "by processor time", "frame", "Embree", "ratio", "by processor time", "Embree's trees"},
        {}};
    for (const Comparison& view : views)
        for (const Row* ours : view.rows) {
            if (!ours->failed.empty() || !ours->exact || !ours->frame || text_of(ours->settings).starts_with("samples"))
                continue;
            std::vector<std::string> line{view.title, ours->mode};
            std::string trees;
            for (const Part part : {Part::camera, Part::shadow, Part::frame}) {
                const Row* rival = best_rival(view, ours->mode == "animated" ? "animated" : "static", part);
                if (rival == nullptr) break;
                for (const std::string& cell :
                     {three_digits(median_of(*ours, part)), three_digits(median_of(*rival, part)),
                      ratio_text(*ours, *rival, part), ratio_text(*ours, *rival, part, &RunTimes::processor_ms)})
                    line.push_back(cell);
                trees.append(trees.empty() ? "" : ", ").append(rival->settings.front().second);
            }
            line.push_back(trees);
            if (!trees.empty()) table.lines.push_back(std::move(line));
        }
    return table;
}

// Each tree's times, and how many points each of the rival's settings gets wrong.
Table rival_settings_table(const std::vector<Comparison>& views) {
    Table table{"Embree's settings",
                "Rays of gnomon's own points. Wrong: against the exact mask. Other triangles: pixels whose primary ray "
                "meets another triangle than gnomon's camera.",
                {"view", "settings", "mode", "build", "camera", "shadow", "wrong points", "other triangles"},
                {}};
    for (const Comparison& view : views)
        for (const Row* row : view.rows) {
            if (row->technique != "embree" || !row->failed.empty()) continue;
            table.lines.push_back(
                {view.title, text_of(row->settings), row->mode, row->build ? times_text(*row->build) : "",
                 row->camera ? times_text(*row->camera) : "", times_text(row->total),
                 row->errors ? with_spaces(double(row->errors->wrong())) : "",
                 row->counts.empty() ? "" : with_spaces(double(row->count("points_on_other_triangles")))});
        }
    return table;
}

double x_of_growth(const Row& row, bool in_points) {
    return in_points ? double(row.width) * row.height : double(row.triangles);
}

Table growth_table(const Rows& rows, bool in_points) {
    Table table{"",
                "Growth: this time over the one before it, scaled to a doubling.",
                {"scene", in_points ? "points" : "triangles", "ms", "growth for twice as many"},
                {}};
    const Row* before = nullptr;
    for (const Row* row : rows) {
        if (!row->failed.empty()) continue;
        std::string growth;
        const auto stem = [](const Row& r) { return r.scene.substr(0, r.scene.find_last_of('_')) + r.view; };
        const double x = x_of_growth(*row, in_points);
        if (before != nullptr && stem(*before) == stem(*row) && x > x_of_growth(*before, in_points))
            growth = three_digits(std::pow(row->total.median_ms / before->total.median_ms,
                                           1 / std::log2(x / x_of_growth(*before, in_points))));
        table.lines.push_back({row->scene + " " + row->view, with_spaces(x), times_text(row->total), growth});
        before = row;
    }
    return table;
}

Table memory_table(const Rows& rows) {
    Table table{"",
                "ItemRange: of the aim, 64 bytes per point (pixel) and 48 bytes per triangle.",
                {"view", "size", "triangles", "MB", "bytes per point", "share of 64 per point + 48 per triangle"},
                {}};
    for (const Row* row : rows) {
        if (!row->failed.empty()) continue;
        const double bytes = double(row->device_memory_bytes), points = double(row->width) * row->height;
        table.lines.push_back({row->scene + " " + row->view + "." + row->light, size_of(*row),
                               with_spaces(double(row->triangles)), three_digits(bytes / 1e6),
                               three_digits(bytes / points),
                               percent(bytes / (64 * points + 48 * double(row->triangles)))});
    }
    return table;
}

// The first row of a scene in a mode has all its work; others are compared with it.
Table skip_table(const Rows& rows) {
    Table table{"",
                "Milliseconds, medians. Of the first: this time over that of the scene's first view in the same mode. "
                "Points: shares of all. Triangles: outside the light's frame and, of the others, behind every point "
                "below them, shares of all; with clusters those that are dropped unread count as outside. Looked at "
                "exactly: pairs of a point and a triangle that the filter left open, of all its tests.",
                {"view", "mode", "ms", "of the first", "sky", "facing away", "decided by the map", "triangles outside",
                 "behind all points", "clusters dropped", "looked at exactly", "stages that did not run"},
                {}};
    for (const Row* row : rows) {
        if (!row->failed.empty()) continue;
        const Row* first = *std::ranges::find_if(
            rows, [&](const Row* r) { return r->failed.empty() && r->scene == row->scene && r->mode == row->mode; });
        const auto share = [&](std::uint64_t part, const char* of) {
            return percent(double(part) / double(std::max<std::uint64_t>(row->count(of), 1)));
        };
        std::string reasons;
        for (const auto& [stage, why] : row->skipped)
            if (stage != "clusters")  // the mode says so
                reasons.append(reasons.empty() ? "" : "; ").append(stage).append(": ").append(why);
        table.lines.push_back(
            {row->scene + " " + row->view + "." + row->light, row->mode, times_text(row->total),
             percent(row->total.median_ms / first->total.median_ms), share(row->count("points_absent"), "points"),
             share(row->count("points_facing_away"), "points"), share(row->count("points_decided_by_map"), "points"),
             share(row->count("triangles_outside"), "triangles"), share(row->count("triangles_hidden"), "triangles"),
             share(row->count("clusters_outside") + row->count("clusters_too_far"), "clusters"),
             share(row->count("uncertain_pairs"), "tests"), reasons});
    }
    return table;
}

Table map_table(const std::vector<Comparison>& views) {
    Table table{
        "",
        "Milliseconds, medians; the three take turns. Ratios: the median of the turns' ratios, by wall clock and "
        "by processor time of all threads. The better one is the faster of on and off by that measure; at most "
        "1.03 is the aim.",
        {"view", "on", "off", "auto", "on over off", "the same, processor time", "auto over the better",
         "the same, processor time", "masks"},
        {}};
    for (const Comparison& view : views) {
        const auto with = [&](const char* mode) {
            return row_with(view, "frustum-traced", std::string("conservative-map=") + mode, "animated");
        };
        const Row *on = with("on"), *off = with("off"), *automatic = with("auto");
        if (!on || !off || !automatic) continue;
        const bool same = on->mask_hash == off->mask_hash && on->mask_hash == automatic->mask_hash;
        std::vector<std::string> line{view.title, times_text(on->total), times_text(off->total),
                                      times_text(automatic->total)};
        std::vector<std::string> over;
        for (const auto time : {&RunTimes::wall_ms, &RunTimes::processor_ms}) {
            const double on_over_off = ratio_by_turns(*on, *off, Part::shadow, time).median_ms;
            line.push_back(three_digits(on_over_off));
            over.push_back(
                three_digits(ratio_by_turns(*automatic, on_over_off <= 1 ? *on : *off, Part::shadow, time).median_ms));
        }
        std::ranges::move(over, std::back_inserter(line));
        line.push_back(same ? "the same" : "DIFFER");
        table.lines.push_back(std::move(line));
    }
    return table;
}

Table cluster_table(const std::vector<Comparison>& views) {
    Table table{
        "",
        "Milliseconds, medians; the two take turns. Setup: the stages clusters and triangle_setup, with profiling. "
        "Dropped: of all clusters, and of all triangles by whichever test. Keeping: once for a mesh.",
        {"view", "animated", "moving", "setup, animated", "setup, moving", "camera, animated", "camera, moving",
         "clusters dropped", "triangles dropped", "keeping them"},
        {}};
    for (const Comparison& view : views) {
        const Row *animated = row_with(view, "frustum-traced", "", "animated"),
                  *moving = row_with(view, "frustum-traced", "", "moving");
        if (!animated || !moving || !animated->camera || !moving->camera || !moving->build) continue;
        const auto setup = [](const Row& row) { return stage_ms(row, "clusters") + stage_ms(row, "triangle_setup"); };
        const auto share = [&](std::uint64_t part, const char* of) {
            return percent(double(part) / double(std::max<std::uint64_t>(moving->count(of), 1)));
        };
        table.lines.push_back({view.title, times_text(animated->total), times_text(moving->total),
                               three_digits(setup(*animated)), three_digits(setup(*moving)),
                               three_digits(animated->camera->median_ms), three_digits(moving->camera->median_ms),
                               share(moving->count("clusters_outside") + moving->count("clusters_too_far"), "clusters"),
                               share(moving->count("triangles_outside"), "triangles"),
                               three_digits(moving->build->median_ms)});
    }
    return table;
}

// The first row of a view is gnomon's; each other one stands in a line of its own with the ratio of the two rates.
Table lights_table(const std::vector<Comparison>& views) {
    Table table{
        "",
        "Million front-facing pairs per second, by the wall clock; medians. Ratio: the rival's time over gnomon's, "
        "the median of the rounds, by wall clock and by processor time.",
        {"scene", "triangles", "points", "lights", "facing, M", "lit", "way", "M pairs/s", "ms a light", "ratio",
         "by processor time", "differing bits"},
        {}};
    for (const Comparison& view : views) {
        for (const Row* row : view.rows) {
            if (!row->failed.empty() || !row->pairs) continue;
            const LightPairs& pairs = *row->pairs;
            const Row& ours = *view.rows.front();
            std::vector<std::string> line{row->scene + ", " + row->view,
                                          with_spaces(double(row->triangles)),
                                          with_spaces(double(pairs.points)),
                                          row->light + " (" + with_spaces(double(pairs.lights)) + ")",
                                          three_digits(double(pairs.facing) / 1e6),
                                          percent(double(pairs.lit) / double(std::max<std::uint64_t>(pairs.facing, 1))),
                                          name_of(*row),
                                          three_digits(double(pairs.facing) / row->total.median_ms / 1e3),
                                          three_digits(row->total.median_ms / double(pairs.lights))};
            for (const auto clock : {&RunTimes::wall_ms, &RunTimes::processor_ms})
                line.push_back(row == &ours ? ""
                                            : three_digits(ratio_by_turns(*row, ours, Part::shadow, clock).median_ms));
            line.push_back(with_spaces(double(pairs.differing)));
            table.lines.push_back(std::move(line));
        }
    }
    return table;
}

Table samples_table(const std::vector<Comparison>& views) {
    Table table{
        "",
        "Milliseconds, medians; all take turns, and ratios are medians of the rounds. Several samples: their time "
        "holds "
        "finding their receivers. A frame is camera, samples and shade. Embree: 32 camera rays and as many shadow rays "
        "per pixel, of its fastest tree; its error is the mean absolute one against gnomon's.",
        {"view", "camera", "1 sample", "4", "32", "32 over 1", "frame, 1", "frame, 32", "32 over 1",
         "Embree's 32 camera rays", "shadow rays", "gnomon's 32 over its shadow rays", "frame over its frame",
         "by processor time", "Embree's error"},
        {}};
    for (const Comparison& view : views) {
        const Row *one = row_with(view, "frustum-traced", "", "animated"),
                  *four = row_with(view, "frustum-traced", "samples=4", "animated"),
                  *many = row_with(view, "frustum-traced", "samples=32", "animated");
        if (!one || !four || !many || !one->frame || !many->frame) continue;
        std::vector<std::string> line{view.title,
                                      times_text(*one->camera),
                                      times_text(one->total),
                                      times_text(four->total),
                                      times_text(many->total),
                                      ratio_text(*many, *one, Part::shadow),
                                      times_text(*one->frame),
                                      times_text(*many->frame),
                                      ratio_text(*many, *one, Part::frame)};
        if (const Row* rays = best_rival(view, "static", Part::frame))
            for (const std::string& cell :
                 {times_text(*rays->camera), times_text(rays->total), ratio_text(*many, *rays, Part::shadow),
                  ratio_text(*many, *rays, Part::frame), ratio_text(*many, *rays, Part::frame, &RunTimes::processor_ms),
                  rays->errors ? three_digits(rays->errors->mean_absolute) : std::string()})
                line.push_back(cell);
        table.lines.push_back(std::move(line));
    }
    return table;
}

// Which family's colour a row has.
std::size_t series_of(const Row& row) {
    const auto found = std::ranges::find_if(families(), [&](const Family& family) {
        return std::ranges::find(family.techniques, row.technique) != family.techniques.end();
    });
    return std::size_t(found - families().begin());
}

// One line for each technique and setting, one column for each view.
Table technique_table(const std::vector<Comparison>& views) {
    Table table{"",
                "Milliseconds (median) and share of wrong points. Bold: on the view's front, where no other is both "
                "faster and less wrong.",
                {"technique"},
                {}};
    for (const Comparison& view : views) {
        table.heads.push_back(view.title);
        const std::vector<Mark> marks = marks_of(view);
        const std::vector<std::size_t> front = pareto_front(marks);
        std::size_t mark = 0;
        for (const Row* row : view.rows) {
            auto line = std::ranges::find(table.lines, name_of(*row), [](const auto& cells) { return cells.front(); });
            if (line == table.lines.end()) line = table.lines.insert(line, {name_of(*row)});
            line->resize(table.heads.size());
            if (!row->failed.empty()) line->back() = row->failed;
            if (!row->failed.empty() || !row->errors) continue;
            std::string cell = three_digits(row->total.median_ms) + " ms, " + percent(row->errors->wrong_share());
            if (std::ranges::find(front, mark++) != front.end()) cell = "**" + cell + "**";
            line->back() = std::move(cell);
        }
    }
    return table;
}

Table published_table(const nlohmann::ordered_json& json) {
    Table table{json["title"],
                "Published by others: " + json["source"].get<std::string>() +
                    ". Machine: " + json["machine"].get<std::string>() + ".",
                json["columns"],
                {}};
    for (const auto& row : json["rows"]) {
        table.lines.emplace_back();
        for (const auto& cell : row)
            table.lines.back().push_back(cell.is_null()     ? "–"
                                         : cell.is_string() ? cell.get<std::string>()
                                                            : cell.dump());
    }
    return table;
}

bool is_bold(const std::string& cell) { return cell.starts_with("**"); }

std::string cell_html(const std::string& cell) {
    return is_bold(cell) ? "<strong>" + escaped(cell.substr(2, cell.size() - 4)) + "</strong>" : escaped(cell);
}

bool is_number(const std::string& cell) {
    const std::string text = is_bold(cell) ? cell.substr(2) : cell;
    return !text.empty() && (std::isdigit(text[0]) || text == "–");
}

}  // namespace

std::string name_of(const Row& row) {
    return row.name() + (row.mode.empty() || row.mode == "animated" ? "" : " (" + row.mode + ")");
}

std::string view_of(const Row& row) { return row.scene + " " + row.view + "." + row.light + ", " + size_of(row); }

std::vector<Comparison> comparisons_of(std::span<const Row> rows, const std::string& experiment) {
    std::vector<Comparison> views;
    std::string device;  // a rival's row has no OpenCL device: it belongs to the view before it
    for (const Row* row : rows_of(rows, experiment)) {
        if (row->driver.empty() || row->technique != "embree") device = row->device;
        const std::string title = view_of(*row) + ", " + device;
        auto found = std::ranges::find(views, title, &Comparison::title);
        if (found == views.end()) found = views.insert(views.end(), {title, {}});
        found->rows.push_back(row);
    }
    return views;
}

std::vector<Mark> marks_of(const Comparison& view) {
    std::vector<Mark> marks;
    for (const Row* row : view.rows) {
        if (!row->failed.empty() || !row->errors) continue;
        marks.push_back({row->errors->wrong_share(), row->total.median_ms, series_of(*row),
                         name_of(*row) + ": " + three_digits(row->total.median_ms) + " ms, " +
                             with_spaces(double(row->errors->wrong())) + " wrong",
                         row->technique == "embree" && row->mode == "static"});
    }
    return marks;
}

std::vector<Table> tables_of(std::span<const Row> rows, const std::string& experiment) {
    const Rows ours = rows_of(rows, experiment);
    const std::vector<Comparison> views = comparisons_of(rows, experiment);
    std::vector<Table> tables;
    if (ours.empty()) return tables;
    if (experiment == "errors" || experiment == "times") {
        for (const Comparison& view : views) tables.push_back(error_table(view));
        if (Table table = rival_table(views); !table.lines.empty()) tables.push_back(std::move(table));
    } else if (experiment == "techniques") {
        tables = {technique_table(views)};
    } else if (experiment == "bias") {
        for (const Comparison& view : views) tables.push_back(bias_table(view));
    } else if (experiment == "rivals") {
        tables = {rival_table(views), rival_settings_table(views), stage_table(ours)};
    } else if (experiment.starts_with("growth")) {
        tables = {growth_table(ours, experiment == "growth_in_points")};
    } else if (experiment == "memory") {
        tables = {memory_table(ours)};
    } else if (experiment == "skips") {
        tables = {skip_table(ours)};
    } else if (experiment == "auto") {
        tables = {map_table(views)};
    } else if (experiment == "samples") {
        tables = {samples_table(views)};
    } else if (experiment == "soft") {
        for (const Comparison& view : views) tables.push_back(soft_table(view));
    } else if (experiment == "many_lights") {
        tables = {lights_table(views)};
    } else if (experiment == "clusters") {
        tables = {cluster_table(views)};
    } else {
        tables = {stage_table(ours)};
        if (experiment == "figure5") tables.push_back(map_table(views));
    }
    for (const auto& json : published())
        if (json["experiment"] == experiment) tables.push_back(published_table(json));
    return tables;
}

std::string html(const Table& table) {
    std::string text;
    if (!table.title.empty()) text += "<h3>" + escaped(table.title) + "</h3>\n";
    text += "<div class=\"scroll\"><table><thead><tr>";
    for (std::size_t i = 0; i < table.heads.size(); ++i)
        text += (i != 0 && !table.lines.empty() && i < table.lines[0].size() && is_number(table.lines[0][i])
                     ? "<th class=\"n\">"
                     : "<th>") +
                escaped(table.heads[i]) + "</th>";
    text += "</tr></thead><tbody>\n";
    for (const auto& line : table.lines) {
        text += "<tr>";
        for (std::size_t i = 0; i < line.size(); ++i)
            text += (i != 0 && is_number(line[i]) ? "<td class=\"n\">" : "<td>") + cell_html(line[i]) + "</td>";
        text += "</tr>\n";
    }
    text += "</tbody></table></div>\n";
    if (!table.note.empty()) text += "<p class=\"source\">" + escaped(table.note) + "</p>\n";
    return text;
}

std::string markdown(const Table& table) {
    const auto line_of = [&](const std::vector<std::string>& cells) {
        std::string text = "|";
        for (std::size_t i = 0; i < table.heads.size(); ++i) text += " " + (i < cells.size() ? cells[i] : "") + " |";
        return text + "\n";
    };
    std::string text;
    if (!table.title.empty()) text.append("**").append(table.title).append("**\n\n");
    text += line_of(table.heads) + line_of(std::vector<std::string>(table.heads.size(), "---"));
    for (const auto& line : table.lines) text += line_of(line);
    if (!table.note.empty()) text.append("\n").append(table.note).append("\n");
    return text;
}

}  // namespace gnomon::bench
