// SPDX-License-Identifier: GPL-3.0-or-later
#include "thalweg/study/growth_dials.hpp"

#include <algorithm>
#include <catch2/catch.hpp>
#include <cmath>

#include "support/basins.hpp"
#include "thalweg/core/error.hpp"
#include "thalweg/core/parallel.hpp"
#include "thalweg/grow/elevations.hpp"
#include "thalweg/grow/valleys.hpp"
#include "thalweg/study/fit_growth.hpp"
#include "thalweg/study/grow.hpp"

using namespace thalweg;
using namespace thalweg::study;

namespace {

/// Dials well within their ranges.
grow::Dials drawn_dials(std::uint64_t seed) {
    Random random(seed, 5);
    grow::Dials dials;
    dials.channel_maintenance_m = 1000;
    dials.mean_junction = 0.3 + 0.4 * random.uniform();
    dials.delta_junction = 0.1 + 0.3 * random.uniform();
    dials.mean_length = 0.4 + 0.4 * random.uniform();
    dials.delta_length = 0.05 + 0.25 * random.uniform();
    dials.sidewall_angle_deg = 15 + 20 * random.uniform();
    dials.delta_sidewall_angle_deg = 10 * random.uniform();
    dials.lower_bias = random.uniform();
    dials.middle_bias = random.uniform();
    dials.flint.q = -0.4 - 0.4 * random.uniform();
    dials.seed = 1000 + seed;
    dials.divides = grow::Divides::shares;
    for (auto* divide : {&dials.divide_across, &dials.divide_below, &dials.divide_above}) {
        *divide = {.mean = 0.4 + 0.2 * random.uniform(), .delta = 0.1 + 0.2 * random.uniform()};
    }
    return dials;
}

channel::GrowthMeasures grown_measures(const grow::Basin& basin, const grow::Dials& dials) {
    const grow::Network network = grow::grow(basin, dials).network;
    return grow::growth_measures(network, grow::elevations(network, dials.flint, basin.base_level_m));
}

std::array<double, 8> matched(const grow::Dials& d) {
    return {d.mean_junction,      d.delta_junction,           d.mean_length, d.delta_length,
            d.sidewall_angle_deg, d.delta_sidewall_angle_deg, d.lower_bias,  d.middle_bias};
}

}  // namespace

TEST_CASE("Dials found on grown networks are those put in, within their stated errors") {
    const grow::Basin basin = support::square_basin(10000);
    constexpr int trials = 6;
    int covered = 0;
    std::array<double, 8> squares{};
    for (std::uint64_t seed = 1; seed <= trials; ++seed) {
        const grow::Dials truth = drawn_dials(seed);
        const DialsFit fit = fit_dials(basin, grown_measures(basin, truth), 7 * seed);
        CHECK(fit.dials.channel_maintenance_m == Approx(1000).epsilon(0.01));
        CHECK(fit.dials.flint.p == Approx(truth.flint.p).epsilon(0.01));
        CHECK(fit.dials.flint.q == Approx(truth.flint.q).margin(0.01));
        REQUIRE(fit.table.size() == 17);
        const auto put_in = matched(truth), found = matched(fit.dials);
        for (std::size_t i = 0; i < put_in.size(); ++i) {
            const double error = fit.table[3 + i].value.standard_error;
            covered += std::abs(found[i] - put_in[i]) < 1.96 * error;
            squares[i] += std::pow((found[i] - put_in[i]) / error, 2);
        }
    }
    CHECK(covered >= 0.85 * 8 * trials);
    for (std::size_t i = 0; i < squares.size(); ++i) {
        INFO(i);
        CHECK(std::sqrt(squares[i] / trials) < 2);
    }
}

TEST_CASE("Networks grown with fitted dials measure like the one that was measured") {
    const grow::Basin basin = support::square_basin(10000);
    const grow::Dials truth = drawn_dials(3);
    const DialsFit fit = fit_dials(basin, grown_measures(basin, truth), 1);
    for (const MeasureCheck& check : fit.check) {
        INFO(check.name);
        const double close = 3e-3 * std::abs(check.measured);  // what the dials set outright has no spread
        CHECK(std::abs(check.measured - check.grown_mean) < 3.5 * check.grown_sd + close);
    }
}

TEST_CASE("Dials are fitted by the rules that networks are to grow by") {
    const grow::Basin basin = support::square_basin(6000);
    grow::Dials truth = drawn_dials(3);
    truth.upstream_link = grow::UpstreamLink::turns;
    const auto measures = grown_measures(basin, truth);
    const DialsFit fit = fit_dials(basin, measures, 1, {.upstream_link = truth.upstream_link});
    CHECK(fit.dials.upstream_link == grow::UpstreamLink::turns);
    CHECK(fit.converged);
    const auto apart = [](const DialsFit& f) {
        double sum = 0;
        for (const MeasureCheck& c : f.check) {
            if (c.grown_sd > 0) sum += std::pow((c.measured - c.grown_mean) / c.grown_sd, 2);
        }
        return sum;
    };
    CHECK(apart(fit) < apart(fit_dials(basin, measures, 1)));
}

