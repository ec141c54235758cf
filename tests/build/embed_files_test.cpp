// SPDX-License-Identifier: MIT
// Embedded files arrive byte for byte, whatever is in them. nasty.bin holds what text tools trip over: semicolons and
// brackets (CMake lists), backslashes, quotes, raw-string ends, trigraphs, CR, NUL, bytes that are no UTF-8, and no
// line end at its end.
#include <gtest/gtest.h>

#include <fstream>
#include <iterator>
#include <string>

#include "cl/embedded_files.hpp"

namespace {

std::string bytes_of(const std::string& path_in_tree) {
    std::ifstream file(std::string(GNOMON_ROOT "/") + path_in_tree, std::ios::binary);
    EXPECT_TRUE(file) << path_in_tree;
    return {std::istreambuf_iterator<char>(file), {}};
}

TEST(EmbedFiles, KeepsPathsAndOrder) {
    const auto files = gnomon::embedded_kernels();
    ASSERT_EQ(files.size(), 2u);
    EXPECT_EQ(files[0].path, "tests/build/nasty.bin");
    EXPECT_EQ(files[1].path, "tests/build/empty.bin");
}

TEST(EmbedFiles, KeepsEveryByte) {
    for (const auto& file : gnomon::embedded_kernels()) EXPECT_EQ(file.text, bytes_of(std::string(file.path)));
}

// The comparison above is worth something only while the file still has its sting.
TEST(EmbedFiles, NastyFileIsStillNasty) {
    const std::string text = bytes_of("tests/build/nasty.bin");
    for (const std::string& sting : {std::string("\r\n"), std::string("\0", 1), std::string("\xff\xfe"),
                                     std::string(";;["), std::string("]]==]"), std::string("?\?=")})
        EXPECT_NE(text.find(sting), std::string::npos) << testing::PrintToString(sting);
    EXPECT_EQ(text.back(), '\\');
}

}  // namespace
