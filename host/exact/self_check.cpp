// SPDX-License-Identifier: MIT
// Start-up check of a device's arithmetic. See self_check.hpp.
#include "exact/self_check.hpp"

#include <array>

#include "kernels/exact/self_check.h"

namespace gnomon {
namespace {

constexpr std::array<const char*, SELF_CHECK_FAULTS> clauses = {
    "rounds a * b + c once where it must round twice",
    "reorders sums of floats",
    "does not round floats to nearest even",
    "rounds fma() twice",
    "changes denormal floats when it only moves them",
    "computes wrongly with 64-bit integers",
    "orders unsigned integers wrongly in atomic_min or atomic_max",
    "gets a sign of the exact predicate wrong",
    "mixes up work-items that take different ways through the exact predicate",
    "rounds a * b + c of doubles once where it must round twice",
    "reorders sums of doubles",
    "does not round doubles to nearest even",
    "loses denormal floats when it makes them doubles",
    "rounds doubles to wrong denormal floats",
    "states registers of 16 floats, for which its compiler makes no code",
};

std::string joined(const std::vector<std::string>& clauses_found) {
    std::string text;
    for (std::size_t i = 0; i < clauses_found.size(); ++i)
        text += (i == 0 ? "" : i + 1 < clauses_found.size() ? ", " : " and ") + clauses_found[i];
    return text;
}

}  // namespace

ArithmeticFaults check_arithmetic(cl::Session& session) {
    SelfCheckResult result{};
    result.min_key = ~0u;
    const std::array<uint, 4> kept = {0x00000001u, 0x807FFFFFu, 0x7F7FFFFFu, 0};  // bits of floats
    cl::Buffer results(session, sizeof(result)), floats(session, sizeof(kept));
    session.write(results.get(), &result, sizeof(result));
    session.write(floats.get(), kept.data(), sizeof(kept));
    session.launch("exact/self_check.cl", "self_check", cl::Range::groups(1, 64), results, floats);
    session.read(results.get(), &result, sizeof(result));
    session.take_device_ms();  // no stage's time
    // Keys of minus and plus the largest float.
    if (result.min_key != 0x00800000u || result.greatest_key != 0xFF7FFFFFu) result.faults |= 1u << FAULT_KEYS;

    // PoCL takes its functions of vectors from a library made for the stated registers, which a compiler without these
    // registers calls in another way. Where none are stated, both agree.
    if (session.native_floats() < 16) result.faults &= ~(1u << FAULT_WIDE_VECTORS);

    ArithmeticFaults faults;
    for (std::size_t i = 0; i < clauses.size(); ++i)
        if (result.faults >> i & 1u)
            (FAULT_REFUSED >> i & 1u   ? faults.everywhere
             : i == FAULT_WIDE_VECTORS ? faults.in_vectors
                                       : faults.in_double)
                .push_back(clauses[i]);
    return faults;
}

std::shared_ptr<cl::Session> open_checked(
    const DeviceOptions& options, const std::function<std::shared_ptr<cl::Session>(const DeviceOptions&)>& open) {
    std::shared_ptr<cl::Session> session = open(options);
    ArithmeticFaults faults = check_arithmetic(*session);
    if (faults.everywhere.empty() && (!faults.in_double.empty() || !faults.in_vectors.empty())) {
        DeviceOptions reduced = options;
        std::string note;
        if (!faults.in_double.empty()) {
            reduced.hide_fp64 = true;
            note = "double precision is not used: the device " + joined(faults.in_double);
        }
        if (!faults.in_vectors.empty()) {
            reduced.gpu_kernels = true;
            note += std::string(note.empty() ? "" : "; ") + "the slower kernels for GPUs are used: the driver " +
                    joined(faults.in_vectors);
        }
        session = open(reduced);
        session->set_note(note);
        faults = check_arithmetic(*session);
    }
    if (!faults.everywhere.empty())
        throw DeviceNotFound("the device " + session->description().name + " cannot be used, since it " +
                             joined(faults.everywhere) +
                             ", so that shadows would not be exact: update its driver or choose another device");
    session->forget_peak();
    return session;
}

}  // namespace gnomon
