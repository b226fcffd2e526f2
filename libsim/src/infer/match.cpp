// SPDX-License-Identifier: GPL-3.0-or-later
#include "thalweg/infer/match.hpp"

#include <ceres/ceres.h>
#include <fmt/format.h>

#include <Eigen/Dense>
#include <algorithm>
#include <cmath>
#include <limits>

#include "infer/quiet_ceres.hpp"
#include "thalweg/core/error.hpp"
#include "thalweg/core/parallel.hpp"
#include "thalweg/core/random.hpp"
#include "thalweg/core/statistics.hpp"

namespace thalweg::infer {
namespace {

using Matrix = Eigen::MatrixXd;
using Vector = Eigen::VectorXd;
using Box = std::vector<std::array<double, 2>>;

constexpr std::uint32_t parameter_draws = 0x6d617463;
constexpr double settled_step = 0.3;    // standard errors
constexpr Index rounds_at_rest = 2;     // in a row
constexpr double least_scatter = 1e-6;  // of a statistic, in its standard deviations over the first box
constexpr double misfit = 2;            // reduced chi2 above which intervals are Student's, for few degrees tell it
constexpr double errors_about = 3;      // half the next box, in standard errors

/// Mean and covariance of the parameters, taken as normal.
struct Belief {
    Vector mean;
    Matrix covariance;
    double reduced_chi2 = std::numeric_limits<double>::quiet_NaN();
    double degrees_of_freedom = 0;
};

Belief uniform_belief(const Box& box) {
    const auto size = static_cast<Eigen::Index>(box.size());
    Belief belief{.mean = Vector(size), .covariance = Matrix::Zero(size, size)};
    for (Eigen::Index i = 0; i < size; ++i) {
        const auto& [low, high] = box[static_cast<std::size_t>(i)];
        belief.mean[i] = (low + high) / 2;
        belief.covariance(i, i) = (high - low) * (high - low) / 12;
    }
    return belief;
}

/// A row for each outcome of the model.
struct Outcomes {
    Matrix parameters, statistics;
};

Outcomes draw_round(const RandomModel& model, const MatchOptions& options, const Box& box, Index round) {
    std::vector<std::vector<double>> parameters(options.draws), statistics(options.draws);
    const auto draw_one = [&](Index draw) {
        const std::uint64_t number = std::uint64_t{round} * options.draws + draw;
        for (std::size_t i = 0; i < box.size(); ++i) {
            const double uniform = uniform_at(options.seed, parameter_draws, number * box.size() + i);
            parameters[draw].push_back(box[i][0] + uniform * (box[i][1] - box[i][0]));
        }
        statistics[draw] = model(parameters[draw], options.seed + number);
        for (double& s : statistics[draw]) {
            if (!std::isfinite(s)) s = std::numeric_limits<double>::quiet_NaN();
        }
    };
    parallel_for(
        0, options.draws,
        [&](Index first, Index last) {
            for (Index draw = first; draw < last; ++draw) draw_one(draw);
        },
        1);
    Outcomes drawn{Matrix(options.draws, static_cast<Eigen::Index>(box.size())),
                   Matrix(options.draws, static_cast<Eigen::Index>(statistics.front().size()))};
    for (Index draw = 0; draw < options.draws; ++draw) {
        drawn.parameters.row(draw) = Eigen::Map<const Vector>(parameters[draw].data(), drawn.parameters.cols());
        drawn.statistics.row(draw) = Eigen::Map<const Vector>(statistics[draw].data(), drawn.statistics.cols());
    }
    return drawn;
}

/// Standard deviation of what is known of a statistic; 0 for one that is the same, but for rounding, whatever the draw.
double spread_of(const Matrix& statistics, Eigen::Index k) {
    constexpr double rounding = 1e-9;
    std::vector<double> known;
    for (const double s : statistics.col(k)) {
        if (!std::isnan(s)) known.push_back(s);
    }
    if (known.size() < 2) return 0;
    const auto [least, most] = std::ranges::minmax(known);
    const double spread = standard_deviation(known);
    return spread > rounding * std::max(std::abs(least), std::abs(most)) ? spread : 0;
}

/// The statistics that have a target, that most outcomes have and that are not all the same.
std::vector<Eigen::Index> statistics_in_use(const Outcomes& drawn, std::span<const double> target) {
    constexpr double most = 0.9;
    std::vector<Eigen::Index> used;
    for (Eigen::Index k = 0; k < drawn.statistics.cols(); ++k) {
        const auto known = (drawn.statistics.col(k).array() == drawn.statistics.col(k).array()).count();
        const bool is_usual = static_cast<double>(known) >= most * static_cast<double>(drawn.statistics.rows());
        const bool has_target = std::isfinite(target[static_cast<std::size_t>(k)]);
        if (is_usual && has_target && spread_of(drawn.statistics, k) > 0) used.push_back(k);
    }
    return used;
}

/// Adds the outcomes that have all statistics in use, and those alone.
void add_whole(const Outcomes& drawn, const std::vector<Eigen::Index>& used, Outcomes& all) {
    std::vector<Eigen::Index> rows;
    for (Eigen::Index row = 0; row < drawn.statistics.rows(); ++row) {
        if (!drawn.statistics(row, used).hasNaN()) rows.push_back(row);
    }
    const Eigen::Index before = all.parameters.rows(), more = static_cast<Eigen::Index>(rows.size());
    all.parameters.conservativeResize(before + more, drawn.parameters.cols());
    all.statistics.conservativeResize(before + more, static_cast<Eigen::Index>(used.size()));
    all.parameters.bottomRows(more) = drawn.parameters(rows, Eigen::all);
    all.statistics.bottomRows(more) = drawn.statistics(rows, used);
}

/// Of all rounds: given its parameters, an outcome does not depend on what they were drawn from.
Outcomes within(const Box& box, const Outcomes& all) {
    std::vector<Eigen::Index> rows;
    for (Eigen::Index row = 0; row < all.parameters.rows(); ++row) {
        bool is_inside = true;
        for (std::size_t i = 0; i < box.size() && is_inside; ++i) {
            const double value = all.parameters(row, static_cast<Eigen::Index>(i));
            is_inside = box[i][0] <= value && value <= box[i][1];
        }
        if (is_inside) rows.push_back(row);
    }
    return {all.parameters(rows, Eigen::all), all.statistics(rows, Eigen::all)};
}

/// Expected statistics near the middle of a box: a constant, slopes and products of the parameters.
class Response {
  public:
    /// `least_variance`: of statistics that a regression explains but for rounding.
    Response(const Outcomes& outcomes, const Vector& least_variance) : middle_(outcomes.parameters.colwise().mean()) {
        const auto rows = outcomes.parameters.rows();
        Matrix design(rows, terms());
        for (Eigen::Index row = 0; row < rows; ++row) design.row(row) = terms_at(outcomes.parameters.row(row));
        coefficients_ = design.colPivHouseholderQr().solve(outcomes.statistics);
        const Matrix residuals = outcomes.statistics - design * coefficients_;
        scatter_ = residuals.transpose() * residuals / static_cast<double>(rows - terms());
        scatter_ += least_variance.asDiagonal();
        terms_covariance_ = (design.transpose() * design).completeOrthogonalDecomposition().pseudoInverse();
    }

