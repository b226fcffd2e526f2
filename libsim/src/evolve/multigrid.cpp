// SPDX-License-Identifier: GPL-3.0-or-later
#include "evolve/multigrid.hpp"

#include <cmath>

#include "thalweg/core/parallel.hpp"

namespace thalweg::evolve {
namespace {

/// Two nodes are strongly coupled where a_ij² > strong²·a_ii·a_jj (the usual threshold of the method).
constexpr double strong = 0.08;
constexpr int alone = -1;
constexpr int waiting = -2;
constexpr Eigen::Index small_enough_to_factor = 400;
constexpr std::size_t most_levels = 24;
constexpr int most_iterations = 1000;

/// Calls visit(j) for the strong neighbours j of node i.
template <class Visit>
void visit_strong(const SparseMatrix& a, const Vector& diagonal, int i, Visit visit) {
    for (SparseMatrix::InnerIterator entry(a, i); entry; ++entry) {
        const int j = static_cast<int>(entry.col());
        const double bound = strong * strong * diagonal[i] * diagonal[j];
        if (j != i && entry.value() * entry.value() > bound) visit(j);
    }
}

/// Number of the aggregate of every node, `alone` where it has no strong neighbour. First whole neighbourhoods, then
/// what touches one of these joins it, then what is left.
std::vector<int> aggregate(const SparseMatrix& a, int& count) {
    const int n = static_cast<int>(a.rows());
    const Vector diagonal = a.diagonal();
    std::vector<int> of(n, waiting);
    count = 0;
    for (int i = 0; i < n; ++i) {
        bool any = false, free = of[i] == waiting;
        visit_strong(a, diagonal, i, [&](int j) {
            any = true;
            free = free && of[j] == waiting;
        });
        if (!any) of[i] = alone;
        if (!any || !free) continue;
        of[i] = count;
        visit_strong(a, diagonal, i, [&](int j) { of[j] = count; });
        ++count;
    }
    const int whole = count;
    std::vector<int> joined(of);
    for (int i = 0; i < n; ++i) {
        if (of[i] != waiting) continue;
        visit_strong(a, diagonal, i, [&](int j) {
            if (joined[i] == waiting && of[j] >= 0 && of[j] < whole) joined[i] = of[j];
        });
    }
    for (int i = 0; i < n; ++i) {
        if (joined[i] != waiting) continue;
        joined[i] = count;
        visit_strong(a, diagonal, i, [&](int j) {
            if (joined[j] == waiting) joined[j] = count;
        });
        ++count;
    }
    return joined;
}

/// (I − ω·D⁻¹·A)·P₀, P₀ constant on each aggregate, ω = 4/3 over a bound of the spectral radius of D⁻¹·A.
SparseMatrix smoothed_prolongation(const SparseMatrix& a, const std::vector<int>& of, int count) {
    const int n = static_cast<int>(a.rows());
    SparseMatrix constant(n, count);
    constant.reserve(Eigen::VectorXi::Constant(n, 1));
    for (int i = 0; i < n; ++i) {
        if (of[i] >= 0) constant.insert(i, of[i]) = 1;
    }
    constant.makeCompressed();
    const Vector diagonal = a.diagonal();
    double radius = 1;
    for (int i = 0; i < n; ++i) {
        double sum = 0;
        for (SparseMatrix::InnerIterator entry(a, i); entry; ++entry) sum += std::abs(entry.value());
        radius = std::max(radius, sum / diagonal[i]);
    }
    SparseMatrix smoothed = a * constant;
    const double omega = 4.0 / 3.0 / radius;
    for (int i = 0; i < n; ++i) {
        for (SparseMatrix::InnerIterator entry(smoothed, i); entry; ++entry) entry.valueRef() *= -omega / diagonal[i];
    }
    return smoothed + constant;
}

/// Where each row holds its diagonal.
std::vector<int> middles(const SparseMatrix& a) {
    std::vector<int> middle(a.rows());
    for (int i = 0; i < a.rows(); ++i) {
        int at = a.outerIndexPtr()[i];
        while (a.innerIndexPtr()[at] != i) ++at;
        middle[i] = at;
    }
    return middle;
}

/// A matrix with its rows cut at the diagonal.
struct Rows {
    const int* column;
    const double* value;
    const int* start;
    const int* middle;
    int count;

    Rows(const SparseMatrix& a, const std::vector<int>& middles)
        : column(a.innerIndexPtr()),
          value(a.valuePtr()),
          start(a.outerIndexPtr()),
          middle(middles.data()),
          count(static_cast<int>(a.rows())) {}

