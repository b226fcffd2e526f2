// SPDX-License-Identifier: GPL-3.0-or-later
#include "terrain/donors.hpp"

#include <algorithm>

#include "terrain/blocks.hpp"
#include "thalweg/core/parallel.hpp"

namespace thalweg::terrain {
namespace {

/// A neighbour is a donor if its direction is the reverse of the one that leads to it. Comparisons of bytes, summed:
/// the loop vectorises. The first and the last column lack neighbours.
void count_in_row(const Slot* above, const Slot* here, const Slot* below, Index cols, std::uint8_t* donors) {
    for (Index c = 0; c < cols; ++c) {
        donors[c] = static_cast<std::uint8_t>((above[c] == 2) + (below[c] == 6));
    }
    for (Index c = 1; c < cols; ++c) {
        donors[c] =
            static_cast<std::uint8_t>(donors[c] + (here[c - 1] == 0) + (above[c - 1] == 1) + (below[c - 1] == 7));
    }
    for (Index c = 0; c + 1 < cols; ++c) {
        donors[c] =
            static_cast<std::uint8_t>(donors[c] + (here[c + 1] == 4) + (below[c + 1] == 5) + (above[c + 1] == 3));
    }
}

/// Each block counts for its own nodes; what flows over a border is counted afterwards.
template <class Flow>
void count_by_blocks(const Flow& flow, const FlowDirections& directions, std::vector<std::uint8_t>& donors) {
    donors.assign(flow.size(), 0);
    const Blocks blocks(flow.size());
    std::vector<std::vector<Index>> beyond(blocks.count());
    blocks.for_each([&](Index block) {
        const Index first = blocks.first(block);
        const Index size = blocks.last(block) - first;
        for (Index node = first; node < first + size; ++node) {
            if (directions[node] == no_flow) continue;
            const Index receiver = flow.neighbor(node, directions[node]);
            if (receiver - first < size) {
                ++donors[receiver];
            } else {
                beyond[block].push_back(receiver);
            }
        }
    });
    for (const std::vector<Index>& receivers : beyond) {
        for (const Index receiver : receivers) ++donors[receiver];
    }
}

}  // namespace

void count_donors(const Grid& grid, const FlowDirections& directions, std::vector<std::uint8_t>& donors) {
    donors.resize(grid.size());
    const FlowDirections nothing(grid.cols, no_flow);  // beyond the first and the last row
    const auto rows = [&](Index first, Index last) {
        for (Index row = first; row < last; ++row) {
            const Slot* here = directions.data() + std::size_t{row} * grid.cols;
            const Slot* above = row == 0 ? nothing.data() : here - grid.cols;
            const Slot* below = row + 1 == grid.rows ? nothing.data() : here + grid.cols;
            count_in_row(above, here, below, grid.cols, donors.data() + std::size_t{row} * grid.cols);
        }
    };
    parallel_for(0, grid.rows, rows, std::max<Index>(1, 65536 / grid.cols));
}

void count_donors(const Mesh& mesh, const FlowDirections& directions, std::vector<std::uint8_t>& donors) {
    count_by_blocks(mesh, directions, donors);
}

void count_donors(const MeshFlow& flow, const FlowDirections& directions, std::vector<std::uint8_t>& donors) {
    count_by_blocks(flow, directions, donors);
}

}  // namespace thalweg::terrain
