// SPDX-License-Identifier: GPL-3.0-or-later
#include "thalweg/evolve/hillslope.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <limits>
#include <variant>

#include "evolve/check_setting.hpp"
#include "evolve/compensated_sum.hpp"
#include "evolve/creep_law.hpp"
#include "evolve/hillslope_patches.hpp"
#include "evolve/multigrid.hpp"
#include "thalweg/core/error.hpp"

namespace thalweg::evolve {
namespace {

constexpr double linear_tolerance = 1e-13;  // of the right-hand side: what rounding allows
constexpr double newton_tolerance = 1e-6;   // of the right-hand side of one iteration of several
constexpr double last_newton_step = 1e-8;   // of the relief; the error after it is of the order of its square
constexpr double last_nearness = 1e-4;      // of the room left below the critical slope; likewise
constexpr double rough_newton_step = 0.05;  // of the relief; on the way
constexpr int patience = 20;  // iterations of a solve after which coarse levels are made anew; they cost about as much
constexpr int most_newton_iterations = 300;
constexpr int most_halvings = 60;
constexpr double stretch = 10;  // of the time step, from one stage of the way to the next
constexpr int most_stages = 14;
constexpr double room_to_start = 0.95;  // of the critical slope
constexpr double raise = 1.5;           // of the slope that base level forces
constexpr double no_limit = std::numeric_limits<double>::infinity();

std::vector<Creep> creep_of(const std::vector<Boundary>& boundary, const std::vector<double>& elevation_m) {
    std::vector<Creep> creep(boundary.size(), Creep::moves);
    for (std::size_t node = 0; node < boundary.size(); ++node) {
        if (boundary[node] == Boundary::base_level) creep[node] = Creep::fixed;
        if (std::isnan(elevation_m[node])) creep[node] = Creep::no_data;
    }
    return creep;
}

/// Whether two neighbours share a patch: all on a mesh; on a grid the diagonal ones only where the law is not linear.
bool couple(const Mesh&, Slot, bool) { return true; }
bool couple(const Grid&, Slot slot, bool linear) { return !linear || slot % 2 == 0; }

/// Rows and columns of the matrix: every node, coupled to those of its neighbours that move.
template <Topology T>
SparseMatrix pattern(const T& topology, const std::vector<Creep>& creep, bool linear) {
    const Index nodes = topology.size();
    std::vector<Index> row;
    const auto fill_row = [&](Index node) {
        row.assign(1, node);
        if (creep[node] != Creep::moves) return;
        topology.neighbors(node, [&](Index neighbor, double, Slot slot) {
            if (creep[neighbor] == Creep::moves && couple(topology, slot, linear)) row.push_back(neighbor);
        });
        std::sort(row.begin(), row.end());
    };
    std::size_t entries = 0;
    for (Index node = 0; node < nodes; ++node) {
        fill_row(node);
        entries += row.size();
    }
    if (entries > static_cast<std::size_t>(std::numeric_limits<int>::max())) {
        throw Error(fmt::format(
            "hillslope diffusion works on at most 2^31 couplings of nodes, not on {}: use fewer nodes", entries));
    }
    SparseMatrix matrix(nodes, nodes);
    matrix.resizeNonZeros(static_cast<Eigen::Index>(entries));
    int at = 0;
    for (Index node = 0; node < nodes; ++node) {
        matrix.outerIndexPtr()[node] = at;
        fill_row(node);
        for (const Index column : row) matrix.innerIndexPtr()[at++] = static_cast<int>(column);
    }
    matrix.outerIndexPtr()[nodes] = at;
    return matrix;
}

double& entry(SparseMatrix& matrix, Index row, Index column) {
    const int* columns = matrix.innerIndexPtr();
    int at = matrix.outerIndexPtr()[row];
    while (columns[at] != static_cast<int>(column)) ++at;
    return matrix.valuePtr()[at];
}

double relief(const std::vector<double>& elevation_m) {
    double low = std::numeric_limits<double>::infinity(), high = -low;
    for (const double h : elevation_m) {
        if (h < low) low = h;
        if (h > high) high = h;
    }
    return high > low ? high - low : 0;
}

}  // namespace

/// All that a step works on.
class HillslopeSolver::Steps {
  public:
    Steps(std::variant<const Grid*, const Mesh*> topology, const Hillslope& hillslope, const Setting& setting)
        : topology_(topology), hillslope_(hillslope), setting_(setting) {
        check_hillslope(hillslope);
        nodes_ = std::visit([](const auto* t) { return t->size(); }, topology_);
    }

