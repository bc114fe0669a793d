#include "robotteamsim/maps/submap_search.hpp"

#include <algorithm>
#include <cmath>
#include <stdexcept>

#include "robotteamsim/base/checks.hpp"
#include "robotteamsim/maps/distance_field.hpp"

namespace robotteamsim::maps {
namespace {

/// The search begins with blocks of 2^kTop x 2^kTop places.
constexpr int kTop = 6;
constexpr int kMargin = 1 << kTop;

constexpr double kTurn = 6.283185307179586;

/// No submap is wider [m].
constexpr double kWidest = 1000.0;

/// With a submap that is smaller than this, directions are still tried in steps that are small enough [m].
constexpr double kLeastRadius = 1.0;

}  // namespace

SubmapSearch::SubmapSearch(const plan::GridShape& shape, const std::vector<std::uint8_t>& occupied, double tolerance_m)
    : shape_(shape), tolerance_m_(tolerance_m), stride_(shape.cols + kMargin) {
  base::CheckPositive(tolerance_m, "tolerance_m");
  const std::vector<float> distances_m = DistanceField(shape, occupied).distances_m();
  const int height = shape.rows + kMargin;
  layers_.assign(kTop + 1, std::vector<std::uint8_t>(static_cast<std::size_t>(height) * stride_));
  for (int row = 0; row < shape.rows; ++row) {
    for (int col = 0; col < shape.cols; ++col) {
      const bool near = distances_m[static_cast<std::size_t>(row) * shape.cols + col] <= tolerance_m;
      layers_[0][static_cast<std::size_t>(row + kMargin) * stride_ + col + kMargin] = near;
    }
  }
  // The block at a cell consists of four blocks of the layer below.
  for (int layer = 1; layer <= kTop; ++layer) {
    const int half = 1 << (layer - 1);
    const std::vector<std::uint8_t>& below = layers_[layer - 1];
    for (int row = 0; row < height; ++row) {
      for (int col = 0; col < stride_; ++col) {
        std::uint8_t any = 0;
        for (const int r : {row, std::min(row + half, height - 1)}) {
          for (const int c : {col, std::min(col + half, stride_ - 1)})
            any |= below[static_cast<std::size_t>(r) * stride_ + c];
        }
        layers_[layer][static_cast<std::size_t>(row) * stride_ + col] = any;
      }
    }
  }
}

bool SubmapSearch::MayHit(int height, int row, int col) const {
  if (row < -kMargin || row >= shape_.rows || col < -kMargin || col >= shape_.cols) return false;
  return layers_[height][static_cast<std::size_t>(row + kMargin) * stride_ + col + kMargin] != 0;
}

/// One search: the places of the mean of the points, in all directions.
class SubmapSearch::Search {
 public:
  Search(const SubmapSearch& map, const std::vector<base::Point>& points, const Limits& limits)
      : map_(map), limits_(limits), points_(points) {
    for (const base::Point& point : points_) {
      middle_.x += point.x / static_cast<double>(points_.size());
      middle_.y += point.y / static_cast<double>(points_.size());
    }
    double radius = kLeastRadius;
    for (base::Point& point : points_) {
      point = {point.x - middle_.x, point.y - middle_.y};
      radius = std::max(radius, std::hypot(point.x, point.y));
    }
    if (radius > kWidest) throw std::invalid_argument("the points of a submap are more than 1 km apart");
    turns_ = base::ClampedInt(std::ceil(kTurn * radius / map_.tolerance_m_), 1, 1 << 20);
  }

  std::vector<Match> Run() {
    std::vector<Block> blocks;
    for (int turn = 0; turn < turns_; ++turn) {
      const std::vector<Cell> cells = CellsOf(turn);
      for (int row = 0; row < map_.shape_.rows; row += kMargin) {
        for (int col = 0; col < map_.shape_.cols; col += kMargin) {
          const int most = CountOf(cells, kTop, row, col);
          if (most >= limits_.least_share * static_cast<double>(points_.size())) {
            blocks.push_back({most, turn, row, col});
          }
        }
      }
    }
    std::stable_sort(blocks.begin(), blocks.end(), [](const Block& a, const Block& b) { return a.most > b.most; });
    for (const Block& block : blocks) {
      if (block.most < Least()) break;
      Divide(CellsOf(block.turn), block, kTop);
      if (static_cast<int>(found_.size()) >= limits_.most) break;
    }
    std::vector<Match> matches;
    for (const Block& place : found_) matches.push_back(MatchOf(place));
    return matches;
  }

