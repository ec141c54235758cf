// SPDX-License-Identifier: MIT
#include "thread_table.hpp"

#include <fmt/core.h>
#include <spawn.h>
#include <sys/wait.h>
#include <unistd.h>
#include <algorithm>
#include <array>
#include <cstdio>
#include <filesystem>
#include <fstream>
#include <iterator>
#include <map>
#include <nlohmann/json.hpp>
#include <stdexcept>

extern char** environ;

namespace gnomon::bench {
namespace {

using Json = nlohmann::ordered_json;

std::string row_name(const Json& row) {
    std::string name = fmt::format("{} {}.{} {}x{}", row.at("scene").get<std::string>(),
                                   row.at("view").get<std::string>(), row.at("light").get<std::string>(),
                                   row.at("width").get<unsigned>(), row.at("height").get<unsigned>());
    return fmt::format("{} {} ({})", name, row.at("technique").get<std::string>(), row.at("mode").get<std::string>());
}

// The medians of a row's parts, then its stages.
std::vector<std::pair<std::string, double>> parts_of(const Json& row) {
    constexpr std::array<std::pair<const char*, const char*>, 5> keys = {{{"build", "build_ms"},
                                                                          {"camera", "camera_ms"},
                                                                          {"shadow", "ms"},
                                                                          {"shade", "shade_ms"},
                                                                          {"frame", "frame_ms"}}};
    std::vector<std::pair<std::string, double>> parts;
    for (const auto& [name, key] : keys)
        if (row.contains(key)) parts.emplace_back(name, row[key].at("median").get<double>());
    if (row.contains("stages_ms"))
        for (const auto& [stage, ms] : row["stages_ms"].items()) parts.emplace_back("  " + stage, ms.get<double>());
    return parts;
}

// A rival's settings hold its number of threads, so rows are known by their place among those of the same name.
std::map<std::string, double> times_by_name(const Json& report) {
    std::map<std::string, int> seen;
    std::map<std::string, double> times;
    for (const Json& row : report.at("rows")) {
        const std::string name = row_name(row), place = fmt::format("{} {}", name, seen[name]++);
        for (const auto& [part, ms] : parts_of(row)) times[place + '\n' + part] = ms;
    }
    return times;
}

// The command line without --threads and --json, and with these of one run.
std::vector<std::string> command_of(std::span<char* const> command_line, unsigned threads, const std::string& json) {
    std::vector<std::string> command;
    for (std::size_t i = 0; i < command_line.size(); ++i) {
        const std::string word = command_line[i];
        if (word == "--threads" || word == "--json")
            ++i;
        else if (!word.starts_with("--threads=") && !word.starts_with("--json="))
            command.push_back(word);
    }
    command.insert(command.end(), {"--threads", std::to_string(threads), "--json", json});
    return command;
}

int exit_code_of(const std::vector<std::string>& command) {
    std::vector<char*> words;
    for (const std::string& word : command) words.push_back(const_cast<char*>(word.c_str()));
    words.push_back(nullptr);
    pid_t process = 0;
    int status = 0;
    if (posix_spawn(&process, "/proc/self/exe", nullptr, nullptr, words.data(), environ) != 0 ||
        waitpid(process, &status, 0) != process)
        throw std::runtime_error("cannot start this program once more");
    return WIFEXITED(status) ? WEXITSTATUS(status) : 1;
}

std::string json_of(std::span<char* const> command_line) {
    for (std::size_t i = 0; i < command_line.size(); ++i) {
        const std::string word = command_line[i];
        if (word == "--json" && i + 1 < command_line.size()) return command_line[i + 1];
        if (word.starts_with("--json=")) return word.substr(7);
    }
    return {};
}

void print_table(std::span<const unsigned> threads, const std::vector<ThreadTimes>& table) {
    std::string row;
    for (const ThreadTimes& times : table) {
        if (times.row != row) {
            std::printf("%s\n    %-26s", times.row.c_str(), "ms on threads:");
            for (const unsigned count : threads) std::printf(" %9u", count);
            std::printf("      gain\n");
        }
        row = times.row;
        std::printf("    %-26s", times.part.c_str());
        for (const double ms : times.ms) std::printf(" %9.3f", ms);
        std::printf(" %9.2f\n", times.ms.front() / times.ms.back());
    }
}

}  // namespace

std::vector<ThreadTimes> thread_times(std::span<const std::string> reports) {
    std::vector<std::map<std::string, double>> others;
    for (const std::string& report : reports) others.push_back(times_by_name(Json::parse(report)));
    std::vector<ThreadTimes> table;
    std::map<std::string, int> seen;
    const Json first = Json::parse(reports.front());
    for (const Json& row : first.at("rows")) {
        const std::string name = row_name(row), place = fmt::format("{} {}", name, seen[name]++);
        const std::string settings = row.at("settings").get<std::string>();
        for (const auto& [part, ms] : parts_of(row)) {
            ThreadTimes times{settings.empty() ? name : name + ' ' + settings, part, {}};
            for (const auto& other : others)
                if (const auto found = other.find(place + '\n' + part); found != other.end())
                    times.ms.push_back(found->second);
            const bool took_time = std::ranges::all_of(times.ms, [](double time) { return time > 0; });
            if (times.ms.size() == reports.size() && took_time) table.push_back(std::move(times));
        }
    }
    return table;
}

int run_with_each(std::span<const unsigned> threads, std::span<char* const> command_line) {
    const std::string given = json_of(command_line);
    const std::string temporary =
        (std::filesystem::temp_directory_path() / fmt::format("gnomon_bench_{}.json", getpid())).string();
    std::vector<std::string> reports;
    int worst = 0;
    for (const unsigned count : threads) {
        const std::string file = fmt::format("{}.{}", given.empty() ? temporary : given, count);
        std::printf("%u threads\n", count);
        std::fflush(stdout);
        worst = std::max(worst, exit_code_of(command_of(command_line, count, file)));
        std::ifstream stream(file);
        if (!stream) return std::max(worst, 1);
        reports.emplace_back(std::istreambuf_iterator<char>(stream), std::istreambuf_iterator<char>());
        if (given.empty()) std::filesystem::remove(file);
    }
    print_table(threads, thread_times(reports));
    return worst;
}

}  // namespace gnomon::bench
