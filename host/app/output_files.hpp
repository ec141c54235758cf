// SPDX-License-Identifier: MIT
// Files that appear whole or not at all. Opening a file checks that it can be written, so files are opened before any
// long work: a temporary is made beside the target (".gnomon-PID-N.partial"), filled, and renamed over the target by
// commit(). Without commit() the temporary is removed, also when an interrupt (SIGINT, SIGTERM, SIGHUP) ends the
// program. A target that is no regular file (a device, a pipe) is written directly, as it cannot be replaced.
#pragma once

#include <cstddef>
#include <filesystem>
#include <list>
#include <string>
#include <vector>

namespace gnomon::app {

/// The destination of a picture's bytes, as an interface for libraries that an exception must not cross.
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

/// Throws Error for an input that could not be read, with the reason.
[[noreturn]] void refuse_input(const std::filesystem::path& file);

/// The folder of temporary files: TMPDIR's, or else another that can be written. Throws Error if there is none.
std::filesystem::path temporary_folder();

class OutputFile final : public ByteSink {
public:
    /// Throws Error if `target` cannot be written.
    explicit OutputFile(std::filesystem::path target);
    ~OutputFile() override;
    OutputFile(const OutputFile&) = delete;
    OutputFile& operator=(const OutputFile&) = delete;

    const std::filesystem::path& target() const { return target_; }
    /// The target after all links.
    const std::filesystem::path& resolved() const { return resolved_; }
    bool is_direct() const { return temporary_.empty(); }

    std::size_t write(const void* bytes, std::size_t count) noexcept override;
    bool seek(std::size_t position) noexcept override;
    std::size_t position() const noexcept override { return position_; }
    void check() const override;

    /// write(), then check().
    void write_all(const void* bytes, std::size_t count) {
        write(bytes, count);
        check();
    }

    /// Closes the file and renames it to the target. Throws Error, like check().
    void commit();

private:
    void close() noexcept;

    std::filesystem::path target_;
    std::filesystem::path resolved_;
    std::filesystem::path temporary_;  // empty if written directly
    int descriptor_ = -1;
    int interrupt_slot_ = -1;
    int failure_ = 0;  // the first errno
    std::size_t position_ = 0;
};

/// The outputs of one run: different files, and none of them is the scene's file.
class OutputFiles {
public:
    /// Opens one more output, which lives as long as this object. Throws Error.
    OutputFile& open(const std::filesystem::path& target);
    /// From here on, no output may be this file.
    void protect(const std::filesystem::path& input);
    /// Commits all outputs, in the order they were opened.
    void commit();

private:
    std::list<OutputFile> files_;
    std::vector<std::filesystem::path> protected_;
};

/// Installs the handlers that remove temporaries when the program is interrupted. Call once, at the start.
void remove_temporaries_on_interrupt();

}  // namespace gnomon::app
