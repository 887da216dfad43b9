// Elements and the time integration in states that no good run meets: finite, energy accounted for,
// or stopped with a RunError that names the node, the tool or the ledger.

#include "dynamics/scenes.hpp"
#include "fuzz/properties.hpp"
#include "support/claim.hpp"

#include <doctest/doctest.h>

#include <cmath>
#include <functional>
#include <limits>
#include <map>
#include <string>
#include <vector>

namespace {

using namespace scenes;
using verify::claim;

constexpr double not_a_number = std::numeric_limits<double>::quiet_NaN();

bool all_finite(const Points& x) {
  for (const auto& p : x)
    if (!p.allFinite()) return false;
  return true;
}

/// A block of one element kind with forces, energy and gradient check.
template <class Kind>
struct Patch {
  using Element = typename Kind::Element;
  static constexpr int n = 2;
  Mesh<Element::corners> m{mesh<Element::corners>(
      [] {
        Points X;
        for (int i = 0; i <= n; ++i)
          for (int j = 0; j <= n; ++j) X.push_back({3.0 * i, 3.0 * j, 0});
        return X;
      }(),
      cells<Element::corners>(n, n), 0.3, pi / 2)};
  Woven<ConstantShear<double>> law = fabric(pi / 2, 0.01);
  MembraneSweep<Lane, Element, Woven<ConstantShear<double>>> sweep{m, law, areal_mass,
                                                                   MembraneOptions{1e-3, 0}};
  [[nodiscard]] Points reference() const {
    Points X;
    for (int k = 0; k < m.node_count; ++k) X.push_back(eigen(m.nodes.get(k)));
    return X;
  }
};

/// What a run came to: bits of a sum over everything it holds, or the message that stopped it.
struct End {
  bool finite = false;
  std::string stopped;
  double drift = 0;  ///< of the ledger's residual since the first sample, over the energies in it
};

template <class Run>
End advance(Run& run, int steps,
            const std::function<void(int, NodalState<double>&)>& disturb = {}) {
  End end;
  EnergyLedger row;
  double first = 0, size = 0;
  bool sampled = false;
  try {
    for (int k = 0; k < steps; ++k) {
      if (disturb) disturb(k, run.state());
      run.step(&row);
      if (!sampled) first = row.residual();
      sampled = true;
      size = std::max({size, row.value("kinetic"),
                       row.stored() - row.value("kinetic") - row.value("contact"),
                       std::abs(row.value("tools"))});
      // Slack yarns without bending store nothing: what they leave is the rounding of strains,
      // 1e-32 of a stiffness times an area, 1e-29 kN mm. Below 1e-24 nothing can be compared.
      end.drift = std::max(end.drift, std::abs(row.residual() - first) / std::max(size, 1e-24));
    }
  } catch (const RunError& error) {
    end.stopped = error.what();
  }
  Points velocities;
  for (int n = 0; n < run.state().node_count; ++n)
    velocities.push_back(eigen(run.state().v.get(n)));
  end.finite =
      all_finite(positions(run)) && all_finite(velocities) && std::isfinite(row.residual());
  return end;
}

bool names_its_reason(const std::string& text) {
  return text.find("step ") != std::string::npos &&
         (text.find("node ") != std::string::npos || text.find("tool ") != std::string::npos ||
          text.find("ledger") != std::string::npos);
}

}  // namespace

TEST_SUITE_BEGIN("stress");

