// A sheet without forces, slowed down by mass damping: x = (1 - exp(-alpha t)) / alpha.

#include "crossbeam/adapters/sundials.hpp"
#include "crossbeam/crossbeam.hpp"

#include <cmath>
#include <cstdio>

int main() {
  using namespace crossbeam;
  const Mesh<4> mesh = rectangle(4, 4, 2, 2);
  Model<double> model(NodalState<double>(mesh, 1e-6), 1.0);
  for (int n = 0; n < mesh.node_count; ++n) model.nodes().v.set(n, {1, 0, 0});
  reference::RungeKutta5 integrator(model, {1e-10, 1e-10});
  integrator.advance(1);
  const double off = model.nodes().x.get(0).x - (1 - std::exp(-1.0));
  std::printf("off by %.1e mm\n", off);
  return std::abs(off) < 1e-8 ? 0 : 1;
}
