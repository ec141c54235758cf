// SPDX-License-Identifier: MIT
// Opens a device only if it computes as the proofs assume: a check of its arithmetic at start-up.
//
// A device with broken floats, integers or exact predicate is refused. A device where only double precision is broken
// is used without it: the answers are the same, since the exact level needs no double precision and the camera then
// computes doubles by integers. A CPU whose driver cannot call its own functions for vectors gets the kernels for GPUs,
// with the same answers. kernels/exact/self_check.cl has the tests and their numbers.
//
// Cost with PoCL: 20 ms when its kernel cache is warm, which is what PoCL takes for any program however small (the
// check itself: 0.1 ms), and half a second of compilation when it is not.
#pragma once

#include <functional>
#include <memory>
#include <string>
#include <vector>

#include "cl/session.hpp"

namespace gnomon {

/// The faults that the check found, as clauses that follow "the device".
struct ArithmeticFaults {
    std::vector<std::string> everywhere;  ///< no answer would be exact
    std::vector<std::string> in_double;   ///< harmless if double precision is left alone
    std::vector<std::string> in_vectors;  ///< harmless with the kernels for GPUs
};

ArithmeticFaults check_arithmetic(cl::Session& session);

/// Opens a session by `open`, checks it, and opens it again without double precision or vectors if only these are
/// broken (the description then states it). Throws DeviceNotFound for a device that cannot be trusted.
std::shared_ptr<cl::Session> open_checked(
    const DeviceOptions& options, const std::function<std::shared_ptr<cl::Session>(const DeviceOptions&)>& open);

}  // namespace gnomon
