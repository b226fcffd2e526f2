// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <cmath>
#include <limits>
#include <sstream>
#include <stdexcept>
#include <string>
#include <vector>

#include "thalweg/core/grid.hpp"
#include "thalweg/core/topology.hpp"

namespace thalweg::support {

/// A grid of numbers.
struct Drawing {
    Index rows = 0;
    Index cols = 0;
    std::vector<double> values;
};

/// A drawn terrain: numbers separated by spaces, one row a line; '#' is a cell without data. Blank lines are skipped.
inline Drawing draw(const std::string& text) {
    Drawing drawing;
    std::istringstream lines(text);
    for (std::string line; std::getline(lines, line);) {
        std::istringstream words(line);
        Index cols = 0;
        for (std::string word; words >> word; ++cols) {
            drawing.values.push_back(word == "#" ? std::numeric_limits<double>::quiet_NaN() : std::stod(word));
        }
        if (cols == 0) continue;
        if (drawing.rows != 0 && cols != drawing.cols) throw std::invalid_argument("rows of unequal length: " + line);
        drawing.cols = cols;
        ++drawing.rows;
    }
    return drawing;
}

/// A drawn map of directions: one sign a cell, separated by spaces. The arrows of the eight slots are
/// > E, 1 SE, v S, 3 SW, < W, 5 NW, ^ N, 7 NE; '.' is a cell without direction.
inline FlowDirections draw_directions(const std::string& text) {
    FlowDirections directions;
    const std::string signs = ">1v3<5^7";
    for (const char sign : text) {
        if (sign == '.') directions.push_back(no_flow);
        const std::size_t slot = signs.find(sign);
        if (slot != std::string::npos) directions.push_back(static_cast<Slot>(slot));
    }
    return directions;
}

/// The same as text, to compare and to read when a test fails.
inline std::string show_directions(const FlowDirections& directions, Index cols) {
    std::string text;
    for (std::size_t i = 0; i < directions.size(); ++i) {
        text += directions[i] == no_flow ? '.' : ">1v3<5^7"[directions[i]];
        text += (i + 1) % cols == 0 ? '\n' : ' ';
    }
    return text;
}

}  // namespace thalweg::support
