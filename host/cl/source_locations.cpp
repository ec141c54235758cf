// SPDX-License-Identifier: MIT
#include "source_locations.hpp"

#include <charconv>
#include <sstream>

namespace gnomon::cl {

namespace {

// The location of line `number`, counted from 1: FILE:LINE by the last #line "FILE" before it; empty if there is none.
std::string place_of(std::size_t wanted, const std::string& source) {
    std::istringstream lines(source);
    std::string line, file;
    std::size_t number = 0;  // of this line, in its file
    for (std::size_t at = 1; at <= wanted && std::getline(lines, line); ++at, ++number) {
        constexpr std::string_view directive = "#line ";
        if (!line.starts_with(directive)) continue;
        const std::size_t quote = line.find('"');
        number = std::stoul(line.substr(directive.size())) - 1;
        file = line.substr(quote + 1, line.rfind('"') - quote - 1);
    }
    return file.empty() ? "" : file + ":" + std::to_string(number - 1);
}

}  // namespace

std::string with_source_locations(const std::string& log, const std::string& source) {
    constexpr std::string_view whole = "<kernel>:";
    std::string out;
    std::size_t done = 0;
    for (std::size_t at = log.find(whole); at != std::string::npos; at = log.find(whole, done)) {
        std::size_t number = 0;
        const char* const first = log.data() + at + whole.size();
        const char* const end = std::from_chars(first, log.data() + log.size(), number).ptr;
        const std::string place = place_of(number, source);
        out.append(log, done, at - done);
        done = std::size_t(end - log.data());
        out += place.empty() ? log.substr(at, done - at) : place;
    }
    return out.append(log, done);
}

}  // namespace gnomon::cl
