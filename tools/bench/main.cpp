// SPDX-License-Identifier: MIT
// bench: run time against error, in one run for all techniques, settings, views, sizes, devices and rivals.
//
//   bench scene.glb ...                        times of the exact technique, each with the hash of its mask
//   bench --experiment all --json all.json     everything; --experiment table1 and so on: one of them; --full: at its
//                                              full size. tools/report.py makes a page of the JSON
//
// Times are from resident triangles and points to the resident mask: median, quartile distance and number of runs after
// warm-up, wall clock on a queue that does not profile; the stage breakdown comes from a second device object that
// does. Every row carries the hash of its mask and of its shading points, so a time is never seen without its result.
#include <fmt/core.h>
#include <CLI/CLI.hpp>
#include <cstdio>
#include <cstdlib>
#include <iostream>
#include <map>

#include "experiments.hpp"
#include "json.hpp"
#include "machine.hpp"
#include "peers.hpp"
#include "thread_table.hpp"

namespace {

using namespace gnomon::bench;

struct Options {
    std::vector<std::string> scenes, experiments, settings;
    std::vector<std::string> sizes{"1920x1080"};
    std::vector<std::string> devices{""};
    std::vector<float> light_position;
    std::vector<std::string> techniques{"frustum-traced"};
    std::vector<std::string> modes{"animated"};
    std::vector<std::uint32_t> samples{1};
    std::string views_file, scenes_folder, only;
    std::string many_lights, pixels;
    std::optional<double> sun_angle_degrees;
    std::uint64_t points = ManyLights{}.points;
    std::uint32_t columns = 1;
    std::string json_file, csv_file;
    std::optional<std::uint64_t> largest_triangles, largest_points;
    std::optional<int> runs;
    std::optional<double> seconds;
    std::vector<unsigned> threads{0};
    std::uint64_t oracle_points = 0;
    bool stages = false, sweep = false, errors = false, peers = false, full = false;

