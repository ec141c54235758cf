// SPDX-License-Identifier: MIT
#include "many_lights.hpp"

#include <fmt/core.h>
#include <algorithm>
#include <bit>
#include <charconv>
#include <cmath>
#include <map>
#include <sstream>

#include "cl/embedded_files.hpp"
#include "make_scenes/arithmetic.hpp"
#include "query/vectors.hpp"
#include "terrain_raster.hpp"

namespace gnomon {
std::span<const EmbeddedFile> embedded_tables();
}

namespace gnomon::bench {
namespace {

using make_scenes::Random;

// ---- Points ---------------------------------------------------------------------------------------------------------

/// Of a triangle: outward by its winding, as long as twice its area.
glm::dvec3 normal_of(const float* v) { return cross(loaded(v + 3) - loaded(v), loaded(v + 6) - loaded(v)); }

void append_unit(std::vector<float>& normals, const glm::dvec3& n) {
    const Float3 unit = array_of(n / length(n));
    normals.insert(normals.end(), unit.begin(), unit.end());
}

void points_on_faces(LightsQuestion& question, std::uint64_t count) {
    const std::vector<float>& vertices = question.scene.scene.triangles;
    std::vector<double> area_up_to;
    double sum = 0, largest = 0;
    for (std::size_t t = 0; t < vertices.size() / 9; ++t) {
        const double twice = length(normal_of(&vertices[9 * t]));
        if (std::isfinite(twice)) sum += twice;
        area_up_to.push_back(sum);
    }
    for (const float coordinate : vertices)
        if (std::isfinite(coordinate)) largest = std::max(largest, std::abs(double(coordinate)));
    if (sum == 0) throw InvalidArgument("the scene has no area to put points on");
    Random random(1);
    for (std::uint64_t i = 0; i < count; ++i) {
        const auto t =
            static_cast<std::size_t>(std::ranges::upper_bound(area_up_to, random.unit() * sum) - area_up_to.begin());
        const float* v = &vertices[9 * t];
        const glm::dvec3 n = normal_of(v);
        const double lift = 2e-6 * largest / length(n);
        double a = random.unit(), b = random.unit();
        if (a + b > 1) {
            a = 1 - a;
            b = 1 - b;
        }
        const glm::dvec3 o = loaded(v);
        const Float3 at = array_of(o + a * (loaded(v + 3) - o) + b * (loaded(v + 6) - o) + lift * n);
        question.positions.insert(question.positions.end(), at.begin(), at.end());
        append_unit(question.normals, n);
        question.receivers.push_back(static_cast<std::uint32_t>(t));
    }
}

// Selection sampling (Knuth 3.4.2 S): every choice of `count` vertices is equally likely.
void points_on_vertices(LightsQuestion& question, std::uint64_t count) {
    const std::vector<float>& vertices = question.scene.scene.triangles;
    std::map<std::array<float, 3>, glm::dvec3> normals;
    for (std::size_t corner = 0; corner < vertices.size() / 3; ++corner) {
        const float* at = &vertices[3 * corner];
        normals[{at[0], at[1], at[2]}] += normal_of(&vertices[corner / 3 * 9]);
    }
    Random random(1);
    std::uint64_t left = normals.size(), wanted = count;
    for (const auto& [position, normal] : normals) {
        const bool is_taken = random.unit() * double(left--) < double(wanted);
        if (!is_taken) continue;
        --wanted;
        question.positions.insert(question.positions.end(), position.begin(), position.end());
        append_unit(question.normals, normal);
    }
}

void points_of_pixels(LightsQuestion& question, const Place& place, const ManyLights& asked) {
    const auto& cases = question.scene.cases;
    const auto found = std::ranges::find(cases, asked.view, &Case::view);
    if (found == cases.end())
        throw InvalidArgument(question.scene.name + " has no view \"" + asked.view + "\" for --pixels");
    question.picture = look(place.device, place.triangles, found->camera, asked.size.width, asked.size.height);
    ViewOnHost host = question.picture->read(place.device, place.triangles);
    question.positions = std::move(host.position);
    question.normals = std::move(host.normal);
    question.receivers = std::move(host.receiver);
}

// Keeps the points in one of so many columns.
void keep_columns(LightsQuestion& question, std::uint32_t one_in) {
    constexpr double columns_a_side = 24;
    std::array<double, 2> low, extent;
    for (std::size_t axis = 0; axis < 2; ++axis) {
        const auto coordinate = [&](std::size_t i) { return double(question.positions[3 * i + 2 * axis]); };
        double high = low[axis] = coordinate(0);
        for (std::size_t i = 0; i < question.count(); ++i) {
            low[axis] = std::min(low[axis], coordinate(i));
            high = std::max(high, coordinate(i));
        }
        extent[axis] = std::max(high - low[axis], 1e-30);
    }
    std::size_t kept = 0;
    for (std::size_t i = 0; i < question.count(); ++i) {
        std::uint64_t column = 0;
        for (std::size_t axis = 0; axis < 2; ++axis)
            column = column * 32 + static_cast<std::uint64_t>((question.positions[3 * i + 2 * axis] - low[axis]) /
                                                              extent[axis] * columns_a_side);
        if (Random(column).below(one_in) != 0) continue;
        for (std::size_t c = 0; c < 3; ++c) {
            question.positions[3 * kept + c] = question.positions[3 * i + c];
            question.normals[3 * kept + c] = question.normals[3 * i + c];
        }
        if (!question.are_vertices()) question.receivers[kept] = question.receivers[i];
        ++kept;
    }
    question.positions.resize(3 * kept);
    question.normals.resize(3 * kept);
    if (!question.are_vertices()) question.receivers.resize(kept);
}

// ---- Lights ---------------------------------------------------------------------------------------------------------

struct TimedSun {
    std::string hour;
    Light light;
};

std::vector<TimedSun> suns_of_the_year() {
    const EmbeddedFile& table = embedded_tables().front();
    std::istringstream lines(std::string(table.text));
    std::vector<TimedSun> suns;
    for (std::string line; std::getline(lines, line);) {
        Float3 d{};
        const std::size_t time_end = line.find(',');
        if (line.starts_with('#') || line.starts_with("time")) continue;
        const char* at = line.data() + time_end + 1;
        for (float& c : d) at = std::from_chars(at, line.data() + line.size(), c).ptr + 1;
        suns.push_back({line.substr(line.find('T'), time_end - line.find('T')), Light::directional(d)});
    }
    return suns;
}

struct Box {
    Float3 low, extent;
    float widest() const { return std::max(extent[0], extent[2]); }
};

Box box_of(const LightsQuestion& question) {
    Float3 low{}, high{};
    low.fill(std::numeric_limits<float>::infinity());
    high.fill(-std::numeric_limits<float>::infinity());
    const std::vector<float>& vertices = question.scene.scene.triangles;
    for (std::size_t i = 0; i < vertices.size(); ++i) {
        if (!std::isfinite(vertices[i])) continue;
        low[i % 3] = std::min(low[i % 3], vertices[i]);
        high[i % 3] = std::max(high[i % 3], vertices[i]);
    }
    return {low, {high[0] - low[0], high[1] - low[1], high[2] - low[2]}};
}

// A horizontal square, a twentieth of the scene wide, in its middle at seven tenths of its height.
Lights lamp_in_the_middle(const Box& box, std::uint32_t samples) {
    const float side = box.widest() / 20;
    const auto middle = [&](std::size_t c) { return box.low[c] + box.extent[c] / 2 - side / 2; };
    return area_light({middle(0), box.low[1] + box.extent[1] * 0.7f, middle(2)}, {side, 0, 0}, {0, 0, side}, samples);
}

// Each before one of the question's points, by a fiftieth of the scene's width.
Lights lamps(const LightsQuestion& question, std::uint32_t count) {
    const float height = box_of(question).widest() / 50;
    std::vector<Light> lights;
    Random random(2);
    while (lights.size() < count) {
        const std::size_t i = 3 * random.below(question.count());
        const auto at = [&](std::size_t c) { return question.positions[i + c] + height * question.normals[i + c]; };
        lights.push_back(Light::point({at(0), at(1), at(2)}));
    }
    return Lights(std::move(lights));
}

[[noreturn]] void refuse(const std::string& asked) {
    throw InvalidArgument("--many-lights takes suns, suns:N, sky, sky:D, disk:N, lamp:N or lamps:N, not \"" + asked +
                          "\"");
}

std::uint64_t number_in(const std::string& text, std::uint64_t most, const std::string& asked) {
    std::uint64_t value = 0;
    const auto [end, error] = std::from_chars(text.data(), text.data() + text.size(), value);
    if (error != std::errc() || end != text.data() + text.size() || value == 0 || value > most) refuse(asked);
    return value;
}

void make_lights(LightsQuestion& question, const std::string& asked) {
    const std::size_t colon = std::min(asked.find(':'), asked.size());
    const std::string kind = asked.substr(0, colon), number = asked.substr(std::min(colon + 1, asked.size()));
    const auto in_order = [&] {
        for (std::uint32_t i = 0; i < question.lights.count(); ++i) question.light_order.push_back(i);
    };
    if (kind == "sky") {
        const auto division = number.empty() ? 1 : number_in(number, 16, asked);
        question.lights = sky_patches({0, 1, 0}, {0, 0, -1}, static_cast<std::uint32_t>(division));
        return in_order();
    }
    if (kind == "disk") {
        const auto samples = static_cast<std::uint32_t>(number_in(number, 1 << 20, asked));
        question.lights = sun_disk({-0.3f, -1, -0.2f}, 0.533, samples);
        return in_order();
    }
    if (kind == "lamp" || kind == "lamps") {
        const auto count = static_cast<std::uint32_t>(number_in(number, 1 << 20, asked));
        question.lights = kind == "lamp" ? lamp_in_the_middle(box_of(question), count) : lamps(question, count);
        return in_order();
    }
    if (kind != "suns") refuse(asked);
    const std::vector<TimedSun> all = suns_of_the_year();
    const std::uint64_t count = kind == asked ? all.size() : number_in(number, all.size(), asked);
    std::vector<Light> lights;
    std::vector<std::string> hours;
    for (std::uint64_t i = 0; i < count; ++i) {
        const TimedSun& sun = all[i * all.size() / count];
        lights.push_back(sun.light);
        hours.push_back(sun.hour);
    }
    question.lights = Lights(std::move(lights));
    in_order();
    std::ranges::stable_sort(question.light_order, {}, [&](std::uint32_t i) { return hours[i]; });
}

std::uint64_t facing_pairs(const LightsQuestion& question) {
    std::uint64_t facing = 0;
    for (std::size_t i = 0; i < question.count(); ++i)
        for (const Light& light : question.lights.lights())
            facing += is_facing(&question.normals[3 * i], &question.positions[3 * i], light.xyzw);
    return facing;
}

// ---- gnomon ---------------------------------------------------------------------------------------------------------

// What a contestant asks about.
struct Inputs {
    Triangles triangles;
    Points points, normals;
    Lights lights;
    std::string kind;  ///< of the triangles, unless they are the scene's own
};

Inputs inputs_of(const LightsQuestion& question, const Place& place) {
    Inputs in{place.triangles,
              question.picture ? question.picture->points
                               : Points::upload(place.device, question.positions, question.receivers),
              Points::upload(place.device, question.normals), question.lights, ""};
    in.triangles.keep_clusters(place.device);
    return in;
}

Inputs inputs_of_raster(const LightsQuestion& question, const Place& place) {
    return {raster_of_terrain(place.device, question.scene.scene.triangles),
            Points::upload(place.device, with_z_up(question.positions)),
            Points::upload(place.device, with_z_up(question.normals)), with_z_up(question.lights), "raster"};
}

class OwnLightsContestant : public LightsContestant {
public:
    OwnLightsContestant(const LightsQuestion& question, const Place& place, const Configuration& configuration,
                        Inputs inputs)
        : question_(question),
          place_(place),
          configuration_(configuration),
          technique_(make(configuration, place.device)),
          in_(std::move(inputs)),
          counts_(place.device, question.count()),
          sums_(place.device, 2 * question.count()) {}

