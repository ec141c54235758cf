// SPDX-License-Identifier: MIT
// `gnomon bench`: the benchmark's core (tools/bench) on one device, as a page of text and as JSON. First views whose
// answers the golden record has, then times of whole frames of larger scenes.
#include <fmt/core.h>
#include <algorithm>
#include <array>

#include "bench/contestant.hpp"
#include "bench/json.hpp"
#include "bench/machine.hpp"
#include "options.hpp"
#include "output_files.hpp"
#include "report.hpp"
#include "terminal.hpp"

namespace gnomon::app {
namespace {

using Json = nlohmann::ordered_json;

constexpr std::array known_scenes{"colonnade:20000", "city:20000", "foliage:20000", "pipes:20000"};
constexpr bench::Size known_size{640, 360};
constexpr std::array timed_scenes{"sundial", "colonnade:300000", "city:1000000", "foliage:1000000"};
constexpr bench::Size timed_size{1920, 1080};
constexpr std::array modes{"animated", "static"};

/// The hash of this view's visibility in the golden record; empty if the record has no such view.
std::string recorded_hash(const std::string& view) {
    constexpr std::string_view key = " visibility ";
    const std::string_view record = text_file("golden/made_scenes.txt");
    const std::size_t line = record.find("\n" + view + ": ");
    const std::size_t at = line == std::string_view::npos ? line : record.find(key, line);
    return at == std::string_view::npos ? std::string() : std::string(record.substr(at + key.size(), 16));
}

/// A run, and the hash that its mask must have; empty: another run's of the same view.
struct Finding {
    bench::Row row;
    std::string must_be;

    bool is_right() const { return row.failed.empty() && row.mask_hash == must_be; }
};

std::string line_of(const Finding& finding) {
    const bench::Row& row = finding.row;
    const std::string view = fmt::format("  {:<44} {:<9}", row.view_name(), row.mode);
    if (!row.failed.empty()) return view + " FAILED: " + row.failed + "\n";
    const std::string verdict = finding.is_right() ? "" : " WRONG, must be " + finding.must_be;
    if (!row.frame) return view + fmt::format(" {}{}\n", row.mask_hash, verdict);
    return view + fmt::format("{:>9.2f}{:>9.2f}{:>9.2f}{:>9.2f}{:>5}  {}{}\n", row.camera->median_ms,
                              row.total.median_ms, row.shade->median_ms, row.frame->median_ms, row.frame->runs,
                              row.mask_hash, verdict);
}

class Bench {
public:
    explicit Bench(const BenchOptions& options) : options_(options) {}

    void run() {
        for (const char* const name : known_scenes) run_scene(name, known_size, true);
        for (const char* const name : timed_scenes) {
            if (clock_.elapsed_ms() > options_.seconds * 1e3) {
                left_out_.emplace_back(name, fmt::format("{} s were spent", options_.seconds));
                continue;
            }
            try {
                run_scene(name, timed_size, false);
            } catch (const Error& error) {  // a small device may not hold it
                left_out_.emplace_back(name, error.what());
            }
        }
    }

    std::string page() const;
    Json json() const;
    std::size_t wrong() const {
        return std::size_t(std::ranges::count_if(findings_, [](const Finding& f) { return !f.is_right(); }));
    }

private:
    void run_scene(const std::string& name, bench::Size size, bool is_known);
    void run_view(const bench::Place& place, const bench::Case& c, bench::Size size, bool is_known);