TEST_CASE("Fitted dials are the same for any number of threads, and others for another seed") {
    const grow::Basin basin = support::square_basin(6000);
    const auto measures = grown_measures(basin, drawn_dials(2));
    const auto with = [&](int threads, std::uint64_t seed) {
        const ThreadLimit limit(threads);
        return matched(fit_dials(basin, measures, seed).dials);
    };
    CHECK(with(1, 1) == with(3, 1));
    CHECK(with(1, 1) != with(1, 2));
}

TEST_CASE("Where no dials grow such a network the fit comes to rest, says so and tells the same for any seed") {
    const grow::Basin basin = support::square_basin(8000);
    auto measures = grown_measures(basin, drawn_dials(4));
    for (auto* links : {&measures.links.exterior, &measures.links.interior}) links->mean_m *= 2;
    const DialsFit one = fit_dials(basin, measures, 1), two = fit_dials(basin, measures, 2);
    CHECK(one.converged);
    CHECK(two.converged);
    CHECK(one.reduced_chi2 > 2);
    CHECK(one.notes.back().starts_with("no dials grow"));
    CHECK(one.notes.back().find("interior_length_m") != std::string::npos);
    const auto first = matched(one.dials), second = matched(two.dials);
    for (std::size_t i = 0; i < first.size(); ++i) {
        INFO(one.table[3 + i].name);
        CHECK(std::abs(first[i] - second[i]) < one.table[3 + i].value.standard_error);
    }
}

TEST_CASE("A draw about a gentle sidewall is no wider than the angle leaves room for") {
    const grow::Basin basin = support::square_basin(8000);
    auto measures = grown_measures(basin, drawn_dials(4));
    measures.sidewall_angle_deg.mean.value = 3;
    measures.sidewall_angle_deg.delta.value = 6;
    const DialsFit fit = fit_dials(basin, measures, 1);
    const Estimate& delta = fit.table[8].value;
    REQUIRE(fit.table[8].name == "delta_sidewall_angle_deg");
    CHECK(delta.value == fit.dials.delta_sidewall_angle_deg);
    CHECK(delta.value == Approx(fit.dials.sidewall_angle_deg - 1));
    CHECK(delta.interval95[1] <= delta.value);
    CHECK(std::ranges::any_of(fit.notes, [](const std::string& note) {
        return note.starts_with("delta_sidewall_angle_deg: would be wider");
    }));
}

TEST_CASE("What was not measured is left open, and what cannot be grown is said") {
    const grow::Basin basin = support::square_basin(6000);
    auto measures = grown_measures(basin, drawn_dials(2));
    measures.side_choices.obtuse[0] = {0, std::nan(""), std::nan("")};
    const DialsFit fit = fit_dials(basin, measures, 1);
    CHECK_FALSE(fit.table[9].identified);
    CHECK(fit.table[9].name == "lower_bias");
    CHECK(fit.dials.lower_bias == Approx(0.5).margin(0.15));
    auto steep = measures;
    steep.flint.exponent.value = 0.2;
    const DialsFit bent = fit_dials(basin, steep, 1);
    CHECK(bent.dials.flint.q == -0.05);
    CHECK(bent.notes.front().starts_with("flint_q"));
    auto dry = measures;
    dry.channel_maintenance_m.value = std::nan("");
    CHECK_THROWS_AS(fit_dials(basin, dry, 1), Error);
    auto level = measures;
    level.flint.coefficient.value = 0;
    CHECK_THROWS_AS(fit_dials(basin, level, 1), Error);
}

namespace {

/// What a grown terrain's raster tells, its channels beginning at its own sources.
channel::GrowthMeasures measured_on_raster(const GrownTerrain& t) {
    MeasureOptions options = measure_options(t);
    options.heads = grown_heads(t);
    options.channels = ChannelRule::heads;
    return growth_measures(t.elevation, measure_raster(t.elevation, options));
}

/// Mean shares of the divides across from, below and above tributaries, on the rasters of several grown terrains.
std::array<double, 3> divides_on_rasters(const std::array<double, 3>& drawn) {
    constexpr int seeds = 6;
    std::array<double, 3> sum{};
    for (std::uint64_t seed = 1; seed <= seeds; ++seed) {
        Experiment e;
        e.seed = seed;
        e.growth.channel_maintenance_m = 1000;
        e.growth.dials.divides = grow::Divides::shares;
        e.growth.dials.divide_across.mean = drawn[0];
        e.growth.dials.divide_below.mean = drawn[1];
        e.growth.dials.divide_above.mean = drawn[2];
        e.output.resolution = 600;
        const GrownTerrain t =
            grown_terrain(e, {.basin = support::square_basin(12000), .crs_wkt = "", .warnings = {}}, {});
        const auto m = measured_on_raster(t).divides;
        for (std::size_t i = 0; const auto* divide : {&m.across, &m.below, &m.above}) {
            CHECK(divide->share.count > 0.95 * t.growth.network.junctions.size());
            sum[i++] += divide->share.mean.value / seeds;
        }
    }
    return sum;
}

}  // namespace