    HillslopeReport step(double dt_yr, Landscape& landscape) {
        check_setting(nodes_, landscape, setting_);
        check_step(dt_yr);
        if (hillslope_.diffusivity_m2_per_yr == 0) return {};
        if (creep_.empty()) prepare(landscape);
        before_ = landscape.elevation_m;
        dt_yr_ = dt_yr;
        HillslopeReport report;
        std::vector<double>& heights = landscape.elevation_m;
        if (is_linear()) {
            linear_step(heights, report);
        } else {
            nonlinear_step(heights, report);
        }
        close_balance(heights);
        take_stock(heights, report);
        return report;
    }

  private:
    /// Calls visit(patch, law) for every patch.
    template <class Visit>
    void patches(Visit visit) const {
        std::size_t number = 0;
        CreepLaw law{hillslope_.diffusivity_m2_per_yr, critical_slope_};
        const auto with_law = [&](const Patch& patch) {
            if (!raised_.empty()) law.critical_slope = std::max(critical_slope_, raised_[number++]);
            visit(patch, law);
        };
        std::visit([&](const auto* topology) { visit_patches(*topology, creep_, with_law); }, topology_);
    }

    void prepare(const Landscape& landscape) {
        creep_ = creep_of(setting_.boundary, landscape.elevation_m);
        matrix_ = std::visit([&](const auto* topology) { return pattern(*topology, creep_, is_linear()); }, topology_);
        area_.resize(nodes_);
        for (Index node = 0; node < nodes_; ++node) {
            area_[node] = std::visit([&](const auto* topology) { return topology->area(node); }, topology_);
        }
    }

    bool is_linear() const { return hillslope_.critical_slope == 0; }

    bool moves(Index node) const { return creep_[node] == Creep::moves; }

    /// Whether corner k is a node of its own that moves.
    bool moves(const Patch& patch, std::size_t k) const {
        return (k == 0 || patch.corner[k] != patch.corner[0]) && moves(patch.corner[k]);
    }

    bool any_moves(const Patch& patch) const { return moves(patch, 0) || moves(patch, 1) || moves(patch, 2); }

    /// Energy of the step: Σ a·(h − h_before)²/2 + dt·Σ w·W.
    double energy(const std::vector<double>& heights) const {
        CompensatedSum sum;
        for (Index node = 0; node < nodes_; ++node) {
            if (!moves(node)) continue;
            const double change = heights[node] - before_[node];
            sum.add(0.5 * area_[node] * change * change);
        }
        patches([&](const Patch& patch, const CreepLaw& law) {
            if (any_moves(patch)) sum.add(dt_yr_ * patch.weight_m2 * law.energy(patch.gradient(heights)));
        });
        return sum.value();
    }

    /// Minus the first derivatives of the energy, that is a·(h_before − h) less what the faces let out, into `right_`.
    void residual(const std::vector<double>& heights) {
        right_.setZero(nodes_);
        for (Index node = 0; node < nodes_; ++node) {
            if (moves(node)) right_[node] = area_[node] * (before_[node] - heights[node]);
        }
        patches([&](const Patch& patch, const CreepLaw& law) {
            const Plane g = patch.gradient(heights);
            const double factor = dt_yr_ * patch.weight_m2 * law.conduction(g).even;
            for (std::size_t k = 0; k < 3; ++k) {
                if (moves(patch, k)) right_[patch.corner[k]] -= factor * dot(patch.slope[k], g);
            }
        });
    }