    const BenchOptions& options_;
    bench::Clock clock_;
    bench::SceneShelf shelf_{{}, {}};
    std::optional<DeviceDescription> device_;
    std::vector<Finding> findings_;
    Json machine_ = bench::machine_json(0, "not built in");      ///< with the load before the runs
    std::vector<std::pair<std::string, std::string>> left_out_;  ///< scenes, and why
};

/// Of a known scene each camera's view under the first light; of the others the first view.
void Bench::run_scene(const std::string& name, bench::Size size, bool is_known) {
    const bench::NamedScene& scene = shelf_.get(name);
    const bench::Place place(options_.device, scene, false);
    device_ = place.device.description();
    const std::string light = scene.cases.front().light_name;
    for (const bench::Case& c : scene.cases) {
        if (c.light_name != light) continue;
        run_view(place, c, size, is_known);
        if (!is_known) return;
    }
}

void Bench::run_view(const bench::Place& place, const bench::Case& c, bench::Size size, bool is_known) {
    const bench::Seen seen = bench::seen_in(place, c, size);
    const bench::RunRule rule{is_known ? 1 : 15, options_.seconds / double(timed_scenes.size() * modes.size()) / 2};
    std::string must_be;
    if (is_known) {
        const std::string recipe = seen.row.scene.substr(0, seen.row.scene.find('_'));
        must_be = recorded_hash(recipe + "_" + c.view + "_" + c.light_name);
        if (must_be.empty()) throw Error("the golden record lacks " + seen.row.view_name());
    }
    for (const char* const mode : modes) {
        bench::OwnContestant contestant({"frustum-traced", {}, mode}, place, seen, !is_known);
        contestant.warm_up();
        const bench::Clock clock;
        for (int run = 0; rule.goes_on(run, clock.elapsed_ms()); ++run) contestant.run_timed();
        bench::Row row = contestant.finish().row;
        row.experiment = is_known ? "known" : "frames";
        if (must_be.empty()) must_be = row.mask_hash;  // what is not known must be the same in both modes
        findings_.push_back({std::move(row), must_be});
    }
}

std::string Bench::page() const {
    std::string text =
        fmt::format("gnomon {} ({}), bench of a device\n\n{}host  {}, {} logical cores, {}; load {:.1f} before\n\n",
                    version(), machine_["commit"].get<std::string>(), device_text(*device_),
                    machine_["processor"].get<std::string>(), machine_["logical_cores"].get<unsigned>(),
                    machine_["system"].get<std::string>(), machine_["load_average_at_start"].get<double>());
    text += "answers of the golden record: hashes of the visibility\n";
    for (const Finding& finding : findings_)
        if (finding.row.experiment == "known") text += line_of(finding);
    text +=
        fmt::format("\nframes, medians in ms; static: the light is prepared\n  {:<54}{:>9}{:>9}{:>9}{:>9}{:>5}  {}\n",
                    "", "camera", "shadows", "picture", "frame", "runs", "hash of the visibility");
    for (const Finding& finding : findings_)
        if (finding.row.experiment == "frames") text += line_of(finding);
    for (const auto& [scene, why] : left_out_) text += fmt::format("  {:<44} left out: {}\n", scene, why);
    text += fmt::format("\n{}: {} runs, {} of them wrong; {:.0f} s. Please send this page, or the file of -o.\n",
                        wrong() == 0 ? "RIGHT" : "WRONG", findings_.size(), wrong(), clock_.elapsed_ms() / 1e3);
    return text;
}

Json Bench::json() const {
    Json json{{"gnomon", std::string(version())},
              {"machine", machine_},
              {"device", device_json(*device_)},
              {"wrong", wrong()},
              {"left_out", left_out_},
              {"rows", Json::array()}};
    for (const Finding& finding : findings_) {
        json["rows"].push_back(to_json(finding.row));
        json["rows"].back()["right"] = finding.is_right();
    }
    return json;
}

}  // namespace

void bench_device(const BenchOptions& options) {
    OutputFiles files;
    OutputFile* const file = options.json ? &files.open(*options.json) : nullptr;
    Bench bench(options);
    {
        const ProgressLine progress("measuring", true);
        bench.run();
    }
    print_result(bench.page());
    if (file != nullptr) {
        const std::string text = bench.json().dump(2) + "\n";
        file->write_all(text.data(), text.size());
        files.commit();
    }
    if (bench.wrong() != 0) throw Error("answers of the device are wrong: do not use it, and please send this page");
}

}  // namespace gnomon::app
