// SPDX-License-Identifier: MIT
#include "guard.hpp"

#include <arpa/inet.h>
#include <fmt/core.h>
#include <sys/random.h>

#include <array>

#include <gnomon/device.hpp>

namespace gnomon::app {
namespace {

/// "[::1]:8000" without brackets and port, nothing if it is malformed.
std::string name_of(std::string_view host) {
    std::size_t end = host.find(':');
    std::string_view name = host.substr(0, end);
    if (host.starts_with('[')) {
        end = host.find(']');
        if (end == std::string_view::npos) return {};
        name = host.substr(1, end - 1);
        ++end;
    }
    if (end != std::string_view::npos && end < host.size()) {
        const std::string_view port = host.substr(end);
        const bool is_port = port.size() > 1 && port.size() <= 6 && port[0] == ':' &&
                             port.find_first_not_of("0123456789", 1) == std::string_view::npos;
        if (!is_port) return {};
    }
    return std::string(name);
}

bool is_numeric(const std::string& name) {
    if (name.find('\0') != std::string::npos) return false;  // inet_pton would read what stands before it alone
    std::array<unsigned char, sizeof(in6_addr)> bytes{};
    return inet_pton(AF_INET, name.c_str(), bytes.data()) == 1 || inet_pton(AF_INET6, name.c_str(), bytes.data()) == 1;
}

}  // namespace

std::string random_token() {
    std::array<unsigned char, 16> bytes{};
    if (getrandom(bytes.data(), bytes.size(), 0) != ssize_t(bytes.size()))
        throw Error("the machine gives no random numbers for the page's token");
    std::string token;
    for (const unsigned char byte : bytes) token += fmt::format("{:02x}", byte);
    return token;
}

bool equals_in_constant_time(std::string_view a, std::string_view b) {
    if (a.size() != b.size()) return false;
    unsigned difference = 0;
    for (std::size_t i = 0; i < a.size(); ++i) difference |= unsigned(a[i] ^ b[i]);
    return difference == 0;
}

bool is_own_host(std::string_view host, std::string_view own_name) {
    const std::string name = name_of(host);
    return !name.empty() && (name == "localhost" || name == own_name || is_numeric(name));
}

bool is_own_origin(std::string_view origin, std::string_view host) {
    return origin.empty() || origin == "http://" + std::string(host);
}

}  // namespace gnomon::app