    bool is_small() const { return !experiments.empty() && !full; }
};

Limits limits_of(const Options& options) {
    Limits limits = options.full ? Limits{} : small_limits;
    if (options.largest_triangles) limits.largest_triangles = limits.swept_triangles = *options.largest_triangles;
    if (options.largest_points) limits.largest_points = limits.swept_points = *options.largest_points;
    return limits;
}

RunRule rule_of(const Options& options) {
    const RunRule rule = options.is_small() ? RunRule{5, 0.2} : RunRule{};
    return {options.runs.value_or(rule.most), options.seconds.value_or(rule.seconds)};
}

Settings parsed_settings(const std::vector<std::string>& texts) {
    Settings settings;
    for (const std::string& text : texts) {
        const std::size_t equals = text.find('=');
        if (equals == std::string::npos) throw gnomon::InvalidArgument("--set takes key=value, not \"" + text + "\"");
        settings.emplace_back(text.substr(0, equals), text.substr(equals + 1));
    }
    return settings;
}

std::string experiment_names() {
    std::string names = "all";
    for (const Experiment& experiment : experiments()) names += ", " + experiment.name;
    return names;
}

// The scenes of the command line.
std::vector<Block> blocks_of_scenes(const Options& options) {
    std::vector<Block> blocks;
    for (const std::string& scene : options.scenes) {
        Block block;
        block.experiment = "times";
        block.scene = scene;
        block.only = options.only;
        for (const std::string& size : options.sizes) block.sizes.push_back(parse_size(size));
        if (options.sweep)
            block.configurations = swept_configurations();
        else
            for (const std::string& technique : options.techniques)
                for (const std::string& mode : options.modes)
                    for (const std::uint32_t samples : options.samples)
                        block.configurations.push_back({technique, parsed_settings(options.settings), mode, samples});
        block.take_turns = options.modes.size() > 1 || options.samples.size() > 1 || options.peers;
        block.frames = !options.sweep;
        if (options.sun_angle_degrees) {
            block.experiment = "soft";
            block.configurations = soft_configurations(*options.sun_angle_degrees, 1024);
            block.sun_angle_degrees = options.sun_angle_degrees;
        }
        if (!options.many_lights.empty()) {
            block.experiment = "many_lights";
            block.many_lights = {options.many_lights, options.points, options.columns,
                                 options.sweep,       options.pixels, block.sizes.front()};
        }
        if (const auto& p = options.light_position; !p.empty())
            block.light = {"position", gnomon::Light::point({p[0], p[1], p[2]})};
        block.stages = options.stages;
        block.peers = options.peers;
        block.errors = options.errors || options.sweep || options.oracle_points != 0 || options.sun_angle_degrees;
        block.pictures = block.errors && !options.json_file.empty();
        block.oracle_points = options.oracle_points;
        blocks.push_back(std::move(block));
    }
    return blocks;
}

std::vector<Block> all_blocks(const Options& options, const SceneShelf& shelf) {
    std::vector<Block> blocks = blocks_of_scenes(options);
    for (const std::string& name : options.experiments)
        if (name != "all" && std::ranges::find(experiments(), name, &Experiment::name) == experiments().end())
            throw gnomon::InvalidArgument("there is no experiment \"" + name + "\": there are " + experiment_names());
    for (const Experiment& experiment : experiments()) {
        const auto asked = [&](const char* name) {
            return std::ranges::find(options.experiments, name) != options.experiments.end();
        };
        if (!asked("all") && !asked(experiment.name.c_str())) continue;
        std::ranges::move(experiment.blocks(shelf, limits_of(options)), std::back_inserter(blocks));
    }
    if (blocks.empty()) throw gnomon::InvalidArgument("name scenes or an --experiment to run; --help lists them");
    // What an experiment shows of a scene is narrowed down, never widened.
    std::erase_if(blocks, [&](const Block& b) {
        return b.only.find(options.only) == std::string::npos && options.only.find(b.only) == std::string::npos;
    });
    for (Block& block : blocks)
        if (options.only.size() > block.only.size()) block.only = options.only;
    return blocks;
}

// A row as a line, as soon as it is there.
void print(const Row& row) {
    std::printf("%-52s ", row.view_name().c_str());
    const auto part = [](const char* name, const std::optional<Times>& times) {
        if (times) std::printf("%s %8.3f ms  ", name, times->median_ms);
    };
    if (row.failed.empty()) {
        std::printf("%9.3f ms (%.3f .. %.3f)  ", row.total.median_ms, row.total.least_ms, row.total.most_ms);
        part("camera", row.camera);
        part("frame", row.frame);
        part("build", row.build);
        if (row.pairs) std::printf("%.1f M pairs/s  ", double(row.pairs->facing) / row.total.median_ms / 1e3);
        if (row.errors) std::printf("wrong %ju  ", std::uintmax_t{row.errors->wrong()});
        std::printf("mask %s points %s  ", row.mask_hash.c_str(), row.points_hash.c_str());
    }
    std::printf("%s (%s) %s\n", row.name().c_str(), row.mode.c_str(), row.failed.c_str());
    for (const auto& [stage, ms] : row.stages) std::printf("    %-26s %8.3f ms\n", stage.c_str(), ms);
    std::fflush(stdout);
}

void write_outputs(const Options& options, const nlohmann::ordered_json& machine, const std::vector<Row>& rows) {
    if (!options.json_file.empty()) write_file(options.json_file, report_json(machine, rows).dump(1) + "\n");
    if (!options.csv_file.empty()) write_file(options.csv_file, report_csv(machine, rows));
}

// What must not be in a benchmark of exact shadows: a technique that failed, or exact ones that are wrong or differ.
bool all_well(const std::vector<Row>& rows) {
    bool well = true;
    std::map<std::string, const Row*> exact_of_view;
    const auto complain = [&](const Row& row, const std::string& what) {
        std::cerr << "bench: error: " << row.name() << " on " << row.view_name() << ": " << what << '\n';
        well = false;
    };
    for (const Row& row : rows) {
        if (!row.failed.empty()) complain(row, row.failed);
        if (row.exact && row.errors && row.errors->wrong() != 0)
            complain(row, fmt::format("{} points differ from the exact technique's defaults", row.errors->wrong()));
        if (row.exact && row.oracle && row.oracle->wrong != 0)
            complain(row, fmt::format("{} points differ from the oracle", row.oracle->wrong));
        if (row.exact && row.oracle && row.oracle->wrong_rays != 0)
            complain(row, fmt::format("{} of the camera's rays differ from the oracle", row.oracle->wrong_rays));
        if (!row.exact || !row.failed.empty()) continue;
        // Means of other samples, per pixel or of the sun's disk, are other masks.
        const std::string samples = !row.settings.empty() && row.settings.back().first.ends_with("samples")
                                        ? row.settings.back().first + row.settings.back().second
                                        : "";
        const Row* first = exact_of_view.try_emplace(row.view_name() + samples, &row).first->second;
        if (first->mask_hash != row.mask_hash)
            complain(row, "the mask is " + row.mask_hash + ", but " + first->mask_hash + " by " + first->name());
    }
    return well;
}

int run(const Options& options) {
    const unsigned threads = options.threads.front();
    if (threads != 0) setenv("POCL_MAX_PTHREAD_COUNT", std::to_string(threads).c_str(), 1);
    SceneShelf shelf(options.views_file, options.scenes_folder);
    const std::vector<Block> blocks = all_blocks(options, shelf);
    const nlohmann::ordered_json machine = machine_json(threads, embree_version());
    Runner runner(shelf, {options.devices, rule_of(options), threads}, print);
    for (const Block& block : blocks) {
        runner.run(block);
        write_outputs(options, machine, runner.rows());  // a run that is cut short leaves what it has
    }
    if (runner.rows().empty())
        throw gnomon::InvalidArgument("nothing was measured: no VIEW.LIGHT contains \"" + options.only +
                                      "\", or the views are larger than --largest-points");
    return all_well(runner.rows()) ? 0 : 1;
}

}  // namespace

