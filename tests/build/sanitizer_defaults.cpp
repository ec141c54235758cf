// SPDX-License-Identifier: MIT
// What AddressSanitizer and LeakSanitizer have to know about OpenCL drivers, linked into every program of a build with
// GNOMON_SANITIZE. The sanitizers call these functions at start and exit, so no environment variable is needed.

/// Leaks whose call stack has one of these libraries in it are not ours. PoCL keeps its devices, its LLVM context and
/// compiled kernels until the process ends; the ICD loader keeps its list of platforms.
extern "C" const char* __lsan_default_suppressions();
extern "C" const char* __lsan_default_suppressions() {
    return "leak:libpocl\n"
           "leak:libLLVM\n"
           "leak:libOpenCL.so\n";
}
