// SPDX-License-Identifier: GPL-3.0-or-later
#include "thalweg/study/height_survey.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <limits>

#include "thalweg/core/statistics.hpp"

namespace thalweg::study {
namespace {

constexpr double nan = std::numeric_limits<double>::quiet_NaN();

/// Rows to look at: all, or so many of a large raster.
Index row_step(const Grid& grid) {
    constexpr std::uint64_t most_cells = 4'000'000;
    return static_cast<Index>(std::max<std::uint64_t>(1, std::uint64_t{grid.rows} * grid.cols / most_cells));
}

/// Second differences along one direction, gathered for each line across it.
struct Stripes {
    explicit Stripes(Index lines) : sum(lines, 0), count(lines, 0) {}

    void add(Index line, double difference) {
        if (std::isnan(difference)) return;
        sum[line] += difference;
        ++count[line];
        squares += difference * difference;
        ++cells;
    }
    double share(Index line_length) const {
        double common = 0;
        for (std::size_t line = 0; line < sum.size(); ++line) {
            if (count[line] > 0 && 2 * count[line] >= line_length) common += sum[line] * sum[line] / count[line];
        }
        return squares > 0 ? common / squares : nan;
    }

    std::vector<double> sum;
    std::vector<Index> count;
    double squares = 0;
    std::size_t cells = 0;
};

/// Whether lines equal the ones before them. Lines of a single height (a sea, no data) say nothing.
class Repeats {
  public:
    explicit Repeats(Index lines)
        : differs_(lines, 0), lowest_(lines, std::numeric_limits<double>::infinity()), highest_(lines, -lowest_[0]) {}

    void add(Index line, double height, double before) {
        const bool both_void = std::isnan(height) && std::isnan(before);
        if (!both_void && height != before) differs_[line] = 1;
        if (std::isnan(height)) return;
        lowest_[line] = std::min(lowest_[line], height);
        highest_[line] = std::max(highest_[line], height);
    }
    double share() const {
        double lines = 0, repeated = 0;
        for (std::size_t line = 0; line < differs_.size(); ++line) {
            if (!(highest_[line] > lowest_[line])) continue;
            ++lines;
            repeated += !differs_[line];
        }
        return lines > 0 ? repeated / lines : nan;
    }

