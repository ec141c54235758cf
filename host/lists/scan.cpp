// SPDX-License-Identifier: MIT
#include "lists/scan.hpp"

#include "kernels/lists/scan.h"

namespace gnomon {

void Scan::run(cl::Session& session, std::uint32_t count, std::uint32_t alignment, const cl::Buffer& counts,
               const cl::Buffer& offsets) {
    const ScanParams params{.count = count, .alignment = alignment};
    const std::uint32_t chunk = scan_chunk(session.is_cpu()), chunks = (count + chunk - 1) / chunk;
    chunk_sums_.reserve(session, chunks * sizeof(std::uint32_t));
    session.launch("lists/scan.cl", "scan_sums", cl::Range::items(chunks), params, counts, chunk_sums_);
    session.launch("lists/scan.cl", "scan_chunks", cl::Range::groups(1), params, chunk_sums_, offsets,
                   cl::LocalBytes{session.work_group_size() * sizeof(std::uint32_t)});
    session.launch("lists/scan.cl", "scan_offsets", cl::Range::items(chunks), params, counts, chunk_sums_, offsets);
}

}  // namespace gnomon
