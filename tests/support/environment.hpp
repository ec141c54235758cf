// SPDX-License-Identifier: MIT
// Sets an environment variable for the time of a test.
#pragma once

#include <stdlib.h>  // setenv, unsetenv: POSIX, not in <cstdlib>

#include <optional>
#include <string>

namespace support {

/// Sets the variable for the object's lifetime, then restores the value from before.
class Environment {
public:
    Environment(const char* name, const std::string& value) : name_(name) {
        if (const char* before = getenv(name)) before_ = before;
        setenv(name, value.c_str(), 1);
    }
    ~Environment() {
        if (before_) setenv(name_, before_->c_str(), 1);
        if (!before_) unsetenv(name_);
    }
    Environment(const Environment&) = delete;
    Environment& operator=(const Environment&) = delete;

private:
    const char* name_;
    std::optional<std::string> before_;
};

}  // namespace support
