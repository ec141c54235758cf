// SPDX-License-Identifier: MIT
// As prepared_trace.cl, for lifted points on a GPU: what their receivers' planes leave undecided is a stray, for which
// prepared_trace has to run.
#define TRACE_KERNEL prepared_trace_plane_side
#define TRACE_BY_PLANES 1
#include "prepared/prepared_trace.clh"
#include "trace/trace_kernel.clh"
