// SPDX-License-Identifier: GPL-3.0-or-later
#include "thalweg/study/height_survey.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <cstring>
#include <limits>
#include <numeric>
#include <span>

#include "thalweg/core/statistics.hpp"

namespace thalweg::study {
namespace {

constexpr double nan = std::numeric_limits<double>::quiet_NaN();

/// Four cells at once. A comparison gives -1 in each lane where it holds.
using Lanes = double __attribute__((vector_size(32)));
using Counts = std::int64_t __attribute__((vector_size(32)));
constexpr Index lanes = 4;

Lanes load(const double* from) {
    Lanes loaded;
    std::memcpy(&loaded, from, sizeof loaded);
    return loaded;
}

template <typename Number, typename Vector>
void add_to_memory(Number* sums, Vector more) {
    Vector before;
    std::memcpy(&before, sums, sizeof before);
    before += more;
    std::memcpy(sums, &before, sizeof before);
}

/// Second differences of one direction, gathered for each line across it.
struct Stripes {
    explicit Stripes(Index lines) : sum(lines, 0), count(lines, 0) {}

    /// Of each line that has at least half its cells, as have the two beside it: cells times the square of what its
    /// mean difference has over theirs.
    std::vector<double> own(Index line_length) const {
        const auto whole = [&](std::size_t line) { return count[line] > 0 && 2 * count[line] >= line_length; };
        const auto mean_of = [&](std::size_t line) { return sum[line] / static_cast<double>(count[line]); };
        std::vector<double> squares_of_lines;
        for (std::size_t line = 1; line + 1 < sum.size(); ++line) {
            if (!whole(line - 1) || !whole(line) || !whole(line + 1)) continue;
            const double alone = mean_of(line) - 0.5 * (mean_of(line - 1) + mean_of(line + 1));
            squares_of_lines.push_back(static_cast<double>(count[line]) * alone * alone);
        }
        return squares_of_lines;
    }

    double share(Index line_length) const {
        constexpr double of_even_stripes = 35.0 / 12;  // (2·¼² + 2·1² + 1.5²)/(1² + 2·½²)
        std::vector<double> lines = own(line_length);
        if (lines.empty() || !(squares > 0)) return nan;
        std::ranges::sort(lines);
        const auto kept = lines.end() - static_cast<std::ptrdiff_t>(lines.size() / 10);
        return std::accumulate(lines.begin(), kept, 0.0) / (of_even_stripes * squares);
    }

    /// Root mean square of all differences; NaN where there are none.
    double roughness() const {
        const auto cells = std::accumulate(count.begin(), count.end(), std::int64_t{0});
        return cells > 0 ? std::sqrt(squares / static_cast<double>(cells)) : nan;
    }

