// SPDX-License-Identifier: MIT
// The destination of a picture's bytes, as an interface for libraries that an exception must not cross.
#pragma once

#include <cstddef>

namespace gnomon::app {

class ByteSink {
public:
    virtual ~ByteSink() = default;
    /// Writes at the position and returns how many bytes were written. A failure is kept for check().
    virtual std::size_t write(const void* bytes, std::size_t count) noexcept = 0;
    virtual bool seek(std::size_t position) noexcept = 0;
    virtual std::size_t position() const noexcept = 0;
    /// Throws Error with the reason if anything failed so far.
    virtual void check() const = 0;
};

}  // namespace gnomon::app
