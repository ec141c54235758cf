// SPDX-License-Identifier: MIT
// The first look under a prepared light, at all points: facing is decided on the way (prepared_facing.h).
#define TRACE_KERNEL prepared_trace
#define TRACE_BY_PLANES 0
#include "prepared/prepared_trace.clh"
#include "trace/trace_kernel.clh"
