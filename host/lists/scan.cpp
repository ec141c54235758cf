// SPDX-License-Identifier: MIT
#include "lists/scan.hpp"

#include <algorithm>

#include "kernels/lists/scan.h"

namespace gnomon {

void Scan::run(cl::Session& session, std::uint32_t count, const cl::Buffer& counts, const cl::Buffer& offsets) {
    const std::uint32_t chunk = scan_chunk(session.is_cpu()), chunks = (count + chunk - 1) / chunk;
    const cl::LocalBytes local{session.work_group_size() * sizeof(std::uint32_t)};
    const cl::Range groups = cl::Range::groups(std::min<std::size_t>(chunks, session.many_groups()));
    chunk_sums_.reserve(session, chunks * sizeof(std::uint32_t));
    session.launch("lists/scan.cl", "scan_sums", groups, count, counts, chunk_sums_, local);
    session.launch("lists/scan.cl", "scan_chunks", cl::Range::groups(1), count, chunk_sums_, offsets, local);
    session.launch("lists/scan.cl", "scan_offsets", groups, count, counts, chunk_sums_, offsets, local);
}

}  // namespace gnomon
