#pragma once

#include <Eigen/Core>
#include <cstdint>

#include "robotteamsim/network/link_bits.hpp"

namespace robotteamsim::network {

/// Numbers of hops between robots.
using HopCount = Eigen::Matrix<std::int32_t, Eigen::Dynamic, Eigen::Dynamic, Eigen::RowMajor>;

/// Returns the smallest number of links between all pairs of robots: 0 on the diagonal, -1 where no path exists.
///
/// These are the numbers C of eq. (18-20), by breadth-first search from each robot over rows of bits.
/// Throws std::invalid_argument if the matrix is not square, or not symmetric, or its diagonal is not zero.
HopCount CountHops(const Eigen::Ref<const Adjacency>& adjacency);

}  // namespace robotteamsim::network
