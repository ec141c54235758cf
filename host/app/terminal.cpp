// SPDX-License-Identifier: MIT
// Messages, numbers for people, and the progress line (a thread that wakes once a second until it is stopped).
#include "terminal.hpp"

#include <fmt/core.h>
#include <unistd.h>

#include <array>
#include <chrono>
#include <iostream>

#include <gnomon.hpp>
#include "cl/embedded_files.hpp"

namespace gnomon::app {
namespace {

const char* const clear_line = "\r\033[K";

void print_message(std::string_view kind, std::string_view sentence) {
    std::cerr << "gnomon: " << kind << ": " << sentence << '\n' << std::flush;
}

}  // namespace

void print_warning(std::string_view sentence) { print_message("warning", sentence); }

void print_note(std::string_view sentence) { print_message("note", sentence); }

void print_error(std::string_view sentence) { print_message("error", sentence); }

void print_result(std::string_view text) {
    std::cout << text << std::flush;
    if (!std::cout) throw Error("cannot write to the standard output: is the disk behind it full?");
}

std::string_view text_file(std::string_view name) {
    for (const EmbeddedFile& file : embedded_texts())
        if (file.path.ends_with(name)) return file.text;
    throw Error("no file " + std::string(name) + " was built into the command");
}

std::string bytes_for_people(std::uint64_t bytes) {
    constexpr std::array<const char*, 5> units{"B", "KiB", "MiB", "GiB", "TiB"};
    double amount = double(bytes);
    std::size_t unit = 0;
    while (amount >= 1024 && unit + 1 < units.size()) {
        amount /= 1024;
        ++unit;
    }
    return fmt::format("{:.{}f} {}", amount, unit == 0 ? 0 : 1, units[unit]);
}

ProgressLine::ProgressLine(std::string work, bool shown) : work_(std::move(work)) {
    if (!shown) return;
    const bool has_terminal = isatty(STDERR_FILENO) != 0;
    thread_ = std::jthread([this, has_terminal](std::stop_token stop) { has_terminal ? show(stop) : tell(stop); });
}

ProgressLine::~ProgressLine() = default;

bool ProgressLine::is_stopped_within(std::stop_token stop, int seconds) {
    std::unique_lock lock(mutex_);
    return wake_.wait_for(lock, stop, std::chrono::seconds(seconds), [&] { return stop.stop_requested(); });
}

void ProgressLine::tell(std::stop_token stop) {
    int seconds = 2;
    for (int next = seconds; !is_stopped_within(stop, next); next = seconds, seconds *= 2)
        std::cerr << fmt::format("gnomon: {} ... {} s\n", work_, seconds) << std::flush;
}

void ProgressLine::show(std::stop_token stop) {
    int seconds = 0;
    while (!is_stopped_within(stop, 1))
        std::cerr << clear_line << "gnomon: " << work_ << " ... " << ++seconds << " s" << std::flush;
    if (seconds > 0) std::cerr << clear_line << std::flush;
}

}  // namespace gnomon::app
