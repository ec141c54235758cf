// SPDX-License-Identifier: MIT
// The outline of gnomon view: view(), at the end, reads top to bottom.
#include <fcntl.h>
#include <fmt/core.h>
#include <malloc.h>
#include <spawn.h>
#include <unistd.h>

#include <array>
#include <cstdlib>
#include <fstream>

#include "../output_files.hpp"
#include "../terminal.hpp"
#include "server.hpp"

namespace gnomon::app {
namespace {

namespace fs = std::filesystem;

bool is_loopback(const std::string& host) { return host == "localhost" || host == "::1" || host.starts_with("127."); }

std::string name_of_machine() {
    std::array<char, 256> name{};
    return gethostname(name.data(), name.size() - 1) == 0 ? name.data() : "HOST";
}

/// A page of this user alone that leads to the address. A browser's own arguments would show the token to all users.
fs::path write_pointer(const std::string& address) {
    const char* const own = std::getenv("XDG_RUNTIME_DIR");
    std::string path = (own != nullptr ? fs::path(own) : temporary_folder()) / "gnomon-view-XXXXXX.html";
    const int file = mkstemps(path.data(), int(std::string_view(".html").size()));
    if (file < 0) return {};
    const std::string html = "<!DOCTYPE html><meta http-equiv=\"refresh\" content=\"0;url=" + address + "\">";
    const bool is_written = ::write(file, html.data(), html.size()) == ssize_t(html.size());
    ::close(file);
    if (is_written) return path;
    fs::remove(path);
    return {};
}

/// Starts the user's browser, where there is a screen.
void open_browser(const fs::path& file) {
    if (std::getenv("DISPLAY") == nullptr && std::getenv("WAYLAND_DISPLAY") == nullptr) return;
    std::string program = "xdg-open", argument = file.string();
    std::array<char*, 3> arguments{program.data(), argument.data(), nullptr};
    posix_spawn_file_actions_t quietly;
    posix_spawn_file_actions_init(&quietly);
    for (const int stream : {STDIN_FILENO, STDOUT_FILENO, STDERR_FILENO})
        posix_spawn_file_actions_addopen(&quietly, stream, "/dev/null", O_RDWR, 0);
    pid_t browser = 0;
    posix_spawnp(&browser, program.c_str(), &quietly, nullptr, arguments.data(), environ);
    posix_spawn_file_actions_destroy(&quietly);
}

/// Pictures and the device's buffers go back to the machine when they are freed, instead of to the threads' own pools.
void return_memory_at_once() {
    constexpr int large = 1 << 18, pools = 2;
    mallopt(M_MMAP_THRESHOLD, large);
    mallopt(M_ARENA_MAX, pools);
}

}  // namespace

void view(const PageOptions& options) {
    return_memory_at_once();
    if (options.scene && !std::ifstream(*options.scene)) refuse_input(*options.scene);
    Worker worker(options);
    PageServer server(options, worker);
    if (!is_loopback(options.host))
        print_warning("who can reach " + options.host + " can see the scene, once he knows the address below");
    print_result(server.address() + "\n");
    if (!options.quiet)
        print_result(
            fmt::format("from another machine: ssh -N -L {0}:127.0.0.1:{0} {1}, then the same address there\n"
                        "Ctrl-C ends it\n",
                        server.port(), name_of_machine()));
    const fs::path pointer = options.stays_closed ? fs::path() : write_pointer(server.address());
    if (!pointer.empty()) open_browser(pointer);
    server.serve([pointer] {
        if (!pointer.empty()) fs::remove(pointer);
    });
}

}  // namespace gnomon::app