    double sum(int first, int last, const Vector& x) const {
        double sum = 0;
        for (int at = first; at < last; ++at) sum += value[at] * x[column[at]];
        return sum;
    }
    double below(int i, const Vector& x) const { return sum(start[i], middle[i], x); }
    double above(int i, const Vector& x) const { return sum(middle[i] + 1, start[i + 1], x); }
};

/// A Gauss–Seidel sweep upward from x = 0, of which no node sees more than the part below it.
void sweep_up_from_zero(const Rows& a, const Vector& right, Vector& x) {
    x.resize(a.count);
    for (int i = 0; i < a.count; ++i) x[i] = (right[i] - a.below(i, x)) / a.value[a.middle[i]];
}

/// What that sweep leaves: right − A·x, in which all but the part above each node has cancelled.
void rest_after_sweep_up(const Rows& a, const Vector& x, Vector& rest) {
    rest.resize(a.count);
    parallel_for(0, static_cast<unsigned>(a.count), [&](unsigned first, unsigned last) {
        for (unsigned i = first; i < last; ++i) rest[i] = -a.above(static_cast<int>(i), x);
    });
}

void sweep_down(const Rows& a, const Vector& right, Vector& x) {
    for (int i = a.count - 1; i >= 0; --i) x[i] = (right[i] - a.below(i, x) - a.above(i, x)) / a.value[a.middle[i]];
}

/// product = A·x, rows on several threads.
void multiply(const SparseMatrix& a, const Vector& x, Vector& product) {
    product.resize(a.rows());
    const int* column = a.innerIndexPtr();
    const double* value = a.valuePtr();
    const int* start = a.outerIndexPtr();
    parallel_for(0, static_cast<unsigned>(a.rows()), [&](unsigned first, unsigned last) {
        for (unsigned i = first; i < last; ++i) {
            double sum = 0;
            for (int at = start[i]; at < start[i + 1]; ++at) sum += value[at] * x[column[at]];
            product[i] = sum;
        }
    });
}

}  // namespace

void Multigrid::compute(const SparseMatrix& finest) {
    finest_ = &finest;
    levels_.assign(1, {});
    while (levels_.size() < most_levels) {
        const SparseMatrix& fine = matrix(levels_.size() - 1);
        levels_.back().middle = middles(fine);
        if (fine.rows() <= small_enough_to_factor) break;
        int count = 0;
        const std::vector<int> of = aggregate(fine, count);
        if (count == 0 || count > 0.8 * static_cast<double>(fine.rows())) break;
        Level& level = levels_.back();
        level.prolongation = smoothed_prolongation(fine, of, count);
        level.restriction = level.prolongation.transpose();
        SparseMatrix coarse = level.restriction * SparseMatrix(fine * level.prolongation);
        levels_.push_back({});
        levels_.back().own = std::move(coarse);
    }
    const SparseMatrix& last = matrix(levels_.size() - 1);
    if (levels_.back().middle.empty()) levels_.back().middle = middles(last);
    solves_coarsest_ = last.rows() <= small_enough_to_factor;
    if (solves_coarsest_) coarsest_.compute(Eigen::SparseMatrix<double>(last));
    solves_coarsest_ = solves_coarsest_ && coarsest_.info() == Eigen::Success;
}

void Multigrid::apply(const Vector& residual, Vector& correction) {
    levels_[0].right = residual;
    const std::size_t last = levels_.size() - 1;
    for (std::size_t l = 0; l < last; ++l) {
        Level& level = levels_[l];
        const Rows rows(matrix(l), level.middle);
        sweep_up_from_zero(rows, level.right, level.unknown);
        rest_after_sweep_up(rows, level.unknown, level.rest);
        multiply(level.restriction, level.rest, levels_[l + 1].right);
    }
    Level& bottom = levels_[last];
    if (solves_coarsest_) {
        bottom.unknown = coarsest_.solve(bottom.right);
    } else {
        const Rows rows(matrix(last), bottom.middle);
        sweep_up_from_zero(rows, bottom.right, bottom.unknown);
        sweep_down(rows, bottom.right, bottom.unknown);
    }
    for (std::size_t l = last; l-- > 0;) {
        Level& level = levels_[l];
        multiply(level.prolongation, levels_[l + 1].unknown, level.rest);
        level.unknown += level.rest;
        sweep_down(Rows(matrix(l), level.middle), level.right, level.unknown);
    }
    correction = levels_[0].unknown;
}

LinearSolution conjugate_gradients(const SparseMatrix& a, Multigrid& preconditioner, const Vector& right,
                                   double tolerance, Vector& unknown) {
    unknown.setZero(a.rows());
    const double goal = tolerance * right.norm();
    if (!(goal > 0)) return {0, true};
    Vector residual = right, preconditioned, direction, product;
    preconditioner.apply(residual, preconditioned);
    direction = preconditioned;
    double energy = residual.dot(preconditioned);
    for (int iteration = 1; iteration <= most_iterations; ++iteration) {
        multiply(a, direction, product);
        const double alpha = energy / direction.dot(product);
        unknown += alpha * direction;
        residual -= alpha * product;
        if (residual.norm() <= goal) return {iteration, true};
        preconditioner.apply(residual, preconditioned);
        const double before = energy;
        energy = residual.dot(preconditioned);
        direction = preconditioned + (energy / before) * direction;
    }
    return {most_iterations, false};
}

}  // namespace thalweg::evolve
