#pragma once

#include <Eigen/Core>
#include <cstdint>

namespace robotteamsim {

/// A of eq. (17): whether robot i and robot j have a direct link.
using Adjacency = Eigen::Matrix<bool, Eigen::Dynamic, Eigen::Dynamic, Eigen::RowMajor>;

/// Hops between robots.
using HopCount = Eigen::Matrix<std::int32_t, Eigen::Dynamic, Eigen::Dynamic, Eigen::RowMajor>;

/// Returns the smallest number of links between all pairs of robots: 0 on the diagonal, -1 where no path exists.
///
/// The same numbers as C of eq. (18-20), by breadth-first search from each robot instead of the recurrence.
/// Throws std::invalid_argument where the matrix is not square, or not symmetric, or its diagonal is not zero.
HopCount CountHops(const Eigen::Ref<const Adjacency>& adjacency);

}  // namespace robotteamsim
