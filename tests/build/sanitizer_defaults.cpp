// SPDX-License-Identifier: MIT
// What the sanitizers have to know about OpenCL drivers, linked into every program of a build with GNOMON_SANITIZE. The
// sanitizers call these by themselves, so no environment variable is needed to run such a program.
//
// PoCL 3.1 keeps the LLVM context and module of every kernel it compiled until the process ends (1.4 MB for a kernel
// of one line; none once its cache on disk has the kernel). PoCL and LLVM are built without frame pointers, so a leak's
// call stack ends at the first frame inside them: a cl_mem that gnomon forgot to release looks the same and is hidden
// too. Seeing whole stacks (fast_unwind_on_malloc=0) would tell them apart, but makes kernel compilation five times as
// slow. Everything that our own code allocates is still watched.
extern "C" const char* __lsan_default_suppressions();
extern "C" const char* __lsan_default_suppressions() {
    return "leak:libpocl\n"
           "leak:libLLVM\n";
}

/// The summary of what was suppressed would stand in the standard error of programs whose messages are tested.
extern "C" const char* __lsan_default_options();
extern "C" const char* __lsan_default_options() { return "print_suppressions=0"; }

/// LeakSanitizer guesses where a library's thread-local memory begins, and crashes at the end of a process where it
/// guesses wrong (google/sanitizers issue 1353: seen with PoCL's threads, from one process in some thousand to all).
/// Without the guess it reports memory that only such a library's thread-local variable refers to; there is none here.
extern "C" const char* __asan_default_options();
extern "C" const char* __asan_default_options() { return "intercept_tls_get_addr=0"; }
