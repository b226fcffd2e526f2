// SPDX-License-Identifier: GPL-3.0-or-later
#include "thalweg/infer/slope_area_fit.hpp"

#include <ceres/ceres.h>
#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <limits>

#include "infer/quiet_ceres.hpp"
#include "thalweg/core/error.hpp"

namespace thalweg::infer {

namespace {

using channel::SlopeAreaBin;

constexpr double nan = std::numeric_limits<double>::quiet_NaN();
constexpr Estimate unknown{nan, nan, {nan, nan}};

/// The bins in logarithms, centred at the reference area.
struct Target {
    double log_reference_area = 0;
    std::vector<double> x;      ///< ln(A/A0)
    std::vector<double> y;      ///< ln S
    std::vector<double> error;  ///< standard error of y
};

/// Parameters a = ln(k·A0^m/u) and m, and their covariance.
struct Solution {
    double a = 0, m = 0;
    double variance_a = 0, variance_m = 0, covariance = 0;
    double cost = 0;        ///< sum of the (robust) squared residuals
    double loss_width = 0;  ///< residuals beyond it count linearly
    int iterations = 0;
    bool converged = false;
    std::string message;
};

/// Residual (ln S − (−a − m·x)/n) / error.
class LogSlopeResidual : public ceres::SizedCostFunction<1, 1, 1> {
  public:
    LogSlopeResidual(double x, double y, double error, double n) : x_(x), y_(y), scale_(1 / error), n_(n) {}

    bool Evaluate(double const* const* parameters, double* residuals, double** jacobians) const override {
        residuals[0] = scale_ * (y_ + (parameters[0][0] + parameters[1][0] * x_) / n_);
        if (jacobians == nullptr) return true;
        if (jacobians[0] != nullptr) jacobians[0][0] = scale_ / n_;
        if (jacobians[1] != nullptr) jacobians[1][0] = scale_ * x_ / n_;
        return true;
    }

