// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <Eigen/Sparse>
#include <Eigen/SparseCholesky>
#include <vector>

namespace thalweg::evolve {

using SparseMatrix = Eigen::SparseMatrix<double, Eigen::RowMajor>;
using Vector = Eigen::VectorXd;

/// Preconditioner for symmetric positive definite matrices of diffusion on graphs: one V-cycle of smoothed aggregation
/// (Vaněk, Mandel & Brezina 1996) with a Gauss–Seidel sweep upward before and one downward after each correction. Nodes
/// without strong neighbours (short steps, fixed heights) take no part in the coarse levels, so that a step too short
/// to need them costs no more than the sweeps.
///
/// Whatever the coarse matrices are, the cycle is symmetric and positive definite: with the finest sweep G and its
/// symmetric part it is G-bar⁻¹ + (I − G⁻ᵀA)·P·C·Pᵀ·(I − A·G⁻¹), in which C is either the coarse cycle of the same form
/// or exact. So coarse levels made for one matrix may serve for another of the same pattern: conjugate gradients
/// converge, if more slowly the more the two differ.
class Multigrid {
  public:
    /// Makes all levels. Each row's columns must ascend and hold the diagonal; the matrix must outlive its use here.
    void compute(const SparseMatrix&);
    /// Keeps the coarse levels, and sweeps over another finest matrix of the same pattern.
    void keep_for(const SparseMatrix& finest) { finest_ = &finest; }
    void apply(const Vector& residual, Vector& correction);

  private:
    struct Level {
        SparseMatrix own;  // of the coarse levels; the finest one is the caller's
        SparseMatrix prolongation, restriction;
        std::vector<int> middle;  // where each row holds its diagonal
        Vector unknown, right, rest;
    };
    const SparseMatrix& matrix(std::size_t level) const { return level == 0 ? *finest_ : levels_[level].own; }

    const SparseMatrix* finest_ = nullptr;
    std::vector<Level> levels_;
    Eigen::SimplicialLDLT<Eigen::SparseMatrix<double>> coarsest_;
    bool solves_coarsest_ = false;
};

struct LinearSolution {
    int iterations;
    bool converged;
};

/// Conjugate gradients from zero, until the residual's norm is under `tolerance` times that of the right-hand side or
/// after 1000 iterations.
LinearSolution conjugate_gradients(const SparseMatrix&, Multigrid&, const Vector& right, double tolerance,
                                   Vector& unknown);

}  // namespace thalweg::evolve
