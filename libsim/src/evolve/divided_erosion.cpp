// SPDX-License-Identifier: GPL-3.0-or-later
#include "evolve/divided_erosion.hpp"

namespace thalweg::evolve {
namespace {

/// Incision at height y above the datum, and y times its derivative with respect to y.
struct Incision {
    double depth_m = 0, rise_m = 0;
};

class Equation {
  public:
    Equation(const Receivers& receivers, std::span<const double> elevation_m, double c, double n)
        : receivers_(receivers), elevation_m_(elevation_m), c_(c), n_(n) {}

    Incision at(double datum, double y) const {
        Incision sum;
        for (std::size_t r = 0; r < receivers_.size(); ++r) {
            const double drop = y - (elevation_m_[receivers_.node[r]] - datum);
            if (!(drop > 0)) continue;
            const double depth = c_ * receivers_.share[r] * std::pow(drop / receivers_.length[r], n_);
            sum.depth_m += depth;
            sum.rise_m += n_ * depth * (y / drop);
        }
        return sum;
    }

    /// The highest receiver that ends below the node: the digging there falls short of what it must be. Heights are
    /// counted from it, since for n < 1 the slope towards it must keep its digits however small it is.
    double datum(double raised) const {
        double best = lowest_of(receivers_, elevation_m_);
        for (const Index receiver : receivers_.node) {
            const double height = elevation_m_[receiver];
            if (height <= best || height >= raised) continue;
            if (at(height, 0).depth_m < raised - height) best = height;
        }
        return best;
    }

    /// No receiver alone digs more than all: each bounds the height from above.
    double upper_bound(double raised, double datum, const SlopeSolver& solve) const {
        double bound = raised - datum;
        for (std::size_t r = 0; r < receivers_.size(); ++r) {
            const double height = elevation_m_[receivers_.node[r]];
            if (height > datum || !(receivers_.share[r] > 0)) continue;
            const double slope = solve(raised - height, receivers_.length[r], c_ * receivers_.share[r]).slope;
            bound = std::min(bound, height - datum + receivers_.length[r] * slope);
        }
        return bound;
    }

  private:
    const Receivers& receivers_;
    std::span<const double> elevation_m_;
    double c_, n_;
};

}  // namespace

/// y + incision(y) = drop by Newton's rule in a bracket, with bisection where it leaves the bracket.
NodeStep step_power(double raised, const Receivers& receivers, std::span<const double> elevation_m, double c, double n,
                    const SlopeSolver& solve, double talus_slope) {
    constexpr int most_iterations = 200;
    if (!(raised > lowest_of(receivers, elevation_m))) return {raised};
    const Equation equation(receivers, elevation_m, c, n);
    const double datum = equation.datum(raised);
    const double drop = raised - datum;
    double low = 0, high = drop;
    double y = equation.upper_bound(raised, datum, solve);
    if (!(y > 0)) y = drop;
    Incision incision;
    int iterations = 0;
    while (iterations < most_iterations) {
        ++iterations;
        incision = equation.at(datum, y);
        const double excess = y + incision.depth_m - drop;
        const double next = y - excess * y / (y + incision.rise_m);
        if (std::abs(next - y) <= 2 * std::numeric_limits<double>::epsilon() * y) break;
        (excess > 0 ? high : low) = y;
        y = next > low && next < high ? next : 0.5 * (low + high);
    }
    return settle(receivers, elevation_m, datum, y, incision.depth_m, talus_slope, iterations);
}

}  // namespace thalweg::evolve
