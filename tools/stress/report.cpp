// SPDX-License-Identifier: MIT
// See report.hpp.
#include "report.hpp"

#include <fmt/core.h>
#include <cmath>
#include <ctime>
#include <fstream>
#include <thread>

#include "embree.hpp"
#include "measure/grouped.hpp"

namespace stress {
namespace {

using gnomon::grouped;

/// `part` of `whole` in percent, with two digits that say something; nothing of nothing is a dash.
std::string percent(std::uint64_t part, std::uint64_t whole) {
    if (whole == 0) return "-";
    if (part == 0) return "0";
    const double value = 100.0 * double(part) / double(whole);
    return value >= 10 ? fmt::format("{:.1f} %", value) : fmt::format("{:.2g} %", value);
}

std::string fixed(double value, int digits) { return fmt::format("{:.{}f}", value, digits); }

std::string processor() {
    std::ifstream stream("/proc/cpuinfo");
    for (std::string line; std::getline(stream, line);)
        if (line.rfind("model name", 0) == 0) return line.substr(line.find(':') + 2);
    return "unknown processor";
}

std::string today() {
    const std::time_t now = std::time(nullptr);
    char text[16];
    std::strftime(text, sizeof(text), "%Y-%m-%d", std::gmtime(&now));
    return text;
}

std::string row(const std::vector<std::string>& cells) {
    std::string line = "|";
    for (const std::string& cell : cells) line.append(" ").append(cell).append(" |");
    return line + "\n";
}

/// The first `left` columns hold text, the others numbers.
std::string table_head(const std::vector<std::string>& names, std::size_t left) {
    std::vector<std::string> rule;
    for (std::size_t i = 0; i < names.size(); ++i) rule.push_back(i < left ? "---" : "---:");
    return row(names) + row(rule);
}

std::vector<std::string> answers(const std::string& name, const Tally& tally) {
    std::vector<std::string> cells = {name,
                                      grouped(tally.points),
                                      percent(tally.positional, tally.points),
                                      percent(tally.shadowed, tally.points),
                                      std::string("**").append(grouped(tally.wrong)).append("**"),
                                      tally.has_plain ? grouped(tally.plain_wrong) : "-"};
    if (tally.has_embree)
        for (const std::uint64_t wrong : tally.embree_wrong) cells.push_back(grouped(wrong));
    return cells;
}

std::vector<std::string> levels(const std::string& name, const Tally& tally) {
    std::vector<std::string> cells = {name,
                                      grouped(tally.triangles),
                                      percent(tally.facing_away, tally.points),
                                      percent(tally.by_map, tally.points),
                                      grouped(tally.pairs),
                                      percent(tally.pairs - std::min(tally.pairs, tally.open_pairs), tally.pairs),
                                      percent(tally.by_float, tally.pairs),
                                      percent(tally.by_double, tally.pairs),
                                      percent(tally.by_integers, tally.pairs),
                                      fixed(tally.gnomon_seconds, 1),
                                      fixed(tally.oracle_seconds, 1)};
    if (tally.has_embree) cells.push_back(fixed(tally.embree_seconds, 1));
    return cells;
}

std::string answers_table(const Report& report) {
    std::vector<std::string> names = {"case", "points", "point light", "in shadow", "gnomon", "plain float"};
    if (report.sum().has_embree)
        for (const EmbreeWay& way : EMBREE_WAYS) names.emplace_back(way.name);
    std::string text = table_head(names, 1);
    for (const CaseResult& result : report.cases) text += row(answers(result.name, result.tally));
    return text + row(answers("**all**", report.sum()));
}

std::string levels_table(const Report& report) {
    std::vector<std::string> names = {"case",         "triangles",     "facing away", "by the map",
                                      "pairs tested", "by the filter", "float",       "double",
                                      "integers",     "gnomon s",      "oracle s"};
    if (report.sum().has_embree) names.emplace_back("Embree s");
    std::string text = table_head(names, 1);
    for (const CaseResult& result : report.cases) text += row(levels(result.name, result.tally));
    return text + row(levels("**all**", report.sum()));
}

std::string who_answered(const Tally& sum) {
    std::string text =
        "Wrong points, of the same points, in the same run. *Point light*: the share of points lit from a position. "
        "*Plain "
        "float* is Moeller and Trumbore's test in float32 without a bound. Points that face away are not held against "
        "it, and it passes over a point's receiver, as gnomon does.";
    if (sum.has_embree)
        text += " The same goes for *Embree*, here " + embree_version() +
                ", without flags and with its robust flag, its rays starting 0, 1e-6 and 1e-4 of the scene's size from "
                "the point; " +
                grouped(sum.embree_left_out) + " points beyond its range of 1.8e18 it was not asked.";
    return text + "\n";
}

std::string closed_meshes(const Tally& sum) {
    return "Inside closed meshes, where no light from outside may reach, " + grouped(sum.leaks) +
           " points were lit. Of " + grouped(sum.star_points) + " camera points of spiky closed meshes " +
           grouped(sum.slipped) + " (" + percent(sum.slipped, sum.star_points) +
           ") slipped through a neighbouring face by rounding and lift; the farthest of these lies " +
           fixed(sum.largest_slip_ulp, 2) + " ulp from its hit, and " + grouped(sum.slipped_too_far) +
           " lie farther than the 16 ulp that the camera promises.\n";
}

std::string exact_path_table(const Report& report) {
    std::string text = table_head({"scene", "view", "light", "open pairs", "by integers", "trace ms", "exact trace ms",
                                   "share of both", "all stages ms"},
                                  3);
    for (const ExactPathRow& r : report.exact_path) {
        const double both = r.trace_ms + r.exact_ms;
        text +=
            row({r.scene, r.view, r.light, grouped(r.open_pairs), grouped(r.by_integers), fixed(r.trace_ms, 3),
                 fixed(r.exact_ms, 3), both > 0 ? fixed(100 * r.exact_ms / both, 2) + " %" : "-", fixed(r.all_ms, 3)});
    }
    return text;
}

}  // namespace

Tally Report::sum() const {
    Tally sum;
    for (const CaseResult& result : cases) sum += result.tally;
    return sum;
}

std::string line_of(const CaseResult& result) {
    const Tally& t = result.tally;
    const std::string text = fmt::format(
        "{:<32} {:>12} points {:>5} point light {:>7} shadow  wrong {}  plain {:<9} open {:<9} gnomon {:.1f} s  oracle "
        "{:.1f} s  plain {:.1f} s  embree {:.1f} s",
        result.name, grouped(t.points), percent(t.positional, t.points), percent(t.shadowed, t.points), t.wrong,
        t.has_plain ? grouped(t.plain_wrong) : "-", percent(t.open_pairs, t.pairs), t.gnomon_seconds, t.oracle_seconds,
        t.plain_seconds, t.embree_seconds);
    return t.first_wrong.empty() ? text : text + "\n    " + t.first_wrong;
}

std::string markdown(const Report& report) {
    const Tally sum = report.sum();
    std::string text = fmt::format(
        "# The stress suite\n\nMade by one command, {}:\n\n    {}\n\n{} points, each asked of gnomon and of the oracle "
        "(`tests/reference/`: exact, independent, no shared code): **{} wrong**. Seed {}, {} questions, {} minutes. "
        "gnomon ran on {} (driver {}), the others on {} threads of {}.\n",
        today(), report.command, grouped(sum.points), grouped(sum.wrong), report.options.seed, sum.questions,
        fixed(report.seconds / 60, 1), report.device, report.driver, std::thread::hardware_concurrency(), processor());
    text += "\n## Wrong answers\n\n" + who_answered(sum) + "\n" + answers_table(report) + "\n" + closed_meshes(sum);
    text +=
        "\n## Who decided\n\nShares of the points that face away or that the map decided, and of the pairs of a point "
        "and a triangle that were tested: by the float filter, and of those it left open by the exact predicate's "
        "three levels (pairs that another triangle had decided meanwhile are in none). Times are wall clock, gnomon's "
        "with uploads";
    if (sum.has_embree) text += "; Embree's is the sum of six ways, without its builds";
    text += ".\n\n" + levels_table(report);
    text += "\n## The cases\n\n";
    for (const CaseResult& result : report.cases) text += "- **" + result.name + "**: " + result.idea + ".\n";
    if (!report.exact_path.empty())
        text += "\n## What the exact path costs\n\nTimes of the stages trace and exact trace on " + report.device +
                ", 1920 x 1080, the least of 15 runs.\n\n" + exact_path_table(report);
    return text;
}

}  // namespace stress
