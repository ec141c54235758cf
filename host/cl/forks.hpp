// SPDX-License-Identifier: MIT
// Processes that were forked after OpenCL was used. The driver's threads do not exist in the child, and threads of the
// parent may have held the driver's locks: no function of OpenCL is called there.
#pragma once

#include <CL/cl.h>

#include <atomic>
#include <type_traits>

namespace gnomon::cl {

/// Set in the child by fork() itself, if OpenCL was used before, by gnomon or by another part of the program.
extern std::atomic<bool> is_forked;
/// The code of calls that are not made for this reason. It is none of OpenCL's.
constexpr cl_int forked_process = -29999;

/// Called before any lock. Throws one sentence that names what to do where is_forked is set.
void require_unforked();
/// From now on a child is one of a process that uses OpenCL; `is_used` is false where no library was found.
void note_use(bool is_used);

/// A function of OpenCL. Where is_forked is set, it returns forked_process, or null with this code, and is not called:
/// the child waits for none of the driver's locks, and releases no handle that it inherited.
template <typename Pointer>
struct Function;
template <typename Result, typename... Parameters>
struct Function<Result(CL_API_CALL*)(Parameters...)> {
    Result(CL_API_CALL* pointer)(Parameters...) = nullptr;

    Result operator()(Parameters... arguments) const {
        if (!is_forked.load(std::memory_order_relaxed)) return pointer(arguments...);
        if constexpr (std::is_same_v<Result, cl_int>)
            return forked_process;
        else {
            (give_code(arguments), ...);
            return nullptr;
        }
    }

private:
    static void give_code(cl_int* code) {
        if (code != nullptr) *code = forked_process;
    }
    template <typename Other>
    static void give_code(Other) {}
};

}  // namespace gnomon::cl