  private:
    std::vector<std::uint8_t> differs_;
    std::vector<double> lowest_, highest_;
};

/// The most frequent of a sample of the heights; NaN without data.
double most_frequent(const std::vector<double>& values) {
    constexpr std::size_t most = 65536;
    std::vector<double> sample;
    for (std::size_t i = 0; i < values.size(); i += 1 + values.size() / most) {
        if (!std::isnan(values[i])) sample.push_back(values[i]);
    }
    std::ranges::sort(sample);
    double found = nan;
    std::ptrdiff_t longest = 0;
    for (auto first = sample.begin(); first != sample.end();) {
        const auto last = std::upper_bound(first, sample.end(), *first);
        if (last - first > longest) longest = last - first, found = *first;
        first = last;
    }
    return found;
}

void count_values(const std::vector<double>& values, HeightSurvey& survey) {
    std::size_t valid = 0, frequent = 0, zero = 0;
    for (const double value : values) {
        valid += !std::isnan(value);
        frequent += value == survey.most_frequent_m;
        zero += value == 0;
    }
    const auto cells = static_cast<double>(valid);
    survey.most_frequent_share = valid > 0 ? static_cast<double>(frequent) / cells : nan;
    survey.zero_share = valid > 0 ? static_cast<double>(zero) / cells : nan;
}

void count_steps(const Raster& raster, HeightSurvey& survey) {
    const Grid& grid = raster.grid;
    std::size_t pairs = 0, level = 0;
    std::vector<double> steps;
    for (Index row = 0; row < grid.rows; row += row_step(grid)) {
        const double* const z = raster.values.data() + std::size_t{row} * grid.cols;
        for (Index col = 1; col < grid.cols; ++col) {
            const double step = std::abs(z[col] - z[col - 1]);
            if (std::isnan(step)) continue;
            ++pairs;
            level += step == 0 && z[col] != survey.most_frequent_m;
            if (step > 0) steps.push_back(step);
        }
    }
    survey.level_share = pairs > 0 ? static_cast<double>(level) / static_cast<double>(pairs) : nan;
    survey.median_step_m = steps.empty() ? nan : quantile(std::move(steps), 0.5);
}

void look_for_lines(const Raster& raster, HeightSurvey& survey) {
    const Grid& grid = raster.grid;
    const std::ptrdiff_t cols = grid.cols;
    Stripes across_rows(grid.rows), across_cols(grid.cols);
    Repeats rows(grid.rows), columns(grid.cols);
    Index looked_at = 0;
    for (Index row = 1; row + 1 < grid.rows; row += row_step(grid)) {
        ++looked_at;
        const double* const z = raster.values.data() + std::size_t{row} * grid.cols;
        for (std::ptrdiff_t col = 0; col < cols; ++col) {
            across_rows.add(row, z[col] - 0.5 * (z[col - cols] + z[col + cols]));
            rows.add(row, z[col], z[col - cols]);
            if (col == 0) continue;
            columns.add(static_cast<Index>(col), z[col], z[col - 1]);
            if (col + 1 < cols) across_cols.add(static_cast<Index>(col), z[col] - 0.5 * (z[col - 1] + z[col + 1]));
        }
    }
    survey.row_striping = across_rows.share(grid.cols);
    survey.column_striping = across_cols.share(looked_at);
    survey.repeated_rows = rows.share();
    survey.repeated_columns = columns.share();
}

/// Whether the value stands on the outer edge of the raster: then the reader has warned of it.
bool is_on_rim(const Raster& raster, double value) {
    const Grid& grid = raster.grid;
    for (Index node = 0; node < grid.size(); ++node) {
        const Index row = grid.row(node), col = grid.col(node);
        const bool rim = row == 0 || col == 0 || row + 1 == grid.rows || col + 1 == grid.cols;
        if (rim && raster.values[node] == value) return true;
    }
    return false;
}

/// Beyond what the terrain of sixteen real DEMs has by itself (Spearfish apart, whose profiles are striped).
bool is_striped(double share, Index line_length) { return share > std::max(0.02, 15.0 / line_length); }

}  // namespace

HeightSurvey survey_heights(const Raster& raster) {
    HeightSurvey survey{.most_frequent_m = most_frequent(raster.values),
                        .most_frequent_share = nan,
                        .zero_share = nan,
                        .level_share = nan,
                        .median_step_m = nan,
                        .row_striping = nan,
                        .column_striping = nan,
                        .repeated_rows = nan,
                        .repeated_columns = nan};
    count_values(raster.values, survey);
    count_steps(raster, survey);
    look_for_lines(raster, survey);
    return survey;
}

std::vector<std::string> survey_hints(const HeightSurvey& s, const Raster& raster, double vertical_quantum_m) {
    std::vector<std::string> hints;
    const Grid& grid = raster.grid;
    if (s.level_share > 0.1) {
        hints.push_back(fmt::format(
            "{:.0f} % of neighbouring cells have one height{}: slopes of single cells are steps there (slope-area and "
            "chi "
            "are measured over falls of several)",
            100 * s.level_share,
            vertical_quantum_m > 0 ? fmt::format(", heights being multiples of {:.3g} m", vertical_quantum_m)
                                   : " (lakes, terraces, or a surface made from contours)"));
    }
    if (s.most_frequent_share > 0.05 && !is_on_rim(raster, s.most_frequent_m)) {
        hints.push_back(
            fmt::format("{:.1f} % of the cells with data are exactly {:.6g} m: a lake, the sea, or a value "
                        "that stands for no data (--nodata, --sea-level)",
                        100 * s.most_frequent_share, s.most_frequent_m));
    }
    for (const auto& [share, length, lines] :
         {std::tuple{s.row_striping, grid.cols, "rows"}, std::tuple{s.column_striping, grid.rows, "columns"}}) {
        if (!is_striped(share, length)) continue;
        hints.push_back(
            fmt::format("the heights are striped along {}: {:.1f} % of their fine roughness is common to whole "
                        "{}, terrain has about {:.1f} %; small channels may follow the stripes",
                        lines, 100 * share, lines, 100 * 5.0 / length));
    }
    for (const auto& [share, lines] : {std::pair{s.repeated_rows, "rows"}, std::pair{s.repeated_columns, "columns"}}) {
        if (!(share > 0.05)) continue;
        hints.push_back(
            fmt::format("{:.0f} % of the {} repeat the one before: the raster was put on smaller cells by "
                        "repeating values, so its cells are not its resolution (--cell-m)",
                        100 * share, lines));
    }
    const double ratio = mean(grid.east_west) / mean(grid.north_south);
    if (ratio > 3 || ratio < 1.0 / 3) {
        hints.push_back(
            fmt::format("cells are {:.3g} times as wide as high: eight directions of flow are far from even "
                        "(--cell-m makes them square)",
                        ratio));
    }
    return hints;
}

}  // namespace thalweg::study