    std::vector<std::uint32_t> bits() override {
        return run_light_table_to_host(*technique_, in_.triangles, in_.points, in_.lights, {.bits = true}, options())
            .bits;
    }
    RunTimes run() override {
        return time_run([&] {
            statistics_ = technique_->run_light_table(in_.triangles, in_.points, in_.lights,
                                                      {.counts = counts_.buffer(), .sums = sums_.buffer()}, options());
            place_.device.finish();
        });
    }
    std::vector<std::uint32_t> counts() const override {
        std::vector<std::uint32_t> counts;
        for (const float bits : counts_.read()) counts.push_back(std::bit_cast<std::uint32_t>(bits));
        return counts;
    }
    void describe(Row& row) const override {
        row.technique = configuration_.technique;
        row.settings = configuration_.settings;
        if (!in_.kind.empty()) row.settings.emplace_back("triangles", in_.kind);
        for (const TechniqueDescription& technique : techniques())
            if (technique.name == row.technique) row.exact = technique.exact;
        row.device = place_.device.description().name;
        row.driver = place_.device.description().driver_version;
        row.device_memory_bytes = statistics_.device_memory_bytes;
        row.counts = statistics_.counts;
    }

private:
    // A picture's points face by their camera's eye.
    RunOptions options() const {
        return {.facing = question_.picture ? Facing::automatic() : Facing::normals(in_.normals.positions())};
    }