TEST_CASE(
    "V-STRESS-07 elements that collapse or turn over: finite forces, or none that pass for it") {
  VERIFY_RANDOM(random, 7007);
  long silent = 0, stopped = 0, checked = 0;
  verify::Worst mirrored, rates;
  for_each_kind([&](auto kind) {
    using Kind = decltype(kind);
    Patch<Kind> patch;
    const Points X = patch.reference();
    NodalState<double> state(patch.m, areal_mass);
    const auto at = [&](const Points& x) {
      for (int n = 0; n < state.node_count; ++n) state.x.set(n, vec3(x[n]));
      return gradient(patch.sweep, state);
    };
    // In its plane an element that turned over has the metric of its mirror image: the same energy,
    // the mirrored forces.
    Points stretched = X, image = X;
    for (std::size_t n = 0; n < X.size(); ++n) {
      stretched[n] = 1.01 * X[n] + random.vector(0.05);
      image[n] = {-stretched[n].x(), stretched[n].y(), stretched[n].z()};
    }
    const Points f = at(stretched);
    const double W = energy(patch.sweep, state);
    REQUIRE(largest(f) > 1e-3);
    const Points g = at(image);
    mirrored.see(std::abs(energy(patch.sweep, state) / W - 1), Kind::name);
    for (std::size_t n = 0; n < f.size(); ++n)
      mirrored.see((Eigen::Vector3d(-g[n].x(), g[n].y(), g[n].z()) - f[n]).norm() / largest(f),
                   Kind::name, n);
    // The middle node on its way through an opposite edge and far beyond: finite, and still the
    // gradient of the energy on the other side.
    for (const double way : {0.9, 1.1, 1.5, 3.0, 30.0}) {
      Points x = X;
      x[4] += way * Eigen::Vector3d(3.1, 0.2, 0.01);
      const Points F = at(x);
      ++checked;
      silent += !all_finite(F);
      const Eigen::Vector3d h(0.3, -0.5, 0.7);
      double slope = 0;
      slope = F[4].dot(h);
      const double before = energy(patch.sweep, state), step = 1e-5;
      Points y = x;
      y[4] += step * h;
      at(y);
      const double after = energy(patch.sweep, state);
      y[4] -= 2 * step * h;
      at(y);
      const double behind = energy(patch.sweep, state);
      rates.see(std::abs((after - behind) / (2 * step) - slope) / (std::abs(slope) + before),
                Kind::name, way);
    }
    // Collapsed to a point, to a line along a yarn or across, coordinates of no size, of any size,
    // NaN: the time integration must not let them pass.
    const std::vector<std::function<Eigen::Vector3d(const Eigen::Vector3d&)>> maps{
        [](const Eigen::Vector3d&) { return Eigen::Vector3d(0, 0, 0); },
        [](const Eigen::Vector3d& p) { return Eigen::Vector3d(p.x(), 0, 0); },
        [](const Eigen::Vector3d& p) {
          return Eigen::Vector3d(std::cos(0.3) * p.x(), std::sin(0.3) * p.x(), 0);
        },
        [](const Eigen::Vector3d& p) { return Eigen::Vector3d(p.x(), p.x(), 0); },
        [](const Eigen::Vector3d& p) { return Eigen::Vector3d(p.x() + p.y(), 0, 0); },
        [](const Eigen::Vector3d& p) -> Eigen::Vector3d { return 1e-300 * p; },
        [](const Eigen::Vector3d& p) -> Eigen::Vector3d { return 1e-150 * p; },
        [](const Eigen::Vector3d& p) -> Eigen::Vector3d { return 1e-8 * p; },
        [](const Eigen::Vector3d& p) -> Eigen::Vector3d { return 1e8 * p; },
        [](const Eigen::Vector3d& p) -> Eigen::Vector3d { return 1e150 * p; },
        [](const Eigen::Vector3d& p) -> Eigen::Vector3d { return 1e300 * p; },
        [](const Eigen::Vector3d& p) { return Eigen::Vector3d(p.x(), not_a_number, 0); },
        [](const Eigen::Vector3d& p) { return Eigen::Vector3d(p.x(), 1 / (p.y() - 3), 0); }};
    for (const auto& map : maps)
      for (const bool one_node : {false, true}) {
        NodalState<double> start(patch.m, areal_mass);
        for (int n = 0; n < start.node_count; ++n)
          if (!one_node || n == 4) start.x.set(n, vec3(map(X[n])));
        Model<double> model(start);
        model.add(std::make_unique<decltype(patch.sweep)>(patch.m, patch.law, areal_mass,
                                                          MembraneOptions{1e-3, 0.06}));
        CentralDifference<Lane> run(std::move(model), TimeStep::fraction(0.5));
        const End end = advance(run, 5);
        ++checked;
        stopped += !end.stopped.empty();
        const bool good = end.stopped.empty() ? end.finite : names_its_reason(end.stopped);
        CHECK_MESSAGE(good, std::string(Kind::name), ": ", end.stopped);
        silent += !good;
      }
  });
  CAPTURE(stopped);
  REQUIRE(checked == 3 * (5 + 2 * 13));
  REQUIRE(stopped > 20);
  claim("V-STRESS-07", static_cast<double>(silent), 0,
        "collapsed, inverted or infinite states with NaN and no RunError");
  // The same products in the same order, but for their signs.
  mirrored.claim("V-STRESS-07", 1e-13, "energy and forces of turned-over elements, mirrored");
  // Central differences with steps of 1e-5 mm at elements of 3 mm.
  rates.claim("V-STRESS-07", 1e-6,
              "forces against the energy with a node beyond the opposite edge");
}

