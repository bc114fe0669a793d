#pragma once

#include "robotteamsim/network/link_bits.hpp"

namespace robotteamsim::network {

/// Relative error of a Fiedler value where the next eigenvalue is not within 1e-5 of it; 100 times that at most.
constexpr double kFiedlerTolerance = 1e-9;

/// Returns the algebraic connectivity (Fiedler value): the second-smallest eigenvalue of Lp = D - A
/// [dissertation, eq. 33; fiedler1973]. 0 exactly where the team is split, else > 0; 1 for a single robot.
///
/// Small teams by all eigenvalues; larger ones by Lanczos iterations [qiu2021]: on the inverse of a sparse Lp, from its
/// LDL^T factors, or on a dense Lp itself. The iterations start from a fixed vector: the same links give the same bits.
/// Throws std::invalid_argument where the matrix holds no robot or is not what LinkBits takes, std::runtime_error where
/// the iterations do not converge.
double FiedlerValue(const Eigen::Ref<const Adjacency>& adjacency);

}  // namespace robotteamsim::network
