#include "robotteamsim/hazards/links.hpp"

#include <cstddef>
#include <stdexcept>
#include <utility>

#include "robotteamsim/base/checks.hpp"

namespace robotteamsim::hazards {
namespace {

constexpr float kPassable = 0.5F;

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
  openness_.assign(doors, 1.0);
  open_east_.assign(PaddedSize(), 0.0F);
  open_north_.assign(PaddedSize(), 0.0F);
  for (int cell = 0; cell < static_cast<int>(size); ++cell) {
    const int row = cell / cols, col = cell % cols;
    open_east_[Padded(cell)] = col + 1 < cols && east[cell] != 0 ? 1.0F : 0.0F;
    open_north_[Padded(cell)] = row + 1 < rows && north[cell] != 0 ? 1.0F : 0.0F;
  }
  Update();
}

void Links::SetDoor(int door, double openness) {
  base::CheckNotNegative(openness, "openness");
  if (openness > 1.0) throw std::invalid_argument("openness must be at most 1");
  openness_.at(door) = openness;
  Update();
}

bool Links::IsOpen(int padded, int direction) const {
  switch (direction) {
    case 0:
      return east_[padded] >= kPassable;
    case 1:
      return north_[padded] >= kPassable;
    case 2:
      return east_[padded - 1] >= kPassable;
    default:
      return north_[padded - stride()] >= kPassable;
  }
}

void Links::Update() {
  east_ = open_east_;
  north_ = open_north_;
  for (const Crossing& crossing : crossings_) {
    std::vector<float>& links = crossing.is_east ? east_ : north_;
    links[Padded(crossing.cell)] *= static_cast<float>(openness_[crossing.door]);
  }
}

}  // namespace robotteamsim::hazards