TEST_CASE("Divides drawn where water parts are measured on the terrain's raster within 0.04 of their angle") {
    // On these slopes (Flint's p of 0.1, sidewalls of 25°) water that arrives at a junction comes from a little
    // upstream.
    const std::array drawn{0.6, 0.55, 0.47};
    const auto measured = divides_on_rasters(drawn);
    for (std::size_t i = 0; i < 3; ++i) {
        INFO(i);
        CHECK(measured[i] == Approx(drawn[i]).margin(0.04));
    }
    // A divide between two rivers that meet is a crest and goes where it was put; along the others water runs.
    CHECK(divides_on_rasters({0.6, 0.55, 0.6})[2] > measured[2] + 0.04);
}

TEST_CASE("The reach of valley sides that a terrain was grown with is found on its raster, up to half too large") {
    double sum = 0;
    constexpr int seeds = 4;
    for (std::uint64_t seed = 1; seed <= seeds; ++seed) {
        Experiment e;
        e.seed = seed;
        e.growth.channel_maintenance_m = 1500;
        e.growth.dials.delta_sidewall_angle_deg = 0;
        e.growth.sidewall_reach_m = 500;
        e.output.resolution = 600;
        const GrownTerrain t =
            grown_terrain(e, {.basin = support::square_basin(12000), .crs_wkt = "", .warnings = {}}, {});
        const auto m = measured_on_raster(t);
        CHECK(m.farthest_ridges_m > 1000);
        sum += m.sidewall_reach_m.value / seeds;
    }
    // The surface is smooth where the sides have a bend, and water arrives farther down than straight across.
    CHECK(sum > 500);
    CHECK(sum < 750);
}

TEST_CASE("Dials have the reach of valley sides that was measured, and none where none was") {
    const grow::Basin basin = support::square_basin(6000);
    auto measures = grown_measures(basin, drawn_dials(2));
    CHECK(std::isinf(fit_dials(basin, measures, 1).dials.sidewall_reach_m));
    measures.farthest_ridges_m = 900;
    const auto reach_of = [&](const Estimate& measured) {
        measures.sidewall_reach_m = measured;
        const DialsFit fit = fit_dials(basin, measures, 1);
        CHECK(fit.dials.sidewall_reach_m == measured.value);
        const auto row = std::ranges::find(fit.table, "sidewall_reach_m", &FittedDial::name);
        REQUIRE(row != fit.table.end());
        CHECK(row->value.standard_error == measured.standard_error);
        const auto about = [](const std::string& note) { return note.starts_with("sidewall_reach_m"); };
        CHECK(std::ranges::any_of(fit.notes, about) == (measured.interval95[1] > 900));
        return *row;
    };
    const FittedDial seen = reach_of({700, 30, {641, 759}});
    CHECK(seen.identified);
    CHECK(seen.value.interval95 == std::array<double, 2>{641, 759});
    const FittedDial maybe_farther = reach_of({700, 400, {-84, 1484}});
    CHECK(maybe_farther.identified);
    CHECK(maybe_farther.value.interval95 == std::array<double, 2>{0, 900});
    const FittedDial as_far_as_ridges = reach_of({900, 30, {841, 959}});
    CHECK(!as_far_as_ridges.identified);
    CHECK(std::isnan(as_far_as_ridges.value.interval95[1]));
}

TEST_CASE("What is measured on a grown tree is measured on its raster too, where its sources are known") {
    constexpr int seeds = 4;
    std::array<double, 9> tree{}, raster{};
    for (std::uint64_t seed = 1; seed <= seeds; ++seed) {
        Experiment e;
        e.seed = seed;
        e.growth.channel_maintenance_m = 1000;
        e.output.resolution = 600;
        const GrownTerrain t = grown_terrain(e, {.basin = support::square_basin(12000)}, {});
        const auto add = [&](const channel::GrowthMeasures& m, std::array<double, 9>& sum) {
            const std::array values{
                m.channel_maintenance_m.value / 1000,  m.junction_places.mean.value,   m.junction_places.delta.value,
                m.sidewall_angle_deg.mean.value / 100, m.side_choices.obtuse[0].value, m.side_choices.opposite[1].value,
                m.headward_reach.mean.value,           m.flint.exponent.value,         m.links.exterior.mean_m / 1000};
            for (std::size_t i = 0; i < values.size(); ++i) sum[i] += values[i] / seeds;
        };
        add(grow::growth_measures(t.growth.network, grow::elevations(t.growth.network, t.dials.flint, 100)), tree);
        add(measured_on_raster(t), raster);
    }
    // Ways to the divide come out short on a raster, where rivers join later than their lines do.
    const std::array<double, 9> close{0.05, 0.05, 0.06, 0.06, 0.12, 0.12, 0.15, 0.1, 0.1};
    for (std::size_t i = 0; i < close.size(); ++i) {
        INFO(i);
        CHECK(raster[i] == Approx(tree[i]).margin(close[i]));
    }
}
