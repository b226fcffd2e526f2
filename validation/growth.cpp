// SPDX-License-Identifier: GPL-3.0-or-later
// Grown networks: their statistics beside Shreve's random model, and what an analysis of their terrain finds again.
#include <fmt/format.h>

#include <catch2/catch.hpp>
#include <cmath>
#include <numbers>

#include "support/basins.hpp"
#include "thalweg/channel/d8_length.hpp"
#include "thalweg/channel/horton.hpp"
#include "thalweg/channel/tokunaga.hpp"
#include "thalweg/core/statistics.hpp"
#include "thalweg/grow/elevations.hpp"
#include "thalweg/study/grow.hpp"
#include "thalweg/study/tables.hpp"
#include "thalweg/study/tree_statistics.hpp"

using namespace thalweg;

namespace {

struct Spread {
    std::vector<double> values;
    double mean() const { return thalweg::mean(values); }
    double sd() const { return standard_deviation(values); }
    std::string text() const { return fmt::format("{:.2f} ± {:.2f}", mean(), sd()); }
};

grow::Dials dials_for(double maintenance_m, grow::UpstreamLink upstream_link, std::uint64_t seed) {
    grow::Dials dials;
    dials.channel_maintenance_m = maintenance_m;
    dials.upstream_link = upstream_link;
    dials.seed = seed;
    return dials;
}

const char* name_of(grow::UpstreamLink rule) { return rule == grow::UpstreamLink::turns ? "turns" : "keeps_line"; }

/// A square basin of 10 km with links of about 150 m.
study::Experiment square_experiment(grow::UpstreamLink rule, std::uint64_t seed, double maintenance_m) {
    study::Experiment e;
    e.seed = seed;
    e.basin.outline = support::rectangle(10000, 10000);
    e.basin.trunk = std::vector<Point>{{5000, 0}, {5000, 6700}};
    e.growth.channel_maintenance_m = maintenance_m;
    e.growth.dials.upstream_link = rule;
    return e;
}

}  // namespace

TEST_CASE("Large networks beside Shreve's random model and nature, over 100 seeds", "[growth]") {
    for (const auto rule : {grow::UpstreamLink::keeps_line, grow::UpstreamLink::turns}) {
        Spread bifurcation, length, area, hack, density, q, drawn, howard;
        std::array<Spread, 3> side_tributaries;
        for (std::uint64_t seed = 1; seed <= 100; ++seed) {
            const grow::Dials dials = dials_for(120, rule, seed);
            const grow::Network network = grow::grow(support::square_basin(10000), dials).network;
            const auto tree = grow::stream_network(network, grow::elevations(network, dials.flint, 0));
            const study::TreeStatistics s = study::tree_statistics(network, tree);
            bifurcation.values.push_back(s.horton.bifurcation.regression);
            length.values.push_back(s.horton.length.regression);
            area.values.push_back(s.horton.area.regression);
            hack.values.push_back(s.laws.hack.exponent.value);
            density.values.push_back(s.channels.drainage_density_per_m * dials.channel_maintenance_m);
            q.values.push_back(s.flint_links.exponent.value);
            for (std::size_t k = 0; k < side_tributaries.size(); ++k) {
                side_tributaries[k].values.push_back(s.laws.tokunaga.pooled[k]);
            }
            const study::TributaryAngles angles = study::tributary_angles(network, dials.flint);
            drawn.values.push_back(angles.drawn_mean * 180 / std::numbers::pi);
            howard.values.push_back(angles.howard_mean * 180 / std::numbers::pi);
        }
        fmt::print(
            "growth, {}: RB {} (Shreve 4, nature 3–5), RL {} (2; 1.5–3.5), RA {} (4; 3–6), T1 {} (1; 1.2), T2 {} "
            "(2; 3), T3 {} (4; 7), Hack {} (0.5; 0.55–0.6), density over target {:.4f} to {:.4f}, E1 {} degrees, "
            "Howard's at the end {}\n",
            name_of(rule), bifurcation.text(), length.text(), area.text(), side_tributaries[0].text(),
            side_tributaries[1].text(), side_tributaries[2].text(), hack.text(), quantile(density.values, 0),
            quantile(density.values, 1), drawn.text(), howard.text());
        CHECK(quantile(density.values, 0) > 0.99);
        CHECK(quantile(density.values, 1) < 1.01);
        CHECK(std::abs(quantile(q.values, 0) + 0.6) < 1e-6);
        CHECK(std::abs(quantile(q.values, 1) + 0.6) < 1e-6);
        CHECK(bifurcation.mean() > 3);
        CHECK(bifurcation.mean() < 5);
        CHECK(area.mean() > 3);
        CHECK(area.mean() < 6);
    }
}

TEST_CASE("A grown terrain gives back its network", "[growth]") {
    for (const auto rule : {grow::UpstreamLink::keeps_line, grow::UpstreamLink::turns}) {
        Spread found, wrong, length, found_by_area, wrong_by_area;
        for (std::uint64_t seed = 1; seed <= 8; ++seed) {
            study::Experiment e = square_experiment(rule, seed, 600);
            study::GrownTerrain t =
                study::grown_terrain(e, study::growth_site(e, study::Messages{}), study::Messages{});
            // Cells of a fifteenth of the median link.
            const double median = quantile(t.growth.network.length_m, 0.5);
            e.output.resolution = static_cast<Index>(std::ceil(10000 * 15 / median));
            t = study::grown_terrain(e, t.site, study::Messages{});
            std::vector<Point> junctions;
            for (const auto& junction : t.growth.network.junctions) {
                const Point& p = t.growth.network.vertices[junction.vertex];
                junctions.push_back({p.x + t.growth.network.origin.x, p.y + t.growth.network.origin.y});
            }
            study::MeasureOptions options = study::measure_options(t);
            for (const bool by_heads : {false, true}) {
                if (by_heads) options.heads = study::grown_heads(t);
                const auto m = study::measure_raster(t.elevation, options);
                const study::Recovery r =
                    study::recovery(junctions, grow::total_length(t.growth.network), m.statistics.network,
                                    study::positions(t.elevation), 2 * t.elevation.placement.cell_width);
                (by_heads ? found : found_by_area).values.push_back(100.0 * r.recovered / r.grown);
                (by_heads ? wrong : wrong_by_area).values.push_back(100.0 * r.unmatched / r.found);
                if (by_heads) length.values.push_back(r.found_length_m / channel::d8_length_factor / r.tree_length_m);
            }
        }
        fmt::print(
            "growth, {}: with heads at the grown sources {} % (least {:.1f} %) of the junctions are found within two "
            "cells, {} % (most {:.1f} %) are "
            "false, length over the tree's {:.3f} to {:.3f}; with channels from an area that gives the same length {} "
            "% "
            "and {} %\n",
            name_of(rule), found.text(), quantile(found.values, 0), wrong.text(), quantile(wrong.values, 1),
            quantile(length.values, 0), quantile(length.values, 1), found_by_area.text(), wrong_by_area.text());
        CHECK(quantile(found.values, 0) >= 95);
        CHECK(quantile(wrong.values, 1) <= 5);
        CHECK(quantile(length.values, 0) > 0.97);
        CHECK(quantile(length.values, 1) < 1.03);
    }
}