 private:
  struct Cell {
    int row;
    int col;
  };

  /// A block of places of the middle, in one direction, and how many points may hit at any of them.
  struct Block {
    int most;
    int turn;
    int row;
    int col;
  };

  /// The fewest points that must hit.
  double Least() const {
    return std::max(limits_.least_share * static_cast<double>(points_.size()), limits_.ratio * best_);
  }

  /// The cells of the points in a direction, relative to that of their middle.
  std::vector<Cell> CellsOf(int turn) const {
    const double angle = kTurn * turn / turns_;
    const double cos = std::cos(angle) / map_.shape_.resolution_m, sin = std::sin(angle) / map_.shape_.resolution_m;
    std::vector<Cell> cells;
    cells.reserve(points_.size());
    for (const base::Point& point : points_) {
      cells.push_back({static_cast<int>(std::lround(sin * point.x + cos * point.y)),
                       static_cast<int>(std::lround(cos * point.x - sin * point.y))});
    }
    return cells;
  }

  int CountOf(const std::vector<Cell>& cells, int height, int row, int col) const {
    int count = 0;
    for (const Cell& cell : cells) count += map_.MayHit(height, row + cell.row, col + cell.col) ? 1 : 0;
    return count;
  }

  void Divide(const std::vector<Cell>& cells, const Block& block, int height) {
    if (height == 0) return Add(block);
    const int half = 1 << (height - 1);
    std::vector<Block> parts;
    for (const int row : {block.row, block.row + half}) {
      for (const int col : {block.col, block.col + half}) {
        if (row >= map_.shape_.rows || col >= map_.shape_.cols) continue;
        parts.push_back({CountOf(cells, height - 1, row, col), block.turn, row, col});
      }
    }
    std::stable_sort(parts.begin(), parts.end(), [](const Block& a, const Block& b) { return a.most > b.most; });
    for (const Block& part : parts) {
      if (part.most >= Least()) Divide(cells, part, height - 1);
    }
  }

  /// Keeps a place unless a better one is the same, and drops those that are the same as it, or no longer good enough.
  void Add(const Block& place) {
    if (static_cast<int>(found_.size()) >= limits_.most) return;
    const bool is_known = std::any_of(found_.begin(), found_.end(), [&](const Block& other) {
      return other.most >= place.most && AreSame(other, place);
    });
    if (is_known) return;
    best_ = std::max(best_, static_cast<double>(place.most));
    found_.erase(std::remove_if(found_.begin(), found_.end(),
                                [&](const Block& other) { return other.most < Least() || AreSame(other, place); }),
                 found_.end());
    const auto worse = [](const Block& a, const Block& b) { return a.most > b.most; };
    found_.insert(std::upper_bound(found_.begin(), found_.end(), place, worse), place);
  }

  bool AreSame(const Block& a, const Block& b) const {
    const double distance_m = map_.shape_.resolution_m * std::hypot(a.row - b.row, a.col - b.col);
    const double turned = std::abs(base::NormaliseAngle(kTurn * (a.turn - b.turn) / turns_));
    return distance_m < limits_.distinct_m && turned < limits_.distinct_rad;
  }

  Match MatchOf(const Block& place) const {
    const double angle = kTurn * place.turn / turns_, cos = std::cos(angle), sin = std::sin(angle);
    const plan::GridShape& shape = map_.shape_;
    const double x = shape.origin.x + (place.col + 0.5) * shape.resolution_m;
    const double y = shape.origin.y + (place.row + 0.5) * shape.resolution_m;
    return {
        {x - (cos * middle_.x - sin * middle_.y), y - (sin * middle_.x + cos * middle_.y), base::NormaliseAngle(angle)},
        place.most / static_cast<double>(points_.size())};
  }

  const SubmapSearch& map_;
  const Limits& limits_;
  std::vector<base::Point> points_;  ///< relative to their middle
  base::Point middle_;
  int turns_ = 1;
  double best_ = 0.0;         ///< points that hit at the best place so far
  std::vector<Block> found_;  ///< by descending number of points that hit
};

std::vector<SubmapSearch::Match> SubmapSearch::Find(const std::vector<base::Point>& points,
                                                    const Limits& limits) const {
  for (const double limit : {limits.least_share, limits.ratio, limits.distinct_m, limits.distinct_rad}) {
    base::CheckPositive(limit, "a limit of the search");
  }
  for (const base::Point& point : points) base::Check(point, "a point of a submap");
  if (points.empty()) return {};
  return Search(*this, points, limits).Run();
}

}  // namespace robotteamsim::maps
