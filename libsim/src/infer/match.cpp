// SPDX-License-Identifier: GPL-3.0-or-later
#include "thalweg/infer/match.hpp"

#include <fmt/format.h>

#include <Eigen/Dense>
#include <algorithm>
#include <cmath>
#include <limits>

#include "thalweg/core/error.hpp"
#include "thalweg/core/parallel.hpp"
#include "thalweg/core/random.hpp"

namespace thalweg::infer {
namespace {

using Matrix = Eigen::MatrixXd;
using Vector = Eigen::VectorXd;

constexpr std::uint32_t parameter_draws = 0x6d617463;
constexpr double errors_about = 3;  // half the next box, in standard errors

/// Mean and covariance of the parameters, taken as normal.
struct Belief {
    Vector mean;
    Matrix covariance;
};

Belief uniform_belief(std::span<const std::array<double, 2>> box) {
    const auto size = static_cast<Eigen::Index>(box.size());
    Belief belief{Vector(size), Matrix::Zero(size, size)};
    for (Eigen::Index i = 0; i < size; ++i) {
        const auto& [low, high] = box[static_cast<std::size_t>(i)];
        belief.mean[i] = (low + high) / 2;
        belief.covariance(i, i) = (high - low) * (high - low) / 12;
    }
    return belief;
}

/// What came of one round: a row for each outcome.
struct Round {
    Matrix parameters, statistics;
};

Round draw_round(const RandomModel& model, const MatchOptions& options, std::span<const std::array<double, 2>> box,
                 Index round) {
    std::vector<std::vector<double>> parameters(options.draws), statistics(options.draws);
    const auto draw_one = [&](Index draw) {
        const std::uint64_t number = std::uint64_t{round} * options.draws + draw;
        for (std::size_t i = 0; i < box.size(); ++i) {
            const double uniform = uniform_at(options.seed, parameter_draws, number * box.size() + i);
            parameters[draw].push_back(box[i][0] + uniform * (box[i][1] - box[i][0]));
        }
        statistics[draw] = model(parameters[draw], options.seed + number);
    };
    parallel_for(
        0, options.draws,
        [&](Index first, Index last) {
            for (Index draw = first; draw < last; ++draw) draw_one(draw);
        },
        1);
    Round drawn{Matrix(options.draws, static_cast<Eigen::Index>(box.size())),
                Matrix(options.draws, static_cast<Eigen::Index>(statistics.front().size()))};
    for (Index draw = 0; draw < options.draws; ++draw) {
        drawn.parameters.row(draw) = Eigen::Map<const Vector>(parameters[draw].data(), drawn.parameters.cols());
        drawn.statistics.row(draw) = Eigen::Map<const Vector>(statistics[draw].data(), drawn.statistics.cols());
    }
    return drawn;
}

/// The statistics that have a target and that most outcomes have.
std::vector<Eigen::Index> statistics_in_use(const Round& drawn, std::span<const double> target) {
    constexpr double most = 0.9;
    std::vector<Eigen::Index> used;
    for (Eigen::Index k = 0; k < drawn.statistics.cols(); ++k) {
        const auto known = (drawn.statistics.col(k).array() == drawn.statistics.col(k).array()).count();
        const bool is_usual = static_cast<double>(known) >= most * static_cast<double>(drawn.statistics.rows());
        if (is_usual && !std::isnan(target[static_cast<std::size_t>(k)])) used.push_back(k);
    }
    return used;
}

/// The outcomes that have all statistics in use, and those alone.
Round whole_outcomes(const Round& drawn, const std::vector<Eigen::Index>& used) {
    std::vector<Eigen::Index> rows;
    for (Eigen::Index row = 0; row < drawn.statistics.rows(); ++row) {
        if (!drawn.statistics(row, used).hasNaN()) rows.push_back(row);
    }
    return {drawn.parameters(rows, Eigen::all), drawn.statistics(rows, used)};
}

/// Expected statistics near the middle of a box: a constant, slopes and products of the parameters.
class Response {
  public:
    explicit Response(const Round& round) : middle_(round.parameters.colwise().mean()) {
        const auto rows = round.parameters.rows();
        Matrix design(rows, terms());
        for (Eigen::Index row = 0; row < rows; ++row) design.row(row) = terms_at(round.parameters.row(row));
        coefficients_ = design.colPivHouseholderQr().solve(round.statistics);
        const Matrix residuals = round.statistics - design * coefficients_;
        scatter_ = residuals.transpose() * residuals / static_cast<double>(rows - terms());
    }

    const Matrix& scatter() const { return scatter_; }

    Vector at(const Vector& parameters) const { return coefficients_.transpose() * terms_at(parameters); }

    /// Rows: statistics; columns: parameters.
    Matrix slopes_at(const Vector& parameters) const {
        const auto size = middle_.size();
        const Vector away = parameters - middle_;
        Matrix slopes = coefficients_.middleRows(1, size).transpose();
        for (Eigen::Index i = 0, term = 1 + size; i < size; ++i) {
            for (Eigen::Index j = i; j < size; ++j, ++term) {
                slopes.col(i) += away[j] * coefficients_.row(term).transpose();
                slopes.col(j) += away[i] * coefficients_.row(term).transpose();
            }
        }
        return slopes;
    }

