// SPDX-License-Identifier: MIT
// The command gnomon. main() catches every exception: a failure is one sentence on stderr and an exit code, 0 done, 1 a
// failure, 2 a wrong command line.
#include <exception>
#include <new>
#include <string>
#include <vector>

#include <gnomon.hpp>
#include "options.hpp"
#include "output_files.hpp"
#include "terminal.hpp"

namespace gnomon::app {
namespace {

int run(const std::vector<std::string>& arguments) {
    try {
        remove_temporaries_on_interrupt();
        parse_command_line(arguments)();
        return 0;
    } catch (const UsageError& error) {
        print_error(error.what());
        return 2;
    } catch (const OutOfDeviceMemory& error) {
        print_error("out of device memory: " + std::string(error.what()));
    } catch (const std::bad_alloc&) {
        print_error("this machine has too little memory for the run: try a smaller --size or scene");
    } catch (const std::exception& error) {
        print_error(error.what());
    } catch (...) {
        print_error("something failed without saying what: please report it with the command line");
    }
    return 1;
}

}  // namespace
}  // namespace gnomon::app

int main(int argc, char** argv) {
    gnomon::add_rivals();
    // A program can be started without even its own name.
    std::vector<std::string> arguments(argv, argv + argc);
    if (arguments.empty()) arguments.emplace_back("gnomon");
    return gnomon::app::run(arguments);
}
