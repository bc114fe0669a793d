#include "robotteamsim/network/fiedler.hpp"

#include <Spectra/SymEigsSolver.h>

#include <Eigen/Eigenvalues>
#include <Eigen/SparseCholesky>
#include <algorithm>
#include <stdexcept>
#include <vector>

namespace robotteamsim::network {
namespace {

/// Up to this size, computing all eigenvalues of a dense matrix is the fastest.
constexpr int kSmallTeam = 24;

/// Up to this average number of neighbours the factors stay sparse enough to pay off.
constexpr double kFewNeighbors = 40.0;

/// End of the iterations: the residual of a unit vector over its eigenvalue. It bounds the relative error; the error
/// itself is about the residual's square over the relative gap to the next eigenvalue.
constexpr double kResidual = 1e-7;

constexpr int kMaxRestarts = 1000;

double SmallFiedlerValue(const Eigen::Ref<const Adjacency>& adjacency) {
  Eigen::MatrixXd laplacian = -adjacency.cast<double>();
  laplacian.diagonal() = -laplacian.rowwise().sum();
  const Eigen::SelfAdjointEigenSolver<Eigen::MatrixXd> solver(laplacian, Eigen::EigenvaluesOnly);
  return solver.eigenvalues()[1];
}

/// x -> Lp^-1 x on the vectors of sum 0, on which Lp has an inverse; the component orthogonal to them becomes 0. The
/// largest eigenvalue is 1 / the Fiedler value.
class InverseLaplacian {
 public:
  using Scalar = double;

  InverseLaplacian(const Neighbors& neighbors, int n) : n_(n) {
    // Without its last row and column, which are redundant, the matrix is positive definite.
    Eigen::SparseMatrix<double> lower(n - 1, n - 1);
    lower.reserve(static_cast<Eigen::Index>(neighbors.robots.size() / 2) + n);
    for (int j = 0; j < n - 1; ++j) {
      lower.startVec(j);
      lower.insertBack(j, j) = neighbors.Count(j);
      for (std::int32_t e = neighbors.start[j]; e < neighbors.start[j + 1]; ++e) {
        const int i = neighbors.robots[e];
        if (i > j && i < n - 1) lower.insertBack(i, j) = -1.0;
      }
    }
    lower.finalize();
    factors_.compute(lower);
  }

  Eigen::Index rows() const { return n_; }
  Eigen::Index cols() const { return n_; }

  void perform_op(const double* x, double* y) const {
    const Eigen::Map<const Eigen::VectorXd> vector(x, n_);
    Eigen::Map<Eigen::VectorXd> result(y, n_);
    result.head(n_ - 1) = factors_.solve((vector.head(n_ - 1).array() - vector.mean()).matrix());
    result[n_ - 1] = 0.0;
    result.array() -= result.mean();
  }

 private:
  int n_;
  Eigen::SimplicialLDLT<Eigen::SparseMatrix<double>> factors_;
};

/// x -> Lp x, except that a constant vector is multiplied by the mean of the other eigenvalues instead of 0: then the
/// smallest eigenvalue is the Fiedler value, and the largest does not change.
///
/// A x sums numbers that bits select. For 8 columns there are 256 such sums: they are computed once and looked up in
/// every row [arlazarov1970].
class DenseLaplacian {
 public:
  using Scalar = double;

  explicit DenseLaplacian(const LinkBits& links) : n_(links.NumRobots()), degree_(n_) {
    const int n = n_;
    for (int w = 0; w < links.NumWords(); ++w) {
      for (int i = 0; i < n; ++i) words_.push_back(links.Row(i)[w]);
    }
    for (int i = 0; i < n; ++i) degree_[i] = links.Degree(i);
    mean_eigenvalue_ = degree_.sum() / (n - 1);
  }

  Eigen::Index rows() const { return n_; }
  Eigen::Index cols() const { return n_; }

  void perform_op(const double* x, double* y) const {
    const Eigen::Map<const Eigen::VectorXd> vector(x, n_);
    Eigen::Map<Eigen::VectorXd> result(y, n_);
    result = degree_.cwiseProduct(vector);
    result.array() += mean_eigenvalue_ * vector.mean();
    for (int first = 0; first < n_; first += LinkBits::kBitsPerWord) {
      SubtractSums(&words_[static_cast<std::size_t>(first / LinkBits::kBitsPerWord) * n_], SumsOf(x, first), y);
    }
  }

 private:
  static constexpr int kBytes = 8;
  struct Sums {
    double of[kBytes][256];  // sums of 8 numbers each, selected by the bits of a byte
  };

  Sums SumsOf(const double* x, int first) const {
    Sums sums;
    for (int byte = 0; byte < kBytes; ++byte) {
      double halves[2][16] = {};
      for (int bit = 0; bit < 8; ++bit) {
        const int column = first + byte * 8 + bit;
        double* const half = halves[bit / 4];
        const int count = 1 << (bit % 4);
        for (int i = 0; i < count; ++i) half[count + i] = half[i] + (column < n_ ? x[column] : 0.0);
      }
      for (int high = 0; high < 16; ++high) {
        for (int low = 0; low < 16; ++low) sums.of[byte][16 * high + low] = halves[1][high] + halves[0][low];
      }
    }
    return sums;
  }

  void SubtractSums(const std::uint64_t* words, const Sums& sums, double* y) const {
    const auto& of = sums.of;
    for (int i = 0; i < n_; ++i) {
      const std::uint64_t w = words[i];
      const double first_half = (of[0][w & 255] + of[1][w >> 8 & 255]) + (of[2][w >> 16 & 255] + of[3][w >> 24 & 255]);
      const double second_half =
          (of[4][w >> 32 & 255] + of[5][w >> 40 & 255]) + (of[6][w >> 48 & 255] + of[7][w >> 56]);
      y[i] -= first_half + second_half;
    }
  }

  int n_;
  std::vector<std::uint64_t> words_;  // word by word, each for all robots
  Eigen::VectorXd degree_;
  double mean_eigenvalue_;  // of Lp, without the eigenvalue 0
};

template <typename Matrix>
double ExtremeEigenvalue(Matrix matrix, Spectra::SortRule which, int num_vectors) {
  Spectra::SymEigsSolver<Matrix> solver(matrix, 1, num_vectors);
  solver.init();
  solver.compute(which, kMaxRestarts, kResidual);
  if (solver.info() != Spectra::CompInfo::Successful) throw std::runtime_error("the Fiedler value did not converge");
  return solver.eigenvalues()[0];
}

}  // namespace

double FiedlerValue(const Eigen::Ref<const Adjacency>& adjacency) {
  const LinkBits links(adjacency);
  const int n = links.NumRobots();
  if (n == 0) throw std::invalid_argument("adjacency must hold at least one robot");
  if (n == 1) return 1.0;
  if (!links.IsConnected()) return 0.0;
  double num_neighbors = 0.0;
  for (int i = 0; i < n; ++i) num_neighbors += links.Degree(i);
  // Lp acts as n times the identity: no iteration is needed.
  if (num_neighbors == static_cast<double>(n) * (n - 1)) return n;
  if (n <= kSmallTeam) return SmallFiedlerValue(adjacency);
  if (num_neighbors <= kFewNeighbors * n) {
    return 1.0 / ExtremeEigenvalue(InverseLaplacian(Neighbors(links), n), Spectra::SortRule::LargestAlge, 8);
  }
  return ExtremeEigenvalue(DenseLaplacian(links), Spectra::SortRule::SmallestAlge, 20);
}

}  // namespace robotteamsim::network
