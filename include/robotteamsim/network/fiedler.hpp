#pragma once

#include "robotteamsim/network/link_bits.hpp"

namespace robotteamsim::network {

/// Relative error of a Fiedler value; up to 100 times this if the next eigenvalue is within 1e-5 of it.
constexpr double kFiedlerTolerance = 1e-9;

/// Returns the algebraic connectivity (Fiedler value): the second-smallest eigenvalue of Lp = D - A [dissertation, eq.
/// 33; fiedler1973]. Exactly 0 if the team is split, else > 0; 1 for a single robot.
///
/// Small teams are solved for all eigenvalues; larger ones by Lanczos iterations [qiu2021] on the inverse of a sparse
/// Lp, from its LDL^T factors, or on a dense Lp itself. The iterations start from a fixed vector: the same links give
/// the same bits.
/// Throws std::invalid_argument if the matrix is empty or LinkBits rejects it, std::runtime_error if the iterations do
/// not converge.
double FiedlerValue(const Eigen::Ref<const Adjacency>& adjacency);

}  // namespace robotteamsim::network