TEST_CASE("V-STRESS-08 runs under blows: the ledger closes, or the run stops and says why") {
  struct Blow {
    const char* name;
    CellParameters<double> cell{};
    std::function<void(NodalState<double>&)> start = [](auto&) {};
  };
  const auto scaled = [](double x, double y) {
    return [x, y](NodalState<double>& s) {
      for (int n = 0; n < s.node_count; ++n) {
        const auto p = s.x.get(n);
        s.x.set(n, {x * p.x, y * p.y, p.z});
      }
    };
  };
  CellParameters<double> uneven;
  uneven.weft.youngs_modulus /= 1000;
  CellParameters<double> straight;
  straight.warp.second_moment_of_area = straight.weft.second_moment_of_area = 0;
  std::vector<Blow> blows;
  blows.push_back({"10 % warp strain at once", {}, scaled(1.1, 1)});
  blows.push_back({"10 % strain both ways at once", {}, scaled(1.1, 1.1)});
  blows.push_back({"10 % compression at once", {}, scaled(0.9, 0.9)});
  blows.push_back({"10 % compression, no bending", straight, scaled(0.9, 0.9)});
  blows.push_back({"warp 1000 times weft", uneven, scaled(1.02, 1.02)});
  blows.push_back({"warp 1000 times weft, 10 % along the weft", uneven, scaled(1, 1.1)});
  blows.push_back({"node through the opposite edge", {}, [](NodalState<double>& s) {
                     const auto p = s.x.get(4 * 9 + 4);
                     s.x.set(4 * 9 + 4, p + Vec3<double>{7, 1, 0.1});
                   }});
  blows.push_back({"1 km/s on one node", {}, [](NodalState<double>& s) {
                     s.v.set(4 * 9 + 4, {300, 200, 1000});
                   }});
  long silent = 0;
  verify::Plot plot;
  plot.claim = "V-STRESS-08";
  plot.title = "Energy accounts of sheets under blows";
  plot.x_label = "step";
  plot.y_label = "change of the ledger's residual in 50 steps over the largest energy [-]";
  plot.log_y = true;
  plot.caption =
      "Steps of a tenth of the critical one: no curve may climb without end, for what the fabric "
      "gets, the ledger has.";
  const auto drift = [&](const Blow& blow, double step_factor, verify::Curve& curve) {
    const auto m = rectangle(40, 40, 8, 8, 0.3);
    const auto law = fabric(pi / 2, 0.01, blow.cell);
    NodalState<double> state(m, areal_mass);
    blow.start(state);
    using T = NativePack<double>;
    Model<real_t<T>> model(state);
    model.add(std::make_unique<MembraneSweep<T, Quadrilateral<1>, decltype(law)>>(
        m, law, areal_mass, MembraneOptions{1e-3, 0}));
    model.add(std::make_unique<BendingSweep<T>>(m, BendingStiffness{1.4e-3, 1.4e-3}, areal_mass));
    CentralDifference<T> run(std::move(model), TimeStep::fraction(step_factor));
    curve.name = blow.name;
    double largest = 0;
    for (int part = 1; part <= 20; ++part) {
      const End end = advance(run, 50);
      // None of these blows stops the run.
      const bool good = end.stopped.empty() && end.finite;
      CHECK_MESSAGE(good, std::string(blow.name), " ", end.stopped);
      silent += !good;
      largest = std::max(largest, end.drift);
      curve.x.push_back(50.0 * part);
      curve.y.push_back(std::max(end.drift, 1e-16));
    }
    return largest;
  };
  for (const Blow& blow : blows) {
    verify::Curve curve, coarse;
    const double fine = drift(blow, 0.1, curve), rough = drift(blow, 0.25, coarse);
    plot.curves.push_back(curve);
    claim("V-STRESS-08", fine, 5e-3,
          std::string(blow.name) +
              ": largest change of the ledger's residual over the energies, "
              "steps of a tenth of the critical one");
    claim("V-STRESS-08", rough / fine, 3,
          std::string(blow.name) + ": the same at a quarter, over it", verify::Bound::lower);
  }
  verify::show(plot);

  // Random numbers put into a running model: positions, velocities, masses, a tool's motion.
  VERIFY_RANDOM(random, 7008);
  const auto special = [&] {
    const auto& all = fuzz::special_numbers;
    const double x = all[static_cast<std::size_t>(random.uniform(0, all.size()))];
    return random.uniform(0, 1) < 0.5 ? x : -x;
  };
  long stopped = 0, finite = 0;
  for (int k = 0; k < 600; ++k) {
    const auto m = rectangle(15, 15, 3, 3, 0.3);
    const auto law = fabric(pi / 2, 0.01);
    Model<double> model(NodalState<double>(m, areal_mass), 0.02);
    model.add(std::make_unique<MembraneSweep<Lane, Quadrilateral<1>, decltype(law)>>(
        m, law, areal_mass, MembraneOptions{1e-3, 0.06}));
    model.add(std::make_unique<BendingSweep<Lane>>(m, BendingStiffness{1.4e-3, 0.0}, areal_mass));
    const int kind = k % 6, node = static_cast<int>(random.uniform(0, 16));
    const double value = special(), when = random.uniform(0, 20);
    const auto motion = [kind, value](double t) { return kind == 4 && t > 1e-3 ? value : 10 * t; };
    ContactParameters contact;
    contact.friction_model = k % 12 < 6 ? Friction::elastic_stick : Friction::viscous;
    model.add(tool<Lane>(Sphere<double>({7, 8, -30.001}, 30), ToolMotion::prescribed(motion),
                         contact, m.node_count));
    model.add(tool<Lane>(
        Plane<double>({0, 0, 0.1}, {0, 0, -1}),
        ToolMotion::free_under(
            [kind, value](double t) { return kind == 5 && t > 1e-3 ? value : -0.01; }, 1e-3, 1),
        contact, m.node_count));
    CentralDifference<Lane> run(std::move(model), TimeStep::fraction(0.5));
    const End end = advance(run, 40, [&](int step, NodalState<double>& s) {
      if (step != static_cast<int>(when)) return;
      if (kind == 0) s.x.x[node] = value;
      if (kind == 1) s.x.z[node] = value;
      if (kind == 2) s.v.y[node] = value;
      if (kind == 3) s.inverse_mass[node] = value;
    });
    const bool good = end.stopped.empty() ? end.finite : names_its_reason(end.stopped);
    CHECK_MESSAGE(good, "kind ", kind, ", ", value, ", node ", node, ": ", end.stopped);
    silent += !good;
    stopped += !end.stopped.empty();
    finite += end.stopped.empty();
  }
  CAPTURE(stopped);
  CAPTURE(finite);
  REQUIRE(stopped > 100);
  REQUIRE(finite > 100);
  claim("V-STRESS-08", static_cast<double>(silent), 0,
        "runs with NaN and no RunError, or a RunError without node, tool or "
        "ledger");
}

TEST_SUITE_END();