    std::vector<double> sum;
    std::vector<std::int64_t> count;
    double squares = 0;
};

/// Differences of a row from the mean of the rows beside it, into that row's sums.
void add_row(Stripes& stripes, Index row, const double* z, Index cols) {
    const double *const above = z - cols, *const below = z + cols;
    Lanes sum{}, squares{};
    Counts count{};
    Index col = 0;
    for (; col + lanes <= cols; col += lanes) {
        const Lanes d = load(z + col) - 0.5 * (load(above + col) + load(below + col));
        const Counts is_known = d == d;
        const Lanes known = is_known ? d : Lanes{};
        sum += known;
        count -= is_known;
        squares += known * known;
    }
    for (; col < cols; ++col) {
        const double d = z[col] - 0.5 * (above[col] + below[col]);
        if (std::isnan(d)) continue;
        sum[0] += d;
        ++count[0];
        squares[0] += d * d;
    }
    stripes.sum[row] = sum[0] + sum[1] + sum[2] + sum[3];
    stripes.count[row] = count[0] + count[1] + count[2] + count[3];
    stripes.squares += squares[0] + squares[1] + squares[2] + squares[3];
}

/// Differences of each cell of a row from the mean of those left and right of it, into the sums of its column.
void add_columns(Stripes& stripes, const double* z, Index cols) {
    double* const sum = stripes.sum.data();
    std::int64_t* const count = stripes.count.data();
    Lanes squares{};
    Index col = 1;
    for (; col + lanes < cols; col += lanes) {
        const Lanes d = load(z + col) - 0.5 * (load(z + col - 1) + load(z + col + 1));
        const Counts is_known = d == d;
        const Lanes known = is_known ? d : Lanes{};
        add_to_memory(sum + col, known);
        add_to_memory(count + col, -is_known);
        squares += known * known;
    }
    for (; col + 1 < cols; ++col) {
        const double d = z[col] - 0.5 * (z[col - 1] + z[col + 1]);
        if (std::isnan(d)) continue;
        sum[col] += d;
        ++count[col];
        squares[0] += d * d;
    }
    stripes.squares += squares[0] + squares[1] + squares[2] + squares[3];
}

void measure_stripes(const Raster& raster, HeightSurvey& survey) {
    const Grid& grid = raster.grid;
    Stripes across_rows(grid.rows), across_cols(grid.cols);
    for (Index row = 0; row < grid.rows; ++row) {
        const double* const z = raster.values.data() + std::size_t{row} * grid.cols;
        if (row > 0 && row + 1 < grid.rows) add_row(across_rows, row, z, grid.cols);
        add_columns(across_cols, z, grid.cols);
    }
    survey.row_roughness_m = across_rows.roughness();
    survey.column_roughness_m = across_cols.roughness();
    // As heights are rounded in single precision: then there is no roughness that lines could share.
    const double rounding = std::ldexp(survey.largest_m, -23);
    if (survey.row_roughness_m > rounding) survey.row_striping = across_rows.share(grid.cols);
    if (survey.column_roughness_m > rounding) survey.column_striping = across_cols.share(grid.rows);
}

bool same(double a, double b) { return a == b || (std::isnan(a) && std::isnan(b)); }

/// Share of neighbouring lines that are equal. Lines of a single height (a sea, no data) say nothing.
double share_repeated(const std::vector<std::uint8_t>& varied, const std::vector<std::uint8_t>& equals_last) {
    double pairs = 0, repeated = 0;
    for (std::size_t line = 1; line < varied.size(); ++line) {
        if (!varied[line] && !varied[line - 1]) continue;
        ++pairs;
        repeated += equals_last[line];
    }
    return pairs > 0 ? repeated / pairs : nan;
}

/// Stops at the first cell of a row that decides, which in terrain is one of the first.
double repeated_rows(const Raster& raster) {
    const Grid& grid = raster.grid;
    std::vector<std::uint8_t> varied(grid.rows, 0), equals_last(grid.rows, 0);
    for (Index row = 0; row < grid.rows; ++row) {
        const auto z = std::span(raster.values).subspan(std::size_t{row} * grid.cols, grid.cols);
        const auto known = std::ranges::find_if(z, [](double height) { return !std::isnan(height); });
        varied[row] =
            std::any_of(known, z.end(), [&](double height) { return !std::isnan(height) && height != *known; });
        equals_last[row] = row > 0 && std::equal(z.begin(), z.end(), z.begin() - grid.cols, same);
    }
    return share_repeated(varied, equals_last);
}

/// Goes row by row with the columns that are still undecided, in terrain soon none.
double repeated_columns(const Raster& raster) {
    const Grid& grid = raster.grid;
    std::vector<std::uint8_t> varied(grid.cols, 0), equals_last(grid.cols, 1);
    std::vector<double> first(grid.cols, nan);
    std::vector<Index> unvaried(grid.cols), equal(grid.cols);
    std::iota(unvaried.begin(), unvaried.end(), 0);
    std::iota(equal.begin(), equal.end(), 0);
    equal.erase(equal.begin());
    for (Index row = 0; row < grid.rows && !(unvaried.empty() && equal.empty()); ++row) {
        const double* const z = raster.values.data() + std::size_t{row} * grid.cols;
        std::erase_if(unvaried, [&](Index col) {
            if (std::isnan(first[col])) first[col] = z[col];
            varied[col] = !std::isnan(z[col]) && z[col] != first[col];
            return varied[col] != 0;
        });
        std::erase_if(equal, [&](Index col) {
            equals_last[col] = same(z[col], z[col - 1]);
            return equals_last[col] == 0;
        });
    }
    return share_repeated(varied, equals_last);
}

/// Every so many lines from both ends inwards, so that a raster turned or mirrored has the same cells looked at.
std::vector<Index> symmetric_lines(Index lines, Index step) {
    std::vector<Index> chosen;
    for (Index line = 0; line < lines; ++line) {
        if (std::min(line, lines - 1 - line) % step == 0) chosen.push_back(line);
    }
    return chosen;
}

/// About `most` cells in rows and columns of even distance; all where there are no more.
template <typename Visit>
void sample_cells(const Grid& grid, Visit visit) {
    constexpr double most = 65536;
    const auto step = static_cast<Index>(std::ceil(std::sqrt(std::max(1.0, grid.size() / most))));
    const std::vector<Index> cols = symmetric_lines(grid.cols, step);
    for (const Index row : symmetric_lines(grid.rows, step)) {
        for (const Index col : cols) visit(row, col);
    }
}

/// The most frequent of a sample of the heights; NaN without data.
double most_frequent(const Raster& raster) {
    std::vector<double> sample;
    sample_cells(raster.grid, [&](Index row, Index col) {
        const double height = raster.values[std::size_t{row} * raster.grid.cols + col];
        if (!std::isnan(height)) sample.push_back(height);
    });
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
        valid += value == value;
        survey.largest_m = std::abs(value) > survey.largest_m ? std::abs(value) : survey.largest_m;
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
    const auto look = [&](double here, double beside) {
        const double step = std::abs(here - beside);
        if (std::isnan(step)) return;
        ++pairs;
        level += step == 0 && here != survey.most_frequent_m;
        if (step > 0) steps.push_back(step);
    };
    sample_cells(grid, [&](Index row, Index col) {
        const double* const z = &raster.values[std::size_t{row} * grid.cols + col];
        if (col > 0) look(*z, z[-1]);
        if (col + 1 < grid.cols) look(*z, z[1]);
        if (row > 0) look(*z, *(z - grid.cols));
        if (row + 1 < grid.rows) look(*z, *(z + grid.cols));
    });
    survey.level_share = pairs > 0 ? static_cast<double>(level) / static_cast<double>(pairs) : nan;
    survey.median_step_m = steps.empty() ? nan : quantile(std::move(steps), 0.5);
}

/// Whether the value stands on the outer edge of the raster: then the reader has warned of it.
bool is_on_rim(const Raster& raster, double value) {
    const Grid& grid = raster.grid;
    const auto has = [&](Index row, Index col) { return raster.values[std::size_t{row} * grid.cols + col] == value; };
    for (Index col = 0; col < grid.cols; ++col) {
        if (has(0, col) || has(grid.rows - 1, col)) return true;
    }
    for (Index row = 0; row < grid.rows; ++row) {
        if (has(row, 0) || has(row, grid.cols - 1)) return true;
    }
    return false;
}

/// Lines of one direction as a hint speaks of them.
struct Lines {
    const char* name;
    double striping, roughness_m;
    Index length, number;
};

/// Beyond what terrain has by itself: on sixteen real DEMs up to 2 over the length of a line (Spearfish apart, whose
/// profiles are striped: 10). Few lines, or roughness that rounding makes, tell nothing.
bool is_striped(const Lines& lines, double vertical_quantum_m) {
    constexpr Index enough = 80;  // of fewer, the eight that the edges of one block reach are more than a tenth
    return lines.number >= enough && lines.roughness_m > vertical_quantum_m &&
           lines.striping > std::max(0.01, 6.0 / lines.length);
}

}  // namespace

HeightSurvey survey_heights(const Raster& raster) {
    HeightSurvey survey{.most_frequent_m = most_frequent(raster),
                        .most_frequent_share = nan,
                        .zero_share = nan,
                        .level_share = nan,
                        .median_step_m = nan,
                        .largest_m = 0,
                        .row_roughness_m = nan,
                        .column_roughness_m = nan,
                        .row_striping = nan,
                        .column_striping = nan,
                        .repeated_rows = nan,
                        .repeated_columns = nan};
    count_values(raster.values, survey);
    count_steps(raster, survey);
    measure_stripes(raster, survey);
    survey.repeated_rows = repeated_rows(raster);
    survey.repeated_columns = repeated_columns(raster);
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
    for (const Lines& lines : {Lines{"rows", s.row_striping, s.row_roughness_m, grid.cols, grid.rows},
                               Lines{"columns", s.column_striping, s.column_roughness_m, grid.rows, grid.cols}}) {
        if (!is_striped(lines, vertical_quantum_m)) continue;
        hints.push_back(
            fmt::format("the heights are striped along {}: {:.1f} % of their fine roughness is common to whole "
                        "{} but not to those beside, terrain has about {:.1f} %; small channels may follow the stripes",
                        lines.name, 100 * lines.striping, lines.name, 100 * 1.0 / lines.length));
    }
    // Where all rows or all columns are alike, nothing was repeated: heights change along one direction only.
    const bool one_way = s.repeated_rows == 1 || s.repeated_columns == 1;
    for (const auto& [share, lines] : {std::pair{s.repeated_rows, "rows"}, std::pair{s.repeated_columns, "columns"}}) {
        if (!(share > 0.05) || one_way) continue;
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
