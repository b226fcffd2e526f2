// SPDX-License-Identifier: GPL-3.0-or-later
#include "study/snapshots.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <limits>

#include "thalweg/core/error.hpp"
#include "thalweg/io/raster_series.hpp"
#include "thalweg/study/checkpoint.hpp"
#include "thalweg/study/manifest.hpp"
#include "thalweg/surface/hillshade.hpp"

namespace thalweg::study {
namespace fs = std::filesystem;
namespace {

/// A moment of the run: its number and where its landscape is kept (nowhere: it is the finished one).
struct Moment {
    Index step;
    fs::path file;
};

/// Names sort like the steps, and tell them.
fs::path frame_file(const fs::path& folder, Index step) { return folder / fmt::format("{:010}", step); }

std::vector<Moment> moments_in(const fs::path& folder) {
    std::vector<Moment> moments;
    for (const auto& entry : fs::directory_iterator(folder)) {
        if (entry.path().has_extension()) continue;  // a frame that was never finished
        moments.push_back({static_cast<Index>(std::stoul(entry.path().filename().string())), entry.path()});
    }
    std::ranges::sort(moments, {}, &Moment::step);
    return moments;
}

struct Range {
    double lowest = std::numeric_limits<double>::infinity();
    double highest = -std::numeric_limits<double>::infinity();
    void take_in(const std::vector<double>& values) {
        for (const double value : values) {
            if (std::isnan(value)) continue;
            lowest = std::min(lowest, value);
            highest = std::max(highest, value);
        }
    }
};

using Color = std::array<double, 3>;

/// From valley floors to snow, evenly spaced.
constexpr std::array<Color, 6> ramp{
    {{94, 140, 97}, {158, 178, 116}, {214, 200, 144}, {176, 138, 98}, {148, 122, 112}, {246, 246, 246}}};

Color color_at(double share) {
    const double place = std::clamp(share, 0.0, 1.0) * (ramp.size() - 1);
    const auto below = std::min(static_cast<std::size_t>(place), ramp.size() - 2);
    const double part = place - static_cast<double>(below);
    Color color{};
    for (int i = 0; i < 3; ++i) color[i] = ramp[below][i] + part * (ramp[below + 1][i] - ramp[below][i]);
    return color;
}

}  // namespace

Frames::Frames(fs::path folder, Index last_step) : folder_(std::move(folder)) {
    fs::create_directories(folder_);
    for (const Moment& moment : moments_in(folder_)) {
        if (moment.step > last_step) fs::remove(moment.file);
    }
}

void Frames::keep(Index step, const evolve::Landscape& landscape) { save_frame(landscape, frame_file(folder_, step)); }

void Frames::write(Index last_step, const evolve::Landscape& finished,
                   const std::function<Raster(const std::vector<double>&)>& raster_of, const fs::path& folder) const {
    std::vector<Moment> moments = moments_in(folder_);
    if (moments.empty() || moments.back().step != last_step) moments.push_back({last_step, {}});
    const auto landscape_of = [&](const Moment& m) { return m.file.empty() ? finished : load_frame(m.file); };
    Range range;
    io::RasterSeries series{
        .time_yr = {}, .elevation_m = {}, .title = "Simulated landscape", .source = "thalweg " + versions().thalweg};
    for (const Moment& moment : moments) {
        const evolve::Landscape landscape = landscape_of(moment);
        range.take_in(landscape.elevation_m);
        series.time_yr.push_back(landscape.time_yr);
    }
    fs::create_directories(folder);
    series.elevation_m = [&](std::size_t number) {
        const Raster raster = raster_of(landscape_of(moments[number]).elevation_m);
        const fs::path file = folder / fmt::format("step-{:06}.png", moments[number].step);
        io::write_png(file, raster.grid.rows, raster.grid.cols, picture_of(raster, range.lowest, range.highest));
        return raster;
    };
    io::write_netcdf(folder / "elevation.nc", series);
}

std::vector<std::uint8_t> picture_of(const Raster& raster, double lowest_m, double highest_m) {
    const std::vector<double> shade = surface::hillshade(raster);
    const double range = highest_m > lowest_m ? highest_m - lowest_m : 1;
    constexpr double ambient = 0.3;
    // A level plane keeps its colour: the sun stands 45° high.
    constexpr double level = 0.70710678118654752;
    std::vector<std::uint8_t> rgba(4 * raster.values.size(), 0);
    for (std::size_t cell = 0; cell < raster.values.size(); ++cell) {
        if (std::isnan(raster.values[cell])) continue;
        const Color color = color_at((raster.values[cell] - lowest_m) / range);
        const double light = ambient + (1 - ambient) * shade[cell] / level;
        for (int i = 0; i < 3; ++i) {
            rgba[4 * cell + i] = static_cast<std::uint8_t>(std::lround(std::min(255.0, color[i] * light)));
        }
        rgba[4 * cell + 3] = 255;
    }
    return rgba;
}

}  // namespace thalweg::study
