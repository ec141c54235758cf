// SPDX-License-Identifier: MIT
// Runs a fuzz target, without the fuzzer, on every file of a tar archive: the saved corpus as an ordinary test.
// usage: replay ARCHIVE (as tools/fuzz.sh --pack makes it)
#include <cstddef>
#include <cstdint>
#include <cstdio>
#include <cstdlib>
#include <fstream>
#include <iterator>
#include <string>
#include <vector>

extern "C" int LLVMFuzzerTestOneInput(const std::uint8_t* data, std::size_t size);

int main(int argument_count, char** arguments) {
    if (argument_count != 2) return std::fprintf(stderr, "usage: %s ARCHIVE\n", arguments[0]), 2;
    std::ifstream stream(arguments[1], std::ios::binary);
    const std::string archive{std::istreambuf_iterator<char>(stream), std::istreambuf_iterator<char>()};
    // POSIX ustar: a header of one block, the file in whole blocks, ..., zeros.
    constexpr std::size_t block = 512;
    std::size_t files = 0, at = 0;
    for (; at + block <= archive.size() && archive[at] != 0; ++files) {
        const std::string name = archive.substr(at, 100).c_str();
        const std::size_t size = std::strtoull(archive.substr(at + 124, 12).c_str(), nullptr, 8);
        const bool is_file = archive.compare(at + 257, 5, "ustar") == 0 && archive[at + 156] == '0';
        at += block;
        if (!is_file || size > archive.size() - at)
            return std::fprintf(stderr, "%s: %s is damaged, or no file\n", arguments[1], name.c_str()), 1;
        std::printf("%s\n", name.c_str());
        std::fflush(stdout);  // the last name printed is the one that ends the program
        // A copy of its own, so that AddressSanitizer sees reads past its end.
        const std::vector<std::uint8_t> bytes(archive.begin() + std::ptrdiff_t(at),
                                              archive.begin() + std::ptrdiff_t(at + size));
        LLVMFuzzerTestOneInput(bytes.data(), bytes.size());
        at += (size + block - 1) / block * block;
    }
    std::printf("%zu files\n", files);
    const bool is_whole = at + block <= archive.size();
    if (files == 0 || !is_whole) std::fprintf(stderr, "%s is no archive, or not a whole one\n", arguments[1]);
    return files == 0 || !is_whole;
}
