// SPDX-License-Identifier: MIT
#include "lists/scan.hpp"

#include "kernels/lists/scan.h"

namespace gnomon {

void Scan::run(cl::Session& session, std::uint32_t count, std::uint32_t alignment, const cl::Buffer& counts,
               const cl::Buffer& offsets) {
    const std::uint32_t pieces = (count + scan_piece(session.is_cpu()) - 1) / scan_piece(session.is_cpu());
    piece_sums_.reserve(session, pieces * sizeof(std::uint32_t));
    session.launch("lists/scan.cl", "scan_sums", cl::Range::items(pieces), count, alignment, counts, piece_sums_);
    session.launch("lists/scan.cl", "scan_pieces", cl::Range::groups(1), count, piece_sums_, offsets,
                   cl::LocalBytes{session.work_group_size() * sizeof(std::uint32_t)});
    session.launch("lists/scan.cl", "scan_offsets", cl::Range::items(pieces), count, alignment, counts, piece_sums_,
                   offsets);
}

}  // namespace gnomon