  private:
    double x_, y_, scale_, n_;
};

void check(const SlopeAreaFitOptions& options) {
    const auto positive = [](double value) { return value > 0 && std::isfinite(value); };
    if (!positive(options.n)) throw Error(fmt::format("n must be a positive number, not {}", options.n));
    if (options.uplift_m_per_yr && !positive(*options.uplift_m_per_yr)) {
        throw Error(fmt::format("the uplift rate must be a positive number of m/yr, not {}", *options.uplift_m_per_yr));
    }
    if (!(options.uplift_sd_m_per_yr >= 0) || std::isinf(options.uplift_sd_m_per_yr)) {
        throw Error(
            fmt::format("the uplift's standard deviation must be 0 or more m/yr, not {}", options.uplift_sd_m_per_yr));
    }
    if (!(options.deposition_g >= 0) || std::isinf(options.deposition_g)) {
        throw Error(fmt::format("deposition's G must be 0 or more, not {}", options.deposition_g));
    }
    if (options.theta_fixed && !std::isfinite(*options.theta_fixed)) {
        throw Error(fmt::format("theta can be fixed at a finite number only, not at {}", *options.theta_fixed));
    }
    if (!positive(options.smallest_se_dex)) {
        throw Error(
            fmt::format("the smallest standard error of a bin must be positive, not {} dex", options.smallest_se_dex));
    }
}

std::vector<SlopeAreaBin> bins_in_range(std::span<const SlopeAreaBin> bins, const SlopeAreaFitOptions& options) {
    const double least = options.area_min_m2.value_or(0);
    const double most = options.area_max_m2.value_or(std::numeric_limits<double>::infinity());
    if (!(least < most)) {
        throw Error(fmt::format("the drainage areas to fit must span a range, not {} to {} m2", least, most));
    }
    std::vector<SlopeAreaBin> used;
    for (const SlopeAreaBin& bin : bins) {
        const bool measured =
            bin.area_m2 > 0 && bin.slope > 0 && std::isfinite(bin.area_m2) && std::isfinite(bin.slope);
        if (measured && bin.area_m2 >= least && bin.area_m2 <= most) used.push_back(bin);
    }
    if (used.size() < 3) {
        throw Error(
            fmt::format("a slope-area fit needs at least 3 bins of drainage area, and between {} and {} m2 "
                        "there are {}: widen the range, lower the channel threshold or take a larger basin",
                        least, most, used.size()));
    }
    const auto [smallest, largest] = std::ranges::minmax(used, {}, &SlopeAreaBin::area_m2);
    if (largest.area_m2 < smallest.area_m2 * 1.01) {
        throw Error(
            fmt::format("the slope-area bins all lie at {:.6g} m2, so the slope's dependence on the area cannot "
                        "be told: widen the range",
                        smallest.area_m2));
    }
    return used;
}

Target make_target(const std::vector<SlopeAreaBin>& bins, double smallest_se_dex) {
    Target target;
    target.error = channel::bin_errors(bins, smallest_se_dex);
    double weights = 0;
    for (std::size_t i = 0; i < bins.size(); ++i) {
        const double weight = 1 / (target.error[i] * target.error[i]);
        target.log_reference_area += weight * std::log(bins[i].area_m2);
        weights += weight;
    }
    target.log_reference_area /= weights;
    for (const SlopeAreaBin& bin : bins) {
        target.x.push_back(std::log(bin.area_m2) - target.log_reference_area);
        target.y.push_back(std::log(bin.slope));
    }
    return target;
}

void build(ceres::Problem& problem, const Target& target, const SlopeAreaFitOptions& options, Solution& at) {
    auto* loss = new ceres::HuberLoss(at.loss_width);  // Ceres owns it, as it owns the residuals
    for (std::size_t i = 0; i < target.x.size(); ++i) {
        problem.AddResidualBlock(new LogSlopeResidual(target.x[i], target.y[i], target.error[i], options.n), loss,
                                 &at.a, &at.m);
    }
    if (options.theta_fixed) problem.SetParameterBlockConstant(&at.m);
}

/// One solution with a given width of the loss, starting from `at`.
void solve(const Target& target, const SlopeAreaFitOptions& options, Solution& at) {
    keep_ceres_quiet();
    ceres::Problem problem;
    build(problem, target, options, at);
    ceres::Solver::Options settings;
    settings.linear_solver_type = ceres::DENSE_QR;
    settings.num_threads = 1;
    settings.logging_type = ceres::SILENT;
    settings.max_num_iterations = 200;
    settings.initial_trust_region_radius = 1e12;  // the model is linear: full steps, only the loss bends
    settings.function_tolerance = 1e-15;          // relative; a quadratic minimum is then placed to about 1e-8 errors
    settings.parameter_tolerance = 1e-13;         // relative
    settings.gradient_tolerance = 1e-12;          // per unit of a and m, of a cost of order one
    ceres::Solver::Summary summary;
    ceres::Solve(settings, &problem, &summary);
    at.cost = 2 * summary.final_cost;
    at.iterations += static_cast<int>(summary.iterations.size());
    at.converged = summary.termination_type == ceres::CONVERGENCE;
    at.message = summary.message;
    if (!summary.IsSolutionUsable()) throw Error("the slope-area bins do not determine a power law");

    ceres::Covariance::Options exact;
    exact.algorithm_type = ceres::DENSE_SVD;
    exact.num_threads = 1;
    ceres::Covariance covariance(exact);
    const std::vector<std::pair<const double*, const double*>> blocks{{&at.a, &at.a}, {&at.a, &at.m}, {&at.m, &at.m}};
    if (!covariance.Compute(blocks, &problem)) throw Error("the slope-area bins do not determine a power law");
    covariance.GetCovarianceBlock(&at.a, &at.a, &at.variance_a);
    covariance.GetCovarianceBlock(&at.a, &at.m, &at.covariance);
    covariance.GetCovarianceBlock(&at.m, &at.m, &at.variance_m);
}

/// Robust standard deviation of the weighted residuals, 1 if they are what the errors promise.
double robust_scale(const Target& target, const Solution& at, double n) {
    std::vector<double> size;
    for (std::size_t i = 0; i < target.x.size(); ++i) {
        size.push_back(std::abs(target.y[i] + (at.a + at.m * target.x[i]) / n) / target.error[i]);
    }
    std::ranges::nth_element(size, size.begin() + static_cast<std::ptrdiff_t>(size.size() / 2));
    return std::max(1.0, 1.4826 * size[size.size() / 2]);
}

Solution solve_robustly(const Target& target, const SlopeAreaFitOptions& options) {
    constexpr double huber = 1.345;  // 95 % efficiency on normal errors
    constexpr int most_rounds = 5;   // the scale settles in two or three
    Solution solution;
    solution.m = options.n * options.theta_fixed.value_or(0.45);  // concavities of rivers are near it
    solution.a = -options.n * target.y[target.y.size() / 2];
    solution.loss_width = huber;
    for (int round = 0; round < most_rounds; ++round) {
        solve(target, options, solution);
        const double width = huber * robust_scale(target, solution, options.n);
        if (std::abs(width / solution.loss_width - 1) < 0.01) break;
        solution.loss_width = width;
    }
    return solution;
}

/// Turns variances into estimates: scaled by the scatter, intervals by Student's t.
struct Uncertainty {
    double scale;  ///< factor on every variance that comes from the bins
    double t;

