#include "robotteamsim/hazards/links.hpp"

#include <algorithm>
#include <cstddef>
#include <stdexcept>
#include <utility>

#include "robotteamsim/base/checks.hpp"

namespace robotteamsim::hazards {
namespace {

constexpr double kMostShare = 2.0;

}  // namespace

Links::Links(int rows, int cols, const std::vector<std::uint8_t>& east, const std::vector<std::uint8_t>& north,
             std::vector<Crossing> crossings, int doors)
    : rows_(rows), cols_(cols), crossings_(std::move(crossings)) {
  if (rows < 1 || cols < 1 || doors < 0) throw std::invalid_argument("a grid needs at least one cell");
  const std::size_t size = static_cast<std::size_t>(rows) * cols;
  if (east.size() != size || north.size() != size) throw std::invalid_argument("each cell must have two links");
  for (const Crossing& crossing : crossings_) {
    if (crossing.door < 0 || crossing.door >= doors || crossing.cell < 0 ||
        static_cast<std::size_t>(crossing.cell) >= size) {
      throw std::invalid_argument("a crossing must be of a door and a cell of the grid");
    }
  }
  doors_.assign(doors, {});
  open_east_.assign(PaddedSize(), 0.0F);
  open_north_.assign(PaddedSize(), 0.0F);
  for (int cell = 0; cell < static_cast<int>(size); ++cell) {
    const int row = cell / cols, col = cell % cols;
    open_east_[Padded(cell)] = col + 1 < cols && east[cell] != 0 ? 1.0F : 0.0F;
    open_north_[Padded(cell)] = row + 1 < rows && north[cell] != 0 ? 1.0F : 0.0F;
  }
  Update();
}

void Links::SetDoor(int door, double share, bool passes_fire) {
  base::CheckNotNegative(share, "share");
  if (share > kMostShare) throw std::invalid_argument("share must be at most 2");
  doors_.at(door) = {static_cast<float>(share), passes_fire};
  Update();
}

bool Links::IsOpen(int padded, int direction) const {
  switch (direction) {
    case 0:
      return passes_east_[padded] != 0;
    case 1:
      return passes_north_[padded] != 0;
    case 2:
      return passes_east_[padded - 1] != 0;
    default:
      return passes_north_[padded - stride()] != 0;
  }
}

void Links::Update() {
  east_ = open_east_;
  north_ = open_north_;
  passes_east_.assign(open_east_.begin(), open_east_.end());
  passes_north_.assign(open_north_.begin(), open_north_.end());
  for (const Crossing& crossing : crossings_) {
    const DoorState& door = doors_[crossing.door];
    const int padded = Padded(crossing.cell);
    (crossing.is_east ? east_ : north_)[padded] *= door.share;
    if (!door.passes_fire) (crossing.is_east ? passes_east_ : passes_north_)[padded] = 0;
  }
  largest_pair_ = 2.0;
  for (const Crossing& crossing : crossings_) {
    const std::vector<float>& links = crossing.is_east ? east_ : north_;
    const int padded = Padded(crossing.cell), next = crossing.is_east ? 1 : stride();
    const double pair = links[padded] + std::max(links[padded - next], links[padded + next]);
    largest_pair_ = std::max(largest_pair_, pair);
  }
}

}  // namespace robotteamsim::hazards