    const LightsQuestion& question_;
    const Place& place_;
    Configuration configuration_;
    std::unique_ptr<Technique> technique_;
    Inputs in_;
    Visibility counts_, sums_;  ///< buffers of the right size
    Statistics statistics_;
};

// ---- By turns -------------------------------------------------------------------------------------------------------

struct Entered {
    LightsContestant* contestant = nullptr;
    Row row;
    std::vector<std::uint32_t> lit_of_point;  ///< by the bits
    std::vector<FrameTimes> runs;

    template <typename Work>
    void guarded(Work&& work) {
        if (!row.failed.empty()) return;
        try {
            work();
        } catch (const Error& error) {
            row.failed = error.what();
        }
    }
};

void keep_bits(const LightsQuestion& question, Entered& entered, std::vector<std::uint32_t>& first) {
    const std::vector<std::uint32_t> bits = entered.contestant->bits();
    if (first.empty()) first = bits;
    LightPairs& pairs = *entered.row.pairs;
    entered.row.mask_hash = hash_of(std::span<const std::uint32_t>(bits));
    entered.lit_of_point.assign(question.count(), 0);
    for (std::size_t word = 0; word < bits.size(); ++word) {
        const auto lit = static_cast<std::uint32_t>(std::popcount(bits[word]));
        const std::size_t point = word / question.words();
        entered.lit_of_point[point] += lit;
        if (question.shows_sky(point)) continue;
        pairs.lit += lit;
        pairs.differing += static_cast<std::uint64_t>(std::popcount(bits[word] ^ first[word]));
    }
}

void finish(Entered& entered) {
    entered.guarded([&] {
        if (entered.contestant->counts() != entered.lit_of_point)
            throw Error("a timed run counted other lights than the run that wrote the bits");
        entered.row.set_runs(std::move(entered.runs), false);
        entered.contestant->describe(entered.row);
    });
}

}  // namespace

bool is_terrain_scene(const NamedScene& scene) { return scene.name.starts_with("terrain"); }

LightsQuestion::LightsQuestion(const Place& place, const ManyLights& asked) : scene(place.scene) {
    const bool is_terrain = is_terrain_scene(scene), are_pixels = !asked.view.empty();
    if (are_pixels)
        points_of_pixels(*this, place, asked);
    else if (is_terrain)
        points_on_vertices(*this, asked.points);
    else
        points_on_faces(*this, asked.points);
    if (asked.columns > 1 && count() != 0) keep_columns(*this, asked.columns);
    make_lights(*this, asked.lights);
    row.scene = scene.name;
    row.view = are_pixels ? asked.view : is_terrain ? "vertices" : "faces";
    row.light = asked.lights;
    row.width = are_pixels ? asked.size.width : static_cast<std::uint32_t>(count());
    row.height = are_pixels ? asked.size.height : 1;
    row.triangles = scene.scene.triangle_count();
    row.mode = "moving";
    row.points_hash = hash_of(std::span<const float>(positions));
    std::vector<float> directions;
    for (const Light& light : lights.lights())
        directions.insert(directions.end(), light.xyzw.begin(), light.xyzw.end());
    const std::string columns =
        asked.columns > 1 ? fmt::format(", in one of {} columns", asked.columns) : std::string();
    row.pairs = LightPairs{count(),
                           lights.count(),
                           facing_pairs(*this),
                           0,
                           0,
                           are_pixels   ? "of pixels, on the eye's side"
                           : is_terrain ? "vertices, seed 1" + columns
                                        : "uniform by area on faces, outward, seed 1" + columns,
                           hash_of(std::span<const float>(directions))};
}

std::unique_ptr<LightsContestant> make_own_contestant(const LightsQuestion& question, const Place& place,
                                                      const Configuration& configuration) {
    return std::make_unique<OwnLightsContestant>(question, place, configuration, inputs_of(question, place));
}

std::unique_ptr<LightsContestant> make_raster_contestant(const LightsQuestion& question, const Place& place,
                                                         const Configuration& configuration) {
    return std::make_unique<OwnLightsContestant>(question, place, configuration, inputs_of_raster(question, place));
}

std::vector<Row> run_contestants(const LightsQuestion& question,
                                 std::span<const std::unique_ptr<LightsContestant>> contestants, const RunRule& rule) {
    std::vector<Entered> all;
    std::vector<std::uint32_t> first;
    for (const auto& contestant : contestants) {
        all.push_back({contestant.get(), question.row, {}, {}});
        all.back().guarded([&] { keep_bits(question, all.back(), first); });
    }
    first = {};
    const Clock clock;
    for (int run = 0; rule.goes_on(run, clock.elapsed_ms() / double(all.size())); ++run)
        for (Entered& entered : all)
            entered.guarded([&] {
                FrameTimes times;
                times.shadow = entered.contestant->run();
                entered.runs.push_back(times);
            });
    std::vector<Row> rows;
    for (Entered& entered : all) {
        finish(entered);
        rows.push_back(std::move(entered.row));
    }
    return rows;
}

}  // namespace gnomon::bench