    /// Of single outcomes about their mean.
    const Matrix& scatter() const { return scatter_; }

    /// How far the mean itself may be off, for it comes from so many outcomes only: its variance over the scatter's.
    double uncertainty_at(const Vector& parameters) const {
        const Vector terms = terms_at(parameters);
        return terms.dot(terms_covariance_ * terms);
    }

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
    Matrix coefficients_, scatter_, terms_covariance_;
};

void check_enough(const Outcomes& outcomes, Index draws) {
    const auto needed = 3 * Response::terms(outcomes.parameters.cols()) / 2;
    if (outcomes.parameters.rows() >= needed) return;
    throw Error(
        fmt::format("only {} of {} outcomes of the model have all the statistics that were measured, and {} are needed",
                    outcomes.parameters.rows(), draws, needed));
}

/// Rows W with WᵀW the inverse of a covariance; statistics may hang together (two shares that add up): what is doubled
/// is passed over.
Matrix whitener(const Matrix& covariance) {
    constexpr double same = 1e-9;
    const Vector scale = covariance.diagonal().cwiseMax(1e-300).cwiseSqrt().cwiseInverse();
    const Matrix correlation = scale.asDiagonal() * covariance * scale.asDiagonal();
    const Eigen::SelfAdjointEigenSolver<Matrix> parts(correlation);
    std::vector<Eigen::Index> kept;
    for (Eigen::Index i = 0; i < parts.eigenvalues().size(); ++i) {
        if (parts.eigenvalues()[i] > same) kept.push_back(i);
    }
    const Vector sizes = parts.eigenvalues()(kept).cwiseSqrt().cwiseInverse();
    return sizes.asDiagonal() * parts.eigenvectors()(Eigen::all, kept).transpose() * scale.asDiagonal();
}

/// Residuals of the statistics, and of the parameters against what is thought of them beforehand.
class Distance : public ceres::CostFunction {
  public:
    Distance(const Belief& before, const Response& response, const Vector& target, const Matrix& whitening)
        : before_(before),
          response_(response),
          target_(target),
          whitening_(whitening),
          looseness_(before.covariance.diagonal().cwiseSqrt().cwiseInverse()) {
        set_num_residuals(static_cast<int>(whitening.rows() + before.mean.size()));
        mutable_parameter_block_sizes()->push_back(static_cast<int>(before.mean.size()));
    }