    Estimate plain(double value, double variance) const {
        const double error = std::sqrt(scale * variance);
        return {value, error, {value - t * error, value + t * error}};
    }
    /// Of a positive quantity known by its logarithm; `extra` is a variance that does not come from the bins.
    Estimate logarithmic(double logarithm, double variance, double extra = 0) const {
        const double error = std::sqrt(scale * variance + extra);
        const double value = std::exp(logarithm);
        return {value, value * error, {std::exp(logarithm - t * error), std::exp(logarithm + t * error)}};
    }
};

/// Coefficient of x² beside the straight line. Regressing on what of x² a line cannot explain gives the same as a
/// parabola (Frisch–Waugh), and three coefficients leave one degree of freedom less than the line used here thinks.
Estimate fit_curvature(const Target& target) {
    const double count = static_cast<double>(target.x.size());
    if (count < 4) return unknown;
    std::vector<double> weight, square;
    for (std::size_t i = 0; i < target.x.size(); ++i) {
        weight.push_back(1 / (target.error[i] * target.error[i]));
        square.push_back(target.x[i] * target.x[i]);
    }
    const Line line = fit_line(target.x, square, weight);
    for (std::size_t i = 0; i < square.size(); ++i) {
        square[i] -= line.intercept.value + line.slope.value * target.x[i];
    }
    const Line rest = fit_line(square, target.y, weight);
    const Line straight = fit_line(target.x, target.y, weight);
    double residual = 0;
    for (std::size_t i = 0; i < square.size(); ++i) {
        const double off =
            target.y[i] - straight.intercept.value - straight.slope.value * target.x[i] - rest.slope.value * square[i];
        residual += weight[i] * off * off;
    }
    double spread = 0;
    for (std::size_t i = 0; i < square.size(); ++i) spread += weight[i] * square[i] * square[i];
    const double scale = std::max(1.0, residual / (count - 3));
    return Uncertainty{scale, student_t95(count - 3)}.plain(rest.slope.value, 1 / spread);
}

void fill_rates(SlopeAreaFit& fit, const Solution& at, const SlopeAreaFitOptions& options, const Uncertainty& with,
                double log_area) {
    const double log_ratio = at.a - at.m * log_area;          // −n·ln ks
    const double carried = std::log1p(options.deposition_g);  // what a river lays down it digs again
    const double variance = at.variance_a + log_area * log_area * at.variance_m - 2 * log_area * at.covariance;
    fit.theta = with.plain(at.m / fit.n, at.variance_m / (fit.n * fit.n));
    fit.ks = with.logarithmic(-log_ratio / fit.n, variance / (fit.n * fit.n));
    fit.m = with.plain(at.m, at.variance_m);
    fit.k_over_uplift = with.logarithmic(carried + log_ratio, variance);
    fit.k_unit = fmt::format("m^{:.4g}/yr", 1 - 2 * at.m);
    double uplift_variance = 0;
    if (options.uplift_m_per_yr) {
        const double log_uplift = std::log(*options.uplift_m_per_yr) + carried;
        const double relative = options.uplift_sd_m_per_yr / *options.uplift_m_per_yr;
        uplift_variance = relative * relative;
        fit.k = with.logarithmic(log_uplift + log_ratio, variance, uplift_variance);
        fit.k_at_reference_area = with.logarithmic(log_uplift + at.a, at.variance_a, uplift_variance);
    }
    fit.correlation_log_k_m =
        options.theta_fixed ? nan
                            : with.scale * (at.covariance - log_area * at.variance_m) /
                                  std::sqrt((with.scale * variance + uplift_variance) * with.scale * at.variance_m);
}

void fill_remarks(SlopeAreaFit& fit, const SlopeAreaFitOptions& options) {
    fit.identifiable = {"ks", "k_over_uplift"};
    if (!options.theta_fixed) fit.identifiable.insert(fit.identifiable.end(), {"theta", "m"});
    if (options.uplift_m_per_yr) {
        fit.identifiable.insert(fit.identifiable.end(), {"k", "k_at_reference_area"});
    } else {
        fit.notes.push_back(fmt::format(
            "Slope and area alone give theta, ks and, for n = {:g}, k/u; for k give the uplift rate.", fit.n));
    }
    fit.notes.push_back(fmt::format("n = {:g} is assumed: slope and area give m/n only.", fit.n));
    if (options.deposition_g > 0) {
        fit.notes.push_back(
            fmt::format("G = {:g} is assumed: slope and area give k/((1 + G)*u) only.", options.deposition_g));
    }
    if (options.theta_fixed) fit.notes.push_back("theta was held fixed, so m has no error of its own.");
    if (fit.curvature.interval95[0] > 0 || fit.curvature.interval95[1] < 0) {
        fit.notes.push_back(fmt::format(
            "ln S is curved in ln A (coefficient {:.3g} +- {:.2g}): one steady, uniform power law may not hold here.",
            fit.curvature.value, fit.curvature.standard_error));
    }
    if (!fit.converged) fit.notes.push_back("The solver did not converge: " + fit.message);
}

}  // namespace

SlopeAreaFit fit_slope_area(std::span<const SlopeAreaBin> bins, const SlopeAreaFitOptions& options) {
    check(options);
    SlopeAreaFit fit{};
    fit.n = options.n;
    fit.k_at_reference_area = unknown;
    fit.bins = bins_in_range(bins, options);
    const Target target = make_target(fit.bins, options.smallest_se_dex);
    const Solution solution = solve_robustly(target, options);
    fit.degrees_of_freedom = static_cast<int>(fit.bins.size()) - (options.theta_fixed ? 1 : 2);
    fit.reduced_chi2 = solution.cost / fit.degrees_of_freedom;
    fit.reference_area_m2 = std::exp(target.log_reference_area);
    fit.iterations = solution.iterations;
    fit.converged = solution.converged;
    fit.message = solution.message;
    const auto [least, most] = std::ranges::minmax(fit.bins, {}, &SlopeAreaBin::area_m2);
    fit.area_range_m2 = {least.area_m2, most.area_m2};
    fit.curvature = fit_curvature(target);
    const Uncertainty with{std::max(1.0, fit.reduced_chi2), student_t95(fit.degrees_of_freedom)};
    fill_rates(fit, solution, options, with, target.log_reference_area);
    fill_remarks(fit, options);
    for (const double x : target.x) fit.fitted_slope.push_back(std::exp(-(solution.a + solution.m * x) / fit.n));
    return fit;
}

}  // namespace thalweg::infer