    /// The second derivatives, into `matrix_`.
    void assemble(const std::vector<double>& heights) {
        std::fill_n(matrix_.valuePtr(), matrix_.nonZeros(), 0.0);
        for (Index node = 0; node < nodes_; ++node) entry(matrix_, node, node) = moves(node) ? area_[node] : 1;
        patches([&](const Patch& patch, const CreepLaw& law) {
            const Plane g = patch.gradient(heights);
            const Conduction conduct = law.conduction(g);
            const double weight = dt_yr_ * patch.weight_m2;
            for (std::size_t p = 0; p < 3; ++p) {
                if (!moves(patch, p)) continue;
                const Plane conducted = conduct(g, patch.slope[p]);
                for (std::size_t q = 0; q < 3; ++q) {
                    const double value = weight * dot(conducted, patch.slope[q]);
                    if (value != 0 && moves(patch, q)) entry(matrix_, patch.corner[p], patch.corner[q]) += value;
                }
            }
        });
    }

    /// Coarse levels for `matrix_`: those there are, made for another one of this step or for linear creep, as long as
    /// they serve. No result hangs on which, but by the tolerance of the solve; and which does not hang on other steps.
    void keep_or_renew_levels() {
        if (levels_serve_) {
            levels_->keep_for(matrix_);
        } else {
            levels_ = &multigrid_;
            levels_->compute(matrix_);
        }
    }

    void solve(double tolerance, HillslopeReport& report) { solve(matrix_, tolerance, report); }

    void solve(const SparseMatrix& matrix, double tolerance, HillslopeReport& report) {
        const LinearSolution solution = conjugate_gradients(matrix, *levels_, right_, tolerance, change_);
        levels_serve_ = solution.iterations <= patience;
        report.linear_iterations += solution.iterations;
        report.converged = report.converged && solution.converged;
        ++report.newton_iterations;
    }

    void linear_step(std::vector<double>& heights, HillslopeReport& report) {
        critical_slope_ = no_limit;
        if (assembled_for_yr_ != dt_yr_) {
            assemble(heights);
            multigrid_.compute(matrix_);
        }
        assembled_for_yr_ = dt_yr_;
        residual(heights);
        solve(linear_tolerance, report);
        move(heights, 1);
    }

    void move(std::vector<double>& heights, double share) const {
        for (Index node = 0; node < nodes_; ++node) {
            if (moves(node)) heights[node] += share * change_[node];
        }
    }

    /// The energy of the step is a barrier against slopes beyond Sc, and is minimised from within. If linear creep of
    /// the same step leaves slopes below Sc, from there; else from that of a longer step, which is smoother, and then
    /// along the way that steps of decreasing length mark.
    void nonlinear_step(std::vector<double>& heights, HillslopeReport& report) {
        const double dt_yr = dt_yr_;
        const int stages = smooth_start(heights, report);
        critical_slope_ = hillslope_.critical_slope;
        for (int stage = stages; stage >= 0 && report.converged; --stage) {
            dt_yr_ = dt_yr * std::pow(stretch, stage);
            levels_serve_ = levels_serve_ && stage == stages;
            newton(heights, stage == 0 ? last_newton_step : rough_newton_step, report);
        }
        dt_yr_ = dt_yr;
    }

    /// That of linear creep over the step, and its levels: a function of the step's length alone.
    const SparseMatrix& linear_matrix(const std::vector<double>& heights) {
        levels_ = &start_levels_;
        if (start_for_yr_ != dt_yr_) {
            assemble(heights);
            start_matrix_ = matrix_;
            levels_->compute(start_matrix_);
            start_for_yr_ = dt_yr_;
        }
        levels_->keep_for(start_matrix_);
        return start_matrix_;
    }