int main(int argc, char** argv) {
    gnomon::add_rivals();
    Options options;
    CLI::App app{"Measures run time against error; each time with the hash of its mask."};
    app.add_option("scenes", options.scenes, "glTF files, sundial, or RECIPE:TRIANGLES of make_scenes (city:1000000)");
    app.add_option("--experiment", options.experiments, "repeatable: " + experiment_names());
    app.add_option("--scenes-folder", options.scenes_folder,
                   "where sponza.glb, lost_empire.glb and views.json are (scenes), for the experiments")
        ->check(CLI::ExistingDirectory);
    app.add_flag("--full", options.full,
                 "the experiments at their full size, which on a CPU take hours; else all of them take some minutes");
    app.add_option("--largest-triangles", options.largest_triangles,
                   "made scenes are made no larger; default 1000000, with --full 20000000");
    app.add_option(
        "--largest-points", options.largest_points,
        "the experiments' views have no more pixels; default 921600 (230400 where every technique runs), with "
        "--full 33177600 (2073600)");
    app.add_option("--views", options.views_file, "views and lights by scene, as in scenes/views.json");
    app.add_option("--only", options.only, "only cases whose VIEW.LIGHT contains this");
    app.add_option("--size", options.sizes, "WIDTHxHEIGHT, repeatable")->capture_default_str();
    app.add_option("--technique", options.techniques, "as in gnomon techniques, repeatable")->capture_default_str();
    app.add_option("--set", options.settings, "key=value of each --technique, repeatable");
    app.add_option("--mode", options.modes,
                   "animated: everything is rebuilt in each run; moving: clusters of the triangles are kept; static: "
                   "the light is prepared; repeatable")
        ->capture_default_str()
        ->check(CLI::IsMember({"animated", "moving", "static"}));
    app.add_option("--samples", options.samples,
                   "points per pixel: 1, 4, 8, 16 or 32, repeatable; times of more than one hold finding them")
        ->capture_default_str();
    app.add_flag("--sweep", options.sweep,
                 "every technique, with the settings worth comparing, and its errors; of --many-lights, every way");
    app.add_flag("--errors", options.errors, "compare with the exact technique's mask");
    app.add_option("--oracle", options.oracle_points,
                   "check so many of its points, and of the camera's rays, by the independent oracle");
    app.add_flag("--peers", options.peers, "Embree too, if it was there when this was built");
    app.add_option("--light-position", options.light_position, "light every view from this point: X Y Z")->expected(3);
    app.add_option("--sun-angle", options.sun_angle_degrees,
                   "the truth is soft, by 1,024 lights on a disk of so many degrees; beside it pcss and the filters")
        ->check(CLI::Range(1e-3, 45.0));
    CLI::Option* many_lights = app.add_option(
        "--many-lights", options.many_lights,
        "in place of views: points of the scenes times suns (latitude 52, hourly), suns:N of them, sky (145 "
        "patches), sky:D (Reinhart's division), disk:N (lights on the sun's disk), lamp:N (samples of a lamp in the "
        "middle of the scene) or lamps:N (point lights before faces)");
    app.add_option("--points", options.points, "of --many-lights: on faces, or of a terrain's vertices")
        ->capture_default_str()
        ->check(CLI::Range(1, 1 << 28));
    CLI::Option* columns =
        app.add_option("--columns", options.columns,
                       "of --many-lights: only the points in one of so many columns of 24 x 24, all of them there")
            ->check(CLI::Range(1, 576));
    app.add_option("--pixels", options.pixels,
                   "of --many-lights: the points of this view's pixels, at the first --size, on the eye's side")
        ->needs(many_lights)
        ->excludes(columns);
    app.add_option("--runs", options.runs, "timed runs; default 15, of small experiments 5")
        ->check(CLI::Range(1, 100000));
    app.add_option("--seconds", options.seconds,
                   "no more runs of the same after this time (but at least 3 where they do not take thrice as long); "
                   "default 4, of small experiments 0.2");
    app.add_option(
           "--threads", options.threads,
           "CPU threads of PoCL and of the rivals; 0: all; repeatable: a run with each, and a table of what each part "
           "gains (with --stages, each stage)")
        ->capture_default_str();
    app.add_option("--device", options.devices, "as in gnomon devices, repeatable");
    app.add_option("--json", options.json_file, "write all rows there, for tools/report.py");
    app.add_option("--csv", options.csv_file, "the same as a table");
    app.add_flag("--stages", options.stages, "also run with profiling: each stage's time");
    try {
        app.parse(argc, argv);
        if (options.threads.size() > 1) return run_with_each(options.threads, {argv, std::size_t(argc)});
        return run(options);
    } catch (const CLI::ParseError& error) {
        return app.exit(error) == 0 ? 0 : 2;
    } catch (const std::exception& error) {
        std::cerr << "bench: error: " << error.what() << '\n';
        return 1;
    }
}
