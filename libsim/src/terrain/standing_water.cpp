// SPDX-License-Identifier: GPL-3.0-or-later
#include "thalweg/terrain/standing_water.hpp"

#include "terrain/check_sizes.hpp"

namespace thalweg::terrain {

StandingWaters standing_waters(const Grid& grid, std::span<const double> elevation_m,
                               std::span<const double> filled_m) {
    check_sizes(grid.size(), elevation_m.size(), filled_m.size());
    StandingWaters found{.waters = {}, .of_cell = std::vector<Index>(grid.size(), none)};
    std::vector<Index> waiting;
    for (Index first = 0; first < grid.size(); ++first) {
        if (found.of_cell[first] != none || !(filled_m[first] > elevation_m[first])) continue;
        const auto number = static_cast<Index>(found.waters.size());
        StandingWater water{.lowest = first, .depth_m = 0, .area_m2 = 0};
        found.of_cell[first] = number;
        waiting.push_back(first);
        while (!waiting.empty()) {
            const Index cell = waiting.back();
            waiting.pop_back();
            water.area_m2 += grid.area(cell);
            const double height = elevation_m[cell], lowest = elevation_m[water.lowest];
            if (height < lowest || (height == lowest && cell < water.lowest)) water.lowest = cell;
            grid.neighbors(cell, [&](Index other, double, Slot) {
                const bool same = filled_m[other] == filled_m[first] && elevation_m[other] < filled_m[other];
                if (!same || found.of_cell[other] != none) return;
                found.of_cell[other] = number;
                waiting.push_back(other);
            });
        }
        water.depth_m = filled_m[first] - elevation_m[water.lowest];
        found.waters.push_back(water);
    }
    return found;
}

}  // namespace thalweg::terrain