    /// The number of times the step had to be stretched.
    int smooth_start(std::vector<double>& heights, HillslopeReport& report) {
        const double dt_yr = dt_yr_;
        raised_.clear();
        critical_slope_ = no_limit;
        int stage = 0;
        while (true) {
            heights = before_;
            residual(heights);
            if (stage == 0) {
                solve(linear_matrix(heights), newton_tolerance, report);
            } else {
                assemble(heights);
                levels_ = &multigrid_;
                levels_->compute(matrix_);
                solve(newton_tolerance, report);
            }
            move(heights, 1);
            if (steepest(heights) < room_to_start * hillslope_.critical_slope) return stage;
            if (stage == most_stages) break;
            dt_yr_ = dt_yr * std::pow(stretch, ++stage);
        }
        // Nothing is smoother, so base level itself is too steep: there the critical slope is raised.
        std::vector<double> slopes;
        patches([&](const Patch& patch, const CreepLaw&) {
            const Plane g = patch.gradient(heights);
            const double slope = std::sqrt(dot(g, g));
            slopes.push_back(slope < room_to_start * hillslope_.critical_slope ? 0 : raise * slope);
        });
        raised_ = std::move(slopes);
        return stage;
    }

    void newton(std::vector<double>& heights, double last_step, HillslopeReport& report) {
        while (report.newton_iterations < most_newton_iterations) {
            residual(heights);
            assemble(heights);
            keep_or_renew_levels();
            solve(newton_tolerance, report);
            const double share = descend(heights);
            if (share < 1 || change_.cwiseAbs().maxCoeff() > last_step * relief(heights)) continue;
            if (last_step > last_newton_step || nearness(heights) < last_nearness) return;
        }
        report.converged = false;
    }

    /// Goes as far along `change_` as lowers the energy; returns the share of it.
    double descend(std::vector<double>& heights) {
        const double start = energy(heights);
        const double slope = right_.dot(change_);
        start_ = heights;
        double share = 1;
        for (int halving = 0; halving < most_halvings; ++halving, share /= 2) {
            heights = start_;
            move(heights, share);
            // The last term is what sums of this size lose in rounding.
            if (energy(heights) <= start - 1e-4 * share * slope + 1e-14 * start) return share;
        }
        heights = start_;
        return 0;
    }

    /// Largest change of a gradient by the last step, as a share of the room that is left below the critical slope.
    double nearness(const std::vector<double>& heights) const {
        double largest = 0;
        patches([&](const Patch& patch, const CreepLaw& law) {
            const Plane g = patch.gradient(heights), old = patch.gradient(start_);
            const double change = std::hypot(g.x - old.x, g.y - old.y);
            largest = std::max(largest, change / (law.critical_slope - std::hypot(g.x, g.y)));
        });
        return largest;
    }

    double steepest(const std::vector<double>& heights) const {
        double square = 0;
        patches([&](const Patch& patch, const CreepLaw&) {
            const Plane g = patch.gradient(heights);
            if (any_moves(patch)) square = std::max(square, dot(g, g));
        });
        return std::sqrt(square);
    }

    struct Outflow {
        double volume_m3;    ///< into base-level nodes
        double per_lift_m2;  ///< its derivative by one height added to all that moves
    };

    Outflow outflow(const std::vector<double>& heights) const {
        CompensatedSum volume, rise;
        patches([&](const Patch& patch, const CreepLaw& law) {
            const bool inner = moves(patch.corner[0]) && moves(patch.corner[1]) && moves(patch.corner[2]);
            if (inner || !any_moves(patch)) return;
            const Plane lift = lifted(patch);
            const Plane g = patch.gradient(heights);
            const Conduction conduct = law.conduction(g);
            volume.add(dt_yr_ * patch.weight_m2 * conduct.even * dot(lift, g));
            rise.add(dt_yr_ * patch.weight_m2 * dot(lift, conduct(g, lift)));
        });
        return {volume.value(), rise.value()};
    }