    static Eigen::Index terms(Eigen::Index size) { return 1 + size + size * (size + 1) / 2; }

  private:
    Eigen::Index terms() const { return terms(middle_.size()); }

    Vector terms_at(const Vector& parameters) const {
        const auto size = middle_.size();
        const Vector away = parameters - middle_;
        Vector values(terms());
        values[0] = 1;
        values.segment(1, size) = away;
        for (Eigen::Index i = 0, term = 1 + size; i < size; ++i) {
            for (Eigen::Index j = i; j < size; ++j) values[term++] = away[i] * away[j];
        }
        return values;
    }

    Vector middle_;
    Matrix coefficients_, scatter_;
};

void check_enough(const Round& round, Index draws) {
    const auto needed = 3 * Response::terms(round.parameters.cols()) / 2;
    if (round.parameters.rows() >= needed) return;
    throw Error(
        fmt::format("only {} of {} outcomes of the model have all the statistics that were measured, and {} are needed",
                    round.parameters.rows(), draws, needed));
}

void keep_in(std::span<const std::array<double, 2>> box, Vector& parameters) {
    for (std::size_t i = 0; i < box.size(); ++i) {
        double& value = parameters[static_cast<Eigen::Index>(i)];
        value = std::clamp(value, box[i][0], box[i][1]);
    }
}

/// Gauss–Newton steps, within the box that the response is known over.
Belief updated(const Belief& before, const Response& response, const Vector& target,
               std::span<const std::array<double, 2>> box) {
    constexpr int steps = 20;
    Vector at = before.mean;
    keep_in(box, at);
    Matrix gain, slopes;
    for (int step = 0; step < steps; ++step) {
        slopes = response.slopes_at(at);
        // Statistics may hang together (two shares that add up): the decomposition passes over what is doubled.
        gain = before.covariance * slopes.transpose() *
               (slopes * before.covariance * slopes.transpose() + response.scatter())
                   .completeOrthogonalDecomposition()
                   .pseudoInverse();
        at = before.mean + gain * (target - response.at(at) + slopes * (at - before.mean));
        keep_in(box, at);
    }
    return {at, before.covariance - gain * slopes * before.covariance};
}

double error_of(const Belief& belief, Eigen::Index i) { return std::sqrt(std::max(0.0, belief.covariance(i, i))); }

/// In errors of the parameters after it.
double largest_step(const Vector& mean_before, const Belief& after) {
    double largest = 0;
    for (Eigen::Index i = 0; i < mean_before.size(); ++i) {
        const double step = std::abs(after.mean[i] - mean_before[i]);
        if (step > 0) largest = std::max(largest, step / error_of(after, i));
    }
    return largest;
}

std::vector<std::array<double, 2>> box_about(const Belief& belief, std::span<const std::array<double, 2>> ranges) {
    std::vector<std::array<double, 2>> box;
    for (std::size_t i = 0; i < ranges.size(); ++i) {
        const auto& [low, high] = ranges[i];
        const auto at = static_cast<Eigen::Index>(i);
        const double half = std::min(errors_about * error_of(belief, at), (high - low) / 2);
        const double middle = std::clamp(belief.mean[at], low + half, high - half);
        box.push_back({middle - half, middle + half});
    }
    return box;
}

Match result_of(const Belief& after, const Belief& before, std::span<const std::array<double, 2>> ranges) {
    Match match{{}, {}, 0, 0, 0};
    for (std::size_t i = 0; i < ranges.size(); ++i) {
        const auto& [low, high] = ranges[i];
        const auto at = static_cast<Eigen::Index>(i);
        const double value = std::clamp(after.mean[at], low, high), error = error_of(after, at);
        match.parameters.push_back(
            {value, error, {std::max(low, value - 1.96 * error), std::min(high, value + 1.96 * error)}});
        match.identified.push_back(error <= error_of(before, at) / 2);
    }
    return match;
}

}  // namespace

Match match(const RandomModel& model, std::span<const double> target, const MatchOptions& options) {
    const Vector measured = Eigen::Map<const Vector>(target.data(), static_cast<Eigen::Index>(target.size()));
    const Belief before = uniform_belief(options.ranges);
    Belief belief = before;
    std::vector<std::array<double, 2>> box = options.ranges;
    std::vector<Eigen::Index> used;
    Index outcomes = 0, rounds = 0;
    double last_step = std::numeric_limits<double>::infinity();
    for (Index round = 0; round < options.rounds; ++round) {
        const Round all = draw_round(model, options, box, round);
        if (round == 0) used = statistics_in_use(all, target);
        if (used.empty()) break;
        const Round drawn = whole_outcomes(all, used);
        check_enough(drawn, options.draws);
        const Vector mean_before = belief.mean;
        belief = updated(before, Response(drawn), measured(used), box);
        last_step = largest_step(mean_before, belief);
        ++rounds;
        box = box_about(belief, options.ranges);
        outcomes = static_cast<Index>(drawn.parameters.rows());
    }
    Match result = result_of(belief, before, options.ranges);
    result.outcomes = outcomes;
    result.rounds = rounds;
    result.last_step = last_step;
    return result;
}

}  // namespace thalweg::infer
