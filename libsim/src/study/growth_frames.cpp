// SPDX-License-Identifier: GPL-3.0-or-later
#include "study/growth_frames.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <iterator>

#include "thalweg/core/error.hpp"
#include "thalweg/study/output_folder.hpp"

namespace thalweg::study {
namespace {

constexpr double longer_side = 1000;  // pixels
constexpr double margin = 20;
constexpr Index most_links = 100000;

/// From the plane's metres to pixels, north up.
struct Sheet {
    double west, north, pixels_per_m, width, height;

    Point place(const Point& p) const {
        return {margin + (p.x - west) * pixels_per_m, margin + (north - p.y) * pixels_per_m};
    }
};

Sheet sheet_of(const grow::Network& network) {
    const auto by_x = [](const Point& a, const Point& b) { return a.x < b.x; };
    const auto by_y = [](const Point& a, const Point& b) { return a.y < b.y; };
    const auto [west, east] = std::minmax_element(network.vertices.begin(), network.vertices.end(), by_x);
    const auto [south, north] = std::minmax_element(network.vertices.begin(), network.vertices.end(), by_y);
    const double width = east->x - west->x, height = north->y - south->y;
    const double scale = (longer_side - 2 * margin) / std::max(width, height);
    return {west->x, north->y, scale, width * scale + 2 * margin, height * scale + 2 * margin};
}

void add_polygons(const grow::Network& network, const Sheet& sheet, grow::Side side, std::string& svg) {
    svg += fmt::format("<g class=\"{}\" fill=\"{}\">\n", side == grow::Side::left ? "left" : "right",
                       side == grow::Side::left ? "#e8ecd9" : "#d3dcbd");
    for (Index link = 0; link < network.size(); ++link) {
        svg += "<polygon points=\"";
        for (const Index vertex : network.polygon(link, side)) {
            const Point p = sheet.place(network.vertices[vertex]);
            fmt::format_to(std::back_inserter(svg), "{:.2f},{:.2f} ", p.x, p.y);
        }
        svg.back() = '"';
        svg += "/>\n";
    }
    svg += "</g>\n";
}

void add_line(const Point& from, const Point& to, std::string& svg) {
    fmt::format_to(std::back_inserter(svg), "M{:.2f} {:.2f}L{:.2f} {:.2f}", from.x, from.y, to.x, to.y);
}

void add_edges(const grow::Network& network, const Sheet& sheet, grow::EdgeKind kind, const char* style,
               std::string& svg) {
    svg += fmt::format("<path {} d=\"", style);
    for (const grow::Edge& edge : network.edges) {
        if (edge.kind != kind) continue;
        add_line(sheet.place(network.vertices[edge.from]), sheet.place(network.vertices[edge.to]), svg);
    }
    svg += "\"/>\n";
}

void add_channels(const grow::Network& network, const Sheet& sheet, Index new_from, std::string& svg) {
    svg += "<g class=\"channels\" fill=\"none\" stroke-linecap=\"round\">\n";
    for (Index link = 0; link < network.size(); ++link) {
        svg += fmt::format("<path stroke=\"{}\" stroke-width=\"{:.2f}\" d=\"",
                           network.stream[link] < new_from ? "#1f5f99" : "#c8402f", std::cbrt(network.magnitude[link]));
        add_line(sheet.place(network.vertices[network.lower[link]]), sheet.place(network.vertices[network.upper[link]]),
                 svg);
        svg += "\"/>\n";
    }
    svg += "</g>\n";
}

}  // namespace

std::vector<Index> links_shown(Index links, Index frames) {
    if (links > most_links) {
        throw Error(
            fmt::format("output.frames: {} links are too many to be drawn, {} at most; ask for no frames, or "
                        "for a larger growth.channel_maintenance_m",
                        links, most_links));
    }
    std::vector<Index> shown;
    for (Index frame = 0; frame < frames; ++frame) {
        const double share = frames > 1 ? static_cast<double>(frame) / (frames - 1) : 1;
        const auto count = frame + 1 == frames ? links : static_cast<Index>(std::pow(links, share));
        if (shown.empty() || count > shown.back()) shown.push_back(count);
    }
    return shown;
}

std::string plan_of(const grow::Network& network, Index new_from) {
    const Sheet sheet = sheet_of(network);
    std::string svg = fmt::format(
        "<svg xmlns=\"http://www.w3.org/2000/svg\" width=\"{0:.0f}\" height=\"{1:.0f}\" viewBox=\"0 0 {0:.0f} "
        "{1:.0f}\">\n"
        "<title>{2} links, {3} sources</title>\n<rect width=\"100%\" height=\"100%\" fill=\"#ffffff\"/>\n",
        sheet.width, sheet.height, network.size(), network.magnitude[0]);
    for (const auto side : {grow::Side::left, grow::Side::right}) add_polygons(network, sheet, side, svg);
    add_edges(network, sheet, grow::EdgeKind::divide, "fill=\"none\" stroke=\"#a08c6c\" stroke-width=\"0.5\"", svg);
    add_edges(network, sheet, grow::EdgeKind::outline, "fill=\"none\" stroke=\"#57492f\" stroke-width=\"1.5\"", svg);
    add_channels(network, sheet, new_from, svg);
    return svg + "</svg>\n";
}

Json write_frames(const GrownTerrain& t, const std::filesystem::path& folder) {
    Json frames = Json::array();
    if (t.stages.empty()) return frames;
    std::filesystem::create_directory(folder / "frames");
    Index streams = 1;  // the trunk is never new
    for (const grow::Network& network : t.stages) {
        const std::string name = fmt::format("frames/frame_{:04}.svg", frames.size() + 1);
        write_text(folder / name, plan_of(network, streams));
        streams = network.magnitude[0];  // each stream has one source
        frames.push_back({{"file", name},
                          {"links", network.size()},
                          {"sources", network.magnitude[0]},
                          {"total_length_m", grow::total_length(network)}});
    }
    return frames;
}

}  // namespace thalweg::study