    /// Gradient that arises where all that moves is lifted by 1.
    Plane lifted(const Patch& patch) const {
        Plane sum{0, 0};
        for (std::size_t k = 0; k < 3; ++k) {
            if (moves(patch, k)) sum = {sum.x + patch.slope[k].x, sum.y + patch.slope[k].y};
        }
        return sum;
    }

    double stored(const std::vector<double>& heights) const {
        CompensatedSum sum;
        for (Index node = 0; node < nodes_; ++node) {
            if (moves(node)) sum.add(area_[node] * (heights[node] - before_[node]));
        }
        return sum.value();
    }

    /// What the iterations left over would be lost or won out of nothing: a shift as small as they gives it back.
    void close_balance(std::vector<double>& heights) const {
        double area = 0;
        for (Index node = 0; node < nodes_; ++node) area += moves(node) ? area_[node] : 0;
        if (area == 0) return;
        for (int repeat = 0; repeat < 2; ++repeat) {
            const Outflow out = outflow(heights);
            const double lift = -(out.volume_m3 + stored(heights)) / (area + out.per_lift_m2);
            for (Index node = 0; node < nodes_; ++node) {
                if (moves(node)) heights[node] += lift;
            }
        }
    }

    void take_stock(const std::vector<double>& heights, HillslopeReport& report) const {
        report.diffused_m3 = outflow(heights).volume_m3;
        report.stored_m3 = stored(heights);
        report.steepest_slope = steepest(heights);
        CompensatedSum taken;
        for (Index node = 0; node < nodes_; ++node) {
            if (moves(node)) taken.add(area_[node] * std::max(0.0, before_[node] - heights[node]));
        }
        report.moved_m3 = taken.value();
    }

    std::variant<const Grid*, const Mesh*> topology_;
    Hillslope hillslope_;
    const Setting& setting_;
    Index nodes_;
    double critical_slope_ = no_limit;
    std::vector<double> raised_;  // critical slope per patch, where base level asks for a higher one; else empty
    double dt_yr_ = 0;
    double assembled_for_yr_ = 0;
    std::vector<Creep> creep_;
    std::vector<double> area_, before_, start_;
    SparseMatrix matrix_;
    Multigrid multigrid_;
    SparseMatrix start_matrix_;  // of linear creep over a step of start_for_yr_, from which steps start below Sc
    Multigrid start_levels_;
    double start_for_yr_ = 0;
    Multigrid* levels_ = &multigrid_;  // those last used
    bool levels_serve_ = false;        // the last solve with them was quick
    Vector right_, change_;
};

HillslopeSolver::HillslopeSolver(const Grid& grid, const Hillslope& hillslope, const Setting& setting)
    : steps_(std::make_unique<Steps>(&grid, hillslope, setting)) {}
HillslopeSolver::HillslopeSolver(const Mesh& mesh, const Hillslope& hillslope, const Setting& setting)
    : steps_(std::make_unique<Steps>(&mesh, hillslope, setting)) {}
HillslopeSolver::~HillslopeSolver() = default;
HillslopeSolver::HillslopeSolver(HillslopeSolver&&) noexcept = default;
HillslopeSolver& HillslopeSolver::operator=(HillslopeSolver&&) noexcept = default;

HillslopeReport HillslopeSolver::step(double dt_yr, Landscape& landscape) { return steps_->step(dt_yr, landscape); }

HillslopeReport diffuse(const Grid& grid, const Hillslope& hillslope, const Setting& setting, double dt_yr,
                        Landscape& landscape) {
    return HillslopeSolver(grid, hillslope, setting).step(dt_yr, landscape);
}

HillslopeReport diffuse(const Mesh& mesh, const Hillslope& hillslope, const Setting& setting, double dt_yr,
                        Landscape& landscape) {
    return HillslopeSolver(mesh, hillslope, setting).step(dt_yr, landscape);
}

}  // namespace thalweg::evolve
