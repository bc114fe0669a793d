// The path loss of a 2 x 2 m map behind a wall of 7 dB.
#include <iostream>
#include <robotteamsim/propagation/radio.hpp>

int main() {
  using namespace robotteamsim;
  const propagation::FaceSet wall({{1000, -5000, 1000, 5000}}, {140});
  const propagation::RadioModel model{0.0, 40.0, 30.0, 0.1, 0.0, 0.0};
  propagation::MapValues map(2, 2);
  propagation::WriteHighest(wall, {{{500, 500}, propagation::RadioFading(model)}}, {{0.0, 0.0}, 1.0, 2, 2}, map);
  std::cout << -map << '\n';
}
