// SPDX-License-Identifier: MIT
// Runs cases and keeps their rows.
#pragma once

#include <functional>
#include <map>

#include "cases.hpp"
#include "contestant.hpp"
#include "many_lights.hpp"
#include "row.hpp"
#include "sweep.hpp"
#include "timing.hpp"

namespace gnomon::bench {

/// "WIDTHxHEIGHT"; throws InvalidArgument.
Size parse_size(const std::string& text);

/// A light or a view of the benchmark's own.
struct OtherLight {
    std::string name;
    Light light;
};
struct OtherView {
    std::string name;
    Camera camera;
};

/// What is run on one scene.
struct Block {
    std::string experiment;
    std::string scene;  ///< as SceneShelf::get takes it
    std::vector<Size> sizes;
    std::vector<Configuration> configurations;
    std::string only;                             ///< only cases whose VIEW.LIGHT contains this
    std::optional<OtherLight> light;              ///< in place of the scene's lights, once per view
    std::optional<OtherView> view;                ///< in place of the scene's views, once per light
    std::function<Settings(Size)> more_settings;  ///< added to each configuration's, by size; may be empty
    /// Runs of the configurations take turns, so that whatever else the machine does hits all alike. All are in memory
    /// at once.
    bool take_turns = false;
    std::optional<double> sun_angle_degrees;  ///< the truth is soft: of the first configuration's lights on this disk
    bool frames = false;                      ///< each run also makes its points and a picture
    bool stages = false;                      ///< also profiled runs, for the stage breakdown
    bool errors = false;                      ///< against the exact technique's mask
    bool pictures = false;                    ///< also masks and errors in few pixels; with errors
    std::optional<ManyLights> many_lights;    ///< in place of all views: points and lights of its own
    bool peers = false;  ///< the rivals too, with as many samples per pixel as a configuration has at most; with
                         ///< take_turns, their best take turns with the configurations
    /// At most that many pixels of the exact technique's mask, evenly spread, are asked of the oracle, with all samples
    /// of a pixel; with errors.
    std::uint64_t oracle_points = 0;
};

struct RunOptions {
    std::vector<std::string> devices{""};  ///< as Device takes them
    RunRule rule;
    unsigned threads = 0;  ///< of the rivals
};

class Runner {
public:
    /// `report` is called with each row as soon as it is there.
    Runner(SceneShelf& shelf, RunOptions options, std::function<void(const Row&)> report);

    void run(const Block& block);
    const std::vector<Row>& rows() const { return rows_; }

private:
    struct Truth;
    struct Entry;

    Seen look(const Place& place, const Block& block, const Case& c, Size size) const;
    Truth truth_of(const Block& block, const Place& place, const Seen& seen) const;
    OracleVerdict judge_samples(const Block& block, const Place& place, const Seen& seen, std::uint32_t samples,
                                std::span<const float> mean) const;
    static void judge(const Block& block, const Seen& seen, const Truth& truth, std::span<const float> mask, Row& row);
    std::vector<Entry> entries_of(const Block& block, const Place& place, const Seen& seen,
                                  std::span<const Configuration> configurations, bool has_peers) const;
    void run_entries(const Block& block, const Place& place, const Seen& seen, const std::optional<Truth>& truth,
                     std::vector<Entry>& entries);
    /// `means`: the exact masks of several samples per pixel, which a rival's are measured against.
    void finish(const Block& block, const Place& place, const Seen& seen, const std::optional<Truth>& truth,
                Entry& entry, std::map<std::uint32_t, std::vector<float>>& means);
    /// Reports the rows that waited for their stages.
    void add_stages(const Block& block, const std::string& selector, const NamedScene& scene, const Case& c, Size size,
                    std::vector<Entry>& entries) const;
    void run_case(const Block& block, const NamedScene& scene, const Case& c, Size size);
    void run_many_lights(const Block& block, const NamedScene& scene);

    SceneShelf& shelf_;
    RunOptions options_;
    std::function<void(const Row&)> report_;
    std::vector<Row> rows_;
};

}  // namespace gnomon::bench
