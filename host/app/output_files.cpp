// SPDX-License-Identifier: MIT
// Temporaries that are renamed over their targets. Plain POSIX calls: streams hide the reason of a failure, and the
// error names the reason.
#include "output_files.hpp"

#include <fcntl.h>
#include <fmt/core.h>
#include <signal.h>
#include <sys/stat.h>
#include <unistd.h>

#include <array>
#include <atomic>
#include <cerrno>
#include <cstdlib>
#include <cstring>
#include <utility>

#include <gnomon.hpp>

namespace gnomon::app {
namespace {

namespace fs = std::filesystem;

// Temporaries are removed on an interrupt. A signal handler may use neither the heap nor a lock, so the names are in
// fixed slots. One slot per output and run is enough (there are five outputs); a file without a slot would only not be
// removed on interrupt.
std::array<std::atomic<char*>, 16> interrupt_slots;
static_assert(std::atomic<char*>::is_always_lock_free);

extern "C" void remove_temporaries_and_end(int signal_number) {
    for (const auto& slot : interrupt_slots)
        if (const char* const path = slot.load()) ::unlink(path);
    // The action is the default again (SA_RESETHAND): the shell then learns that a signal ended the program.
    ::raise(signal_number);
}

int take_interrupt_slot(const fs::path& path) {
    char* const name = ::strdup(path.c_str());
    for (std::size_t i = 0; i < interrupt_slots.size(); ++i) {
        char* expected = nullptr;
        if (interrupt_slots[i].compare_exchange_strong(expected, name)) return int(i);
    }
    std::free(name);
    return -1;
}

void release_interrupt_slot(int slot) {
    if (slot >= 0) std::free(interrupt_slots[std::size_t(slot)].exchange(nullptr));
}

[[noreturn]] void fail(const fs::path& target, const std::string& reason) {
    throw Error("cannot write " + target.string() + ": " + reason);
}

std::string reason_of(int error) {
    return error == ENOSPC ? "no space is left on its disk" : std::generic_category().message(error);
}

/// The folder of the temporary. Throws, with the folder as the user wrote it, if there is none.
fs::path folder_of(const fs::path& target, const fs::path& resolved) {
    const fs::path folder = resolved.parent_path();
    const std::string name = "the folder " + target.parent_path().string();
    std::error_code ignored;
    if (!fs::exists(folder, ignored)) fail(target, name + " does not exist, make it first");
    if (!fs::is_directory(folder, ignored)) fail(target, name + " is a file");
    return folder;
}

/// Makes a new file in `folder`; returns its descriptor and sets its name and slot. Its permissions are those that
/// open() gives under the user's umask; mkstemp would give others. The slot is taken before the file is there, so that
/// no interrupt leaves the file. A file that is already there has this process's number: it is its own, or of a dead
/// one.
int make_temporary(const fs::path& folder, fs::path& temporary, int& slot) {
    for (int attempt = 0;; ++attempt) {
        temporary = folder / fmt::format(".gnomon-{}-{}.partial", ::getpid(), attempt);
        slot = take_interrupt_slot(temporary);
        const int descriptor = ::open(temporary.c_str(), O_WRONLY | O_CREAT | O_EXCL | O_CLOEXEC, 0666);
        if (descriptor >= 0) return descriptor;
        const int error = errno;
        release_interrupt_slot(std::exchange(slot, -1));
        errno = error;
        if (error != EEXIST) return descriptor;
    }
}

}  // namespace

void remove_temporaries_on_interrupt() {
    // No handler for SIGABRT: the LLVM in OpenCL drivers replaces it. If a driver aborts, a hidden temporary stays.
    for (const int signal_number : {SIGINT, SIGTERM, SIGHUP}) {
        struct sigaction action {};
        if (::sigaction(signal_number, nullptr, &action) != 0 || action.sa_handler == SIG_IGN) continue;
        action = {};
        action.sa_handler = remove_temporaries_and_end;
        action.sa_flags = int(SA_RESETHAND | SA_NODEFER);
        ::sigaction(signal_number, &action, nullptr);
    }
}

void refuse_input(const fs::path& file) {
    const int error = errno;
    std::error_code ignored;
    const fs::file_status status = fs::status(file, ignored);
    const std::string reason = status.type() == fs::file_type::not_found ? "it does not exist"
                               : fs::is_directory(status)                ? "it is a folder"
                               : ::access(file.c_str(), R_OK) != 0       ? reason_of(errno)
                                                                         : reason_of(error);
    throw Error("cannot read " + file.string() + ": " + reason);
}

fs::path temporary_folder() {
    const char* const named = std::getenv("TMPDIR");
    for (const fs::path folder : {named != nullptr ? named : "", "/tmp", "/var/tmp", "/dev/shm"}) {
        std::error_code ignored;
        if (fs::is_directory(folder, ignored) && ::access(folder.c_str(), W_OK | X_OK) == 0) return folder;
    }
    throw Error("no folder for temporary files can be written, as /tmp and that of TMPDIR: set TMPDIR to one");
}

OutputFile::OutputFile(fs::path target) : target_(std::move(target)), resolved_(target_) {
    struct stat existing {};
    const bool exists = ::stat(target_.c_str(), &existing) == 0;
    if (exists && S_ISDIR(existing.st_mode)) fail(target_, "it is a folder");
    if (exists && ::access(target_.c_str(), W_OK) != 0) fail(target_, reason_of(errno));
    if (exists && !S_ISREG(existing.st_mode)) {
        descriptor_ = ::open(target_.c_str(), O_WRONLY | O_CLOEXEC);
        if (descriptor_ < 0) fail(target_, reason_of(errno));
        return;
    }
    std::error_code unresolved;  // on failure the path is unchanged, and opening it gives the error
    resolved_ = fs::absolute(target_);
    if (fs::path canonical = fs::weakly_canonical(resolved_, unresolved); !unresolved) resolved_ = std::move(canonical);
    descriptor_ = make_temporary(folder_of(target_, resolved_), temporary_, interrupt_slot_);
    if (descriptor_ < 0) {
        temporary_.clear();
        fail(target_, reason_of(errno));
    }
    if (exists) ::fchmod(descriptor_, existing.st_mode & 07777);
}

OutputFile::~OutputFile() {
    close();
    if (!temporary_.empty()) ::unlink(temporary_.c_str());
    release_interrupt_slot(interrupt_slot_);
}

std::size_t OutputFile::write(const void* bytes, std::size_t count) noexcept {
    std::size_t written = 0;
    while (written < count && failure_ == 0) {
        const ssize_t step = ::write(descriptor_, static_cast<const char*>(bytes) + written, count - written);
        if (step >= 0)
            written += std::size_t(step);
        else if (errno != EINTR)
            failure_ = errno;
    }
    position_ += written;
    return written;
}

bool OutputFile::seek(std::size_t position) noexcept {
    if (position == position_) return true;  // also true for a file without positions, such as a pipe
    if (::lseek(descriptor_, off_t(position), SEEK_SET) < 0) {
        if (failure_ == 0) failure_ = errno;
        return false;
    }
    position_ = position;
    return true;
}

void OutputFile::check() const {
    if (failure_ != 0) fail(target_, reason_of(failure_));
}

void OutputFile::close() noexcept {
    if (descriptor_ < 0) return;
    if (::close(descriptor_) != 0 && failure_ == 0) failure_ = errno;
    descriptor_ = -1;
}

void OutputFile::commit() {
    close();
    check();
    if (temporary_.empty()) return;
    if (::rename(temporary_.c_str(), resolved_.c_str()) != 0) fail(target_, reason_of(errno));
    temporary_.clear();
}

void OutputFiles::protect(const fs::path& input) { protected_.push_back(input); }

OutputFile& OutputFiles::open(const fs::path& target) {
    OutputFile& file = files_.emplace_back(target);
    if (file.is_direct()) return file;
    std::error_code ignored;
    for (const fs::path& input : protected_)
        if (fs::equivalent(file.resolved(), input, ignored)) fail(target, "it is a file that this run reads");
    for (const OutputFile& other : files_)
        if (&other != &file && other.resolved() == file.resolved())
            fail(target, "another output has the same name, give each its own");
    return file;
}

void OutputFiles::commit() {
    for (OutputFile& file : files_) file.commit();
}

}  // namespace gnomon::app
