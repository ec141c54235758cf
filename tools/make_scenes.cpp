// SPDX-License-Identifier: MIT
// make_scenes: writes the scenes that tests, benchmark and README share, as glTF 2.0 binary files. The same name, size
// and seed give the same bytes on every machine.
#include <fmt/core.h>
#include <CLI/CLI.hpp>
#include <algorithm>
#include <cstdio>
#include <exception>
#include <filesystem>
#include <optional>
#include <string>

#include "make_scenes/recipes.hpp"

namespace {

using namespace gnomon::make_scenes;

struct Arguments {
    std::string name, output, all_folder;
    std::optional<std::int64_t> triangles, seed;  // signed, so that -5 is found out of range and not taken for 2^64 - 5
    bool list = false;
};

void print_list() {
    for (const Recipe& recipe : recipes()) {
        std::string size = "fixed size";
        if (recipe.default_triangles > 0) {
            size = fmt::format("{} triangles, --triangles {} to {}", recipe.default_triangles, recipe.fewest_triangles,
                               recipe.max_triangles);
        }
        std::printf("%-26s %.*s (%s)\n", std::string(recipe.name).c_str(), static_cast<int>(recipe.idea.size()),
                    recipe.idea.data(), size.c_str());
    }
}

const Recipe& find_recipe(const std::string& name) {
    const auto found = std::ranges::find(recipes(), name, &Recipe::name);
    if (found == recipes().end()) throw MakeError("there is no scene '" + name + "'; --list shows their names");
    return *found;
}

Request request_for(const Recipe& recipe, const Arguments& arguments) {
    const std::string name(recipe.name);
    if (arguments.seed && !recipe.has_seed) {
        throw MakeError("nothing in the scene '" + name + "' is random; leave out --seed");
    }
    Request request{recipe.default_triangles, static_cast<std::uint64_t>(arguments.seed.value_or(1))};
    if (!arguments.triangles) return request;
    if (recipe.default_triangles == 0) {
        throw MakeError("the scene '" + name + "' has a fixed size; leave out --triangles");
    }
    const std::int64_t wanted = *arguments.triangles;
    if (wanted < recipe.fewest_triangles || wanted > recipe.max_triangles) {
        throw MakeError(fmt::format("--triangles {} is out of range; the scene '{}' takes {} to {}", wanted, name,
                                    recipe.fewest_triangles, recipe.max_triangles));
    }
    request.triangles = static_cast<std::uint64_t>(wanted);
    return request;
}

void write_scene(const Recipe& recipe, const Request& request, const std::filesystem::path& file) {
    Scene scene = recipe.make(request);
    scene.name = recipe.name;
    write_glb(scene, file);
    const auto count = static_cast<unsigned long long>(scene.triangle_count());
    std::printf("%s: %llu triangle%s\n", file.string().c_str(), count, count == 1 ? "" : "s");
}

void write_all(const std::filesystem::path& folder) {
    std::error_code error;
    std::filesystem::create_directories(folder, error);
    if (error) throw MakeError("cannot make the folder '" + folder.string() + "': " + error.message());
    for (const Recipe& recipe : recipes()) {
        if (!recipe.is_committed) continue;
        write_scene(recipe, {recipe.default_triangles, 1}, folder / (std::string(recipe.name) + ".glb"));
    }
}

void run(const Arguments& arguments) {
    if (arguments.list) {
        print_list();
    } else if (!arguments.all_folder.empty()) {
        if (!arguments.name.empty() || !arguments.output.empty() || arguments.triangles || arguments.seed) {
            throw MakeError("--all writes every small scene as it is; give it a folder and nothing else");
        }
        write_all(arguments.all_folder);
    } else {
        if (arguments.name.empty()) throw MakeError("name a scene to make, or use --list or --all FOLDER");
        const Recipe& recipe = find_recipe(arguments.name);
        if (arguments.output.empty()) throw MakeError("say where to write the scene with -o FILE.glb");
        write_scene(recipe, request_for(recipe, arguments), arguments.output);
    }
}

}  // namespace

int main(int argc, char** argv) {
    Arguments arguments;
    CLI::App app{"Makes the scenes of gnomon: the same bytes on every machine."};
    app.add_option("name", arguments.name, "the scene to make (--list shows them)");
    app.add_option("-o,--output", arguments.output, "the file to write (.glb)");
    app.add_option("--triangles", arguments.triangles, "about how many triangles, for scenes that come in sizes");
    app.add_option("--seed", arguments.seed, "chooses another scene of the same kind, where chance plays a part (1)");
    app.add_option("--all", arguments.all_folder, "writes all small scenes into this folder");
    app.add_flag("--list", arguments.list, "lists the scenes");
    try {
        app.parse(argc, argv);
        run(arguments);
    } catch (const CLI::ParseError& error) {
        if (error.get_exit_code() == 0) return app.exit(error);
        std::fprintf(stderr, "make_scenes: %s\n", error.what());
        return 2;
    } catch (const MakeError& error) {
        std::fprintf(stderr, "make_scenes: %s\n", error.what());
        return 1;
    } catch (const std::bad_alloc&) {
        std::fprintf(stderr, "make_scenes: not enough memory for this scene; ask for fewer triangles\n");
        return 1;
    }
    return 0;
}
