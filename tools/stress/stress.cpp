// SPDX-License-Identifier: MIT
// stress: every case that is known to break shadows, millions of points each, against the exact oracle. Prints a line
// per case and writes the table. Exit code 0: nothing wrong; 1: something was, or something failed.
#include <CLI/CLI.hpp>
#include <chrono>
#include <cstdio>
#include <fstream>
#include <iostream>

#include "embree.hpp"
#include "report.hpp"

namespace {

struct Options {
    stress::CaseOptions cases;
    stress::RunOptions run;
    std::string device, markdown_file, only, without;
    bool without_embree = false, exact_path = false, list = false;
};

bool is_wanted(const stress::Case& a_case, const Options& options) {
    const bool is_named = a_case.name.find(options.only) != std::string::npos;
    return is_named && (options.without.empty() || a_case.name.find(options.without) == std::string::npos);
}

stress::Report report_of(const Options& options, const std::string& command) {
    const auto start = std::chrono::steady_clock::now();
    const gnomon::Device device(options.device);
    stress::Report report{command, device.description().name, device.description().driver_version, options.run, {}, {},
                          {}};
    const bool with_embree = !options.without_embree && !stress::embree_version().empty();
    for (const stress::Case& a_case : stress::all_cases(options.cases)) {
        if (!is_wanted(a_case, options)) continue;
        stress::Judge judge(device, with_embree);
        report.cases.push_back(stress::run_case(a_case, device, judge, options.run));
        std::cout << stress::line_of(report.cases.back()) << std::endl;
    }
    if (options.exact_path) report.exact_path = stress::exact_path_costs(options.device);
    report.seconds = std::chrono::duration<double>(std::chrono::steady_clock::now() - start).count();
    return report;
}

int run(const Options& options, const std::string& command) {
    if (options.list) {
        for (const stress::Case& a_case : stress::all_cases(options.cases))
            std::printf("%-32s %s\n", a_case.name.c_str(), a_case.idea.c_str());
        return 0;
    }
    const stress::Report report = report_of(options, command);
    const stress::Tally sum = report.sum();
    std::cout << stress::line_of({"all", {}, sum}) << '\n';
    if (!options.markdown_file.empty()) {
        std::ofstream stream(options.markdown_file);
        stream << markdown(report);
        if (!stream.flush()) throw gnomon::Error("cannot write " + options.markdown_file);
    }
    return sum.is_right() ? 0 : 1;
}

}  // namespace

int main(int argc, char** argv) {
    gnomon::add_rivals();
    Options options;
    CLI::App app{"Asks gnomon what is known to break shadows, and an exact oracle whether it was right."};
    app.add_option("--points", options.run.points, "points of an ordinary case")
        ->capture_default_str()
        ->check(CLI::Range(1, 1'000'000'000));
    app.add_option("--seed", options.run.seed, "another seed, other scenes and points")->capture_default_str();
    app.add_option("--device", options.device, "as in gnomon devices");
    app.add_option("--only", options.only, "only cases whose name contains this");
    app.add_option("--without", options.without, "no cases whose name contains this");
    app.add_option("--slivers", options.cases.slivers, "slivers through one texel")
        ->capture_default_str()
        ->check(CLI::Range(10, 20'000'000));
    app.add_option("--longest-side", options.cases.longest_side, "pixels of the large view")
        ->capture_default_str()
        ->check(CLI::Range(64, 16384));
    app.add_option("--markdown", options.markdown_file, "write the table there");
    app.add_flag("--without-embree", options.without_embree, "do not ask Embree");
    app.add_flag("--exact-path", options.exact_path, "also measure what the exact path costs");
    app.add_flag("--list", options.list, "list the cases");
    try {
        app.parse(argc, argv);
    } catch (const CLI::ParseError& error) {
        return app.exit(error) == 0 ? 0 : 2;
    }
    options.cases.seed = options.run.seed;
    std::string command = "build/tools/stress";
    for (int i = 1; i < argc; ++i) {
        const std::string argument = argv[i];
        const bool is_quoted = argument.find(' ') != std::string::npos;
        command.append(is_quoted ? " '" : " ").append(argument).append(is_quoted ? "'" : "");
    }
    try {
        return run(options, command);
    } catch (const std::exception& error) {
        std::cerr << "stress: error: " << error.what() << '\n';
        return 1;
    }
}