    bool Evaluate(double const* const* parameters, double* residuals, double** jacobians) const override {
        const auto size = before_.mean.size();
        const Vector at = Eigen::Map<const Vector>(parameters[0], size);
        Eigen::Map<Vector> all(residuals, num_residuals());
        all.head(whitening_.rows()) = whitening_ * (target_ - response_.at(at));
        all.tail(size) = looseness_.cwiseProduct(before_.mean - at);
        if (jacobians == nullptr || jacobians[0] == nullptr) return true;
        Eigen::Map<Eigen::Matrix<double, Eigen::Dynamic, Eigen::Dynamic, Eigen::RowMajor>> slopes(
            jacobians[0], num_residuals(), size);
        slopes.topRows(whitening_.rows()) = -whitening_ * response_.slopes_at(at);
        slopes.bottomRows(size) = -Matrix(looseness_.asDiagonal());
        return true;
    }

  private:
    const Belief& before_;
    const Response& response_;
    const Vector& target_;
    const Matrix& whitening_;
    Vector looseness_;
};

/// The parameters of least distance within a box.
Vector nearest(const Belief& before, const Response& response, const Vector& target, const Box& box, Vector start) {
    const Matrix whitening = whitener(response.scatter());
    ceres::Problem problem;
    problem.AddResidualBlock(new Distance(before, response, target, whitening), nullptr, start.data());
    for (std::size_t i = 0; i < box.size(); ++i) {
        const auto at = static_cast<int>(i);
        start[at] = std::clamp(start[at], box[i][0], box[i][1]);
        problem.SetParameterLowerBound(start.data(), at, box[i][0]);
        problem.SetParameterUpperBound(start.data(), at, box[i][1]);
    }
    ceres::Solver::Options settings;
    settings.linear_solver_type = ceres::DENSE_QR;
    settings.num_threads = 1;
    settings.logging_type = ceres::SILENT;
    settings.max_num_iterations = 200;
    settings.function_tolerance = 1e-12;
    settings.parameter_tolerance = 1e-10;
    ceres::Solver::Summary summary;
    keep_ceres_quiet();
    ceres::Solve(settings, &problem, &summary);
    return start;
}

/// Covariance (RᵀΣ⁻¹R + V⁻¹)⁻¹, Σ what an outcome and its mean scatter, times χ²/ν where the statistics lie farther off
/// than that: ν their number less those that the parameters take up.
Belief believed(Vector at, const Belief& before, const Response& response, const Vector& target) {
    constexpr int most_turns = 100;
    const Matrix whitening = whitener((1 + response.uncertainty_at(at)) * response.scatter());
    const Matrix slopes = whitening * response.slopes_at(at);
    const Matrix information = slopes.transpose() * slopes;
    const Matrix inverse_before = before.covariance.inverse();
    const double chi2 = (whitening * (target - response.at(at))).squaredNorm();
    Belief after{.mean = std::move(at), .covariance = {}};
    double excess = 1;
    for (int turn = 0; turn < most_turns; ++turn) {
        after.covariance = (information / excess + inverse_before).inverse();
        const double taken_up = (information * after.covariance).trace() / excess;
        after.degrees_of_freedom = static_cast<double>(whitening.rows()) - taken_up;
        after.reduced_chi2 = chi2 / after.degrees_of_freedom;
        const double next = std::max(1.0, after.reduced_chi2);
        if (std::abs(next - excess) < 1e-6 * excess) break;
        excess = next;
    }
    return after;
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

Box box_about(const Belief& belief, const Box& ranges) {
    Box box;
    for (std::size_t i = 0; i < ranges.size(); ++i) {
        const auto& [low, high] = ranges[i];
        const auto at = static_cast<Eigen::Index>(i);
        const double half = std::min(errors_about * error_of(belief, at), (high - low) / 2);
        const double middle = std::clamp(belief.mean[at], low + half, high - half);
        box.push_back({middle - half, middle + half});
    }
    return box;
}

Match result_of(const Belief& after, const Belief& before, const Box& ranges) {
    Match match{.parameters = {}, .identified = {}};
    const double width = after.reduced_chi2 > misfit ? student_t95(std::max(2.0, after.degrees_of_freedom)) : 1.96;
    for (std::size_t i = 0; i < ranges.size(); ++i) {
        const auto& [low, high] = ranges[i];
        const auto at = static_cast<Eigen::Index>(i);
        const double value = std::clamp(after.mean[at], low, high), error = error_of(after, at);
        match.parameters.push_back(
            {value, error, {std::max(low, value - width * error), std::min(high, value + width * error)}});
        match.identified.push_back(error <= error_of(before, at) / 2);
    }
    return match;
}

}  // namespace

Match match(const RandomModel& model, std::span<const double> target, const MatchOptions& options) {
    for (const auto& [low, high] : options.ranges) {
        if (!(low < high)) throw Error(fmt::format("a parameter cannot be looked for between {} and {}", low, high));
    }
    const Belief before = uniform_belief(options.ranges);
    Belief belief = before;
    Box box = options.ranges;
    std::vector<Eigen::Index> used;
    Outcomes all;
    Vector measured, least_variance;
    Index rounds = 0, at_rest = 0;
    double last_step = std::numeric_limits<double>::infinity();
    while (rounds < options.most_rounds && at_rest < rounds_at_rest) {
        const Outcomes drawn = draw_round(model, options, box, rounds);
        if (rounds == 0) {
            used = statistics_in_use(drawn, target);
            if (used.empty()) break;
            least_variance.resize(static_cast<Eigen::Index>(used.size()));
            for (Eigen::Index i = 0; i < least_variance.size(); ++i) {
                least_variance[i] =
                    std::pow(least_scatter * spread_of(drawn.statistics, used[static_cast<std::size_t>(i)]), 2);
            }
            measured = Eigen::Map<const Vector>(target.data(), static_cast<Eigen::Index>(target.size()))(used);
        }
        add_whole(drawn, used, all);
        const Outcomes near = within(box, all);
        check_enough(near, options.draws);
        const Response response(near, least_variance);
        const Vector mean_before = belief.mean;
        belief = believed(nearest(before, response, measured, box, belief.mean), before, response, measured);
        last_step = largest_step(mean_before, belief);
        at_rest = last_step <= settled_step ? at_rest + 1 : 0;
        ++rounds;
        box = box_about(belief, options.ranges);
    }
    Match result = result_of(belief, before, options.ranges);
    result.outcomes = static_cast<Index>(all.parameters.rows());
    result.rounds = rounds;
    result.last_step = last_step;
    result.has_settled = at_rest == rounds_at_rest;
    result.reduced_chi2 = belief.reduced_chi2;
    result.degrees_of_freedom = belief.degrees_of_freedom;
    return result;
}

}  // namespace thalweg::infer
