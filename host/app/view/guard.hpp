// SPDX-License-Identifier: MIT
// Who is answered. Another page of the browser can send requests to this machine, also by a name of its own that it
// lets point here (DNS rebinding), and another user of the machine can connect: none of them knows the token, and the
// Host and Origin of a request say which page sent it.
#pragma once

#include <string>
#include <string_view>

namespace gnomon::app {

/// 128 random bits as 32 hexadecimal digits. Throws Error if the machine gives none.
std::string random_token();

/// Compares in a time that depends on the lengths alone.
bool equals_in_constant_time(std::string_view a, std::string_view b);

/// Whether a header Host names this server: localhost, an address of numbers (which no DNS server can let point
/// elsewhere) or `own_name`, with any port, since ssh -L may give another one.
bool is_own_host(std::string_view host, std::string_view own_name);

/// Whether a header Origin, empty if there is none, is of the page that this server gave to who asks `host` for it.
bool is_own_origin(std::string_view origin, std::string_view host);

}  // namespace gnomon::app
