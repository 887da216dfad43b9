// A model that cannot be put together wrongly: what belongs together is compared where it meets, the
// order of calls is checked, types that are no law are refused, and the smallest type that satisfies
// a documented concept goes through every public path.

#include "crossbeam/model/statics.hpp"
#include "crossbeam/sweep/membrane_tangent.hpp"
#include "dynamics/scenes.hpp"
#include "support/claim.hpp"

#include <doctest/doctest.h>

#include <cstring>
#include <stdexcept>
#include <string>
#include <vector>

namespace {

using namespace scenes;
using verify::claim;

/// The smallest shear layer: it has what ShearLaw asks for and nothing else. The paper's, at 90 deg.
struct SmallShear {
  double G = 0.01;
  template <class T>
  StrainGradient<T> gradient(const FibreState<T>& s) const {
    return {T(0), T(0), T(2 * G) * s.beta.b12};
  }
  template <class T>
  T energy(const FibreState<T>& s) const {
    return T(G) * s.beta.b12 * s.beta.b12;
  }
  template <class T>
  StrainHessian<T> hessian(const FibreState<T>&) const {
    return {T(0), T(0), T(2 * G), T(0), T(0), T(0)};
  }
  [[nodiscard]] double modulus_bound() const { return G; }
};
static_assert(ShearLaw<SmallShear, double>);

/// The smallest cell: two springs that know nothing of each other, without a potential.
struct SmallCell {
  using Real = double;
  CellParameters<double> p{};
  template <class T>
  struct Solution {
    CellForces<T> forces{};
    CellStatus status = CellStatus::converged;
    T fallback{};
  };
  [[nodiscard]] const CellParameters<double>& parameters() const { return p; }
  template <class T>
  Solution<T> solve(const T& u1, const T& u2, SolverControl) const {
    Solution<T> out;
    out.forces.F1 = T(10.0) * u1;
    out.forces.F2 = T(10.0) * u2;
    return out;
  }
  [[nodiscard]] double membrane_stiffness_bound(double sine) const { return 50 / sine; }
};
static_assert(UnitCell<SmallCell, double>);

/// The smallest membrane law: no cell, no potential, no tangent.
struct SmallLaw {
  using Real = double;
  FibreAngle<double> angle = FibreAngle<double>::right();
  template <class T>
  struct State {
    FibreState<T> fibres;
  };
  [[nodiscard]] const FibreAngle<double>& reference() const { return angle; }
  template <class T>
  State<T> evaluate(const FibreStrain<T>& b) const {
    return {{b, stretch(b.b11), stretch(b.b22)}};
  }
  template <class T>
  FibreStress<T> stress(const State<T>& s) const {
    return {T(10.0) * s.fibres.beta.b11, T(10.0) * s.fibres.beta.b22, s.fibres.beta.b12};
  }
  template <class T>
  T shear_energy(const State<T>& s) const {
    return s.fibres.beta.b12 * s.fibres.beta.b12;
  }
  template <class T>
  Vector2<T> yarn_tension(const State<T>& s) const {
    return {T(10.0) * s.fibres.beta.b11 * s.fibres.lambda1,
            T(10.0) * s.fibres.beta.b22 * s.fibres.lambda2};
  }
  [[nodiscard]] double stiffness_bound() const { return 20; }
};
static_assert(MembraneLaw<SmallLaw, double>);

/// The smallest tool: the half space below z = 0.
struct SmallSurface {
  template <class T>
  SurfaceGap<T> gap(const Vec3<T>& p) const {
    return {p.z, {T(0), T(0), T(1)}, p.z};
  }
};
static_assert(Surface<SmallSurface, NativePack<double>>);

/// What is no law, cell or shear layer is refused as a template argument already.
template <class Cell, class Shear>
concept IsLaw = requires { typename WovenMembrane<Cell, Shear>; };
template <class Cell, class Shear>
concept IsFollowedLaw = requires { typename WovenMembrane<Cell, Shear, CellPrice::followed>; };
template <class Law>
concept IsFabric = requires { typename Fabric<Law>; };
static_assert(IsLaw<Cell, ConstantShear<double>> && IsLaw<SmallCell, SmallShear>);
static_assert(!IsLaw<Cell, int> && !IsLaw<SmallShear, SmallShear> && !IsLaw<Cell, Cell>);
static_assert(IsFollowedLaw<Cell, SmallShear>);
static_assert(!IsFollowedLaw<SmallCell, SmallShear> &&
              !IsFollowedLaw<SecondOrderCell<double>, SmallShear>);
static_assert(IsFabric<SmallLaw> && !IsFabric<Cell>);
// A simulation takes a whole model: nothing can be added to it, and its step is named.
template <class Run>
concept CanBeAddedTo =
    requires(Run run, std::unique_ptr<ForceBlock<double>> block) { run.add(std::move(block)); };
static_assert(CanBeAddedTo<Model<double>> && !CanBeAddedTo<CentralDifference<Lane>>);
static_assert(!std::is_constructible_v<CentralDifference<Lane>, Model<double>>);
static_assert(!std::is_constructible_v<CentralDifference<Lane>, Model<double>, double>);

/// Text of an error, empty for none.
template <class Error = InputError, class Call>
std::string refusal(Call call) {
  try {
    call();
  } catch (const Error& error) {
    return error.what();
  }
  return "";
}
bool names(const std::string& text, std::initializer_list<const char*> words) {
  for (const char* word : words)
    if (text.find(word) == std::string::npos) {
      MESSAGE("'", text, "' does not say '", std::string(word), "'");
      return false;
    }
  return true;
}

constexpr MembraneOptions membrane{.hourglass_modulus = 1e-3, .bulk_viscosity = 0.06};
const FabricProperties properties{.areal_mass = areal_mass, .bending = {1e-3, 2e-3}};

template <class Law>
auto sheet_of(const Law& law, int n = 4) {
  return FabricModel(rectangle(5.0 * n, 5.0 * n, n, n), Fabric(law, properties),
                     {.constraints = fixed_rim(n, n), .mass_damping = 0.1});
}

/// Steps a taut sheet through everything that a block offers; positions of the nodes at the end.
template <class Model>
Points exercised(Model model) {
  for (int n = 0; n < model.nodes().node_count; ++n) {
    const Vec3<double> X = model.nodes().x.get(n);
    model.nodes().x.set(n, {1.01 * X.x, 1.01 * X.y, 0.01 * std::sin(X.x) * std::sin(X.y)});
  }
  model.add_tool(SmallSurface{}, ToolMotion::prescribed([](double t) { return 0.01 + 0.1 * t; }));
  CentralDifference run(std::move(model), TimeStep::fraction(0.5));
  run.advance(50);
  const EnergyLedger ledger = run.sampled_step();
  std::vector<ElementSample> samples;
  for (const auto& block : run.blocks()) block->sample(run.state(), samples);
  REQUIRE(samples.size() == 16);
  REQUIRE(ledger.value("shear") > 0);
  REQUIRE(ledger.value("yarn") > 0);
  REQUIRE(ledger.value("tools") != 0);
  REQUIRE(std::abs(ledger.residual()) < 1e-3 * ledger.stored());
  REQUIRE(samples[5].tension[0] > 0);
  return positions(run);
}

template <class Element, class Law>
Points exercised_law(const Law& law) {
  auto model = sheet_of(law);
  model.template add_membrane<Element>(membrane);
  model.add_bending();
  return exercised(std::move(model));
}

}  // namespace

TEST_SUITE_BEGIN("model");
TEST_CASE("V-MODEL-01 what belongs together is compared where it meets") {
  const Mesh<4> mesh = rectangle(20, 20, 4, 4), finer = rectangle(20, 20, 8, 8);
  const auto law = fabric(pi / 2);
  using Law = std::decay_t<decltype(law)>;
  using Block = MembraneSweep<Lane, Quadrilateral<1>, Law>;
  const auto model = [&] { return Model<double>(NodalState<double>(mesh, areal_mass)); };
  int missed = 0;
  const auto refused = [&](const std::string& text, std::initializer_list<const char*> words) {
    missed += text.empty() || !names(text, words);
  };
  // A block or a tool of other nodes, and of another mass: by a factor that no eye sees at once.
  refused(refusal([&] { model().add(std::make_unique<Block>(finer, law, areal_mass)); }),
          {"blocks[0].node_count = 81", "25"});
  refused(refusal([&] {
            model().add(
                std::make_unique<BendingSweep<Lane>>(finer, BendingStiffness{1e-3, 0}, areal_mass));
          }),
          {"blocks[0].node_count = 81", "25"});
  refused(
      refusal([&] {
        model().add(tool<Lane>(Plane<double>({0, 0, 0}, {0, 0, 1}), ToolMotion::fixed(), {}, 10));
      }),
      {"tools[0].node_count = 10", "25"});
  refused(refusal([&] { model().add(std::make_unique<Block>(mesh, law, 1e-3)); }),
          {"blocks[0].areal_mass = 0.001", "7.43", "kg/mm^2"});
  refused(refusal([&] { model().add(std::unique_ptr<ForceBlock<double>>()); }), {"blocks[0]"});
  refused(refusal([&] { model().add(std::unique_ptr<ToolContact<double>>()); }), {"tools[0]"});
  // The angle between the yarns: of the law and of its shear layer, of the law and of the mesh.
  refused(refusal([&] {
            const FibreAngle<double> sixty(pi / 3);
            static_cast<void>(WovenMembrane(Cell(CellParameters<double>{}),
                                            between_yarns(ConstantShear<double>(0.01), sixty)));
          }),
          {"fibre angle of the law = 1.57", "1.04"});
  refused(refusal([&] { sheet_of(fabric(pi / 3)).add_membrane(); }),
          {"= 90", "deg", "the law's 59.999"});
  // The numbers of a fabric and of a model.
  refused(refusal([&] { Fabric(law, {}); }), {"fabric.areal_mass = 0", "kg/mm^2"});
  refused(refusal([&] { Fabric(law, {.areal_mass = 1, .thickness = -1}); }), {"thickness", "mm"});
  refused(refusal([&] { Fabric(law, {.areal_mass = 1, .bending = {0, -1}}); }), {"bending.weft"});
  refused(refusal([&] { Model<double>(NodalState<double>(mesh, areal_mass), -1); }),
          {"mass_damping"});
  refused(refusal([&] {
            auto twice = sheet_of(law);
            twice.add_membrane();
            twice.add_membrane();
          }),
          {"add_membrane", "second"});
  refused(refusal([&] {
            auto twice = sheet_of(law);
            twice.add_bending();
            twice.add_bending();
          }),
          {"add_bending", "second"});
  // A mirror plane beside the mesh; nodes that are a rounding off one stay on it.
  std::vector<Vec3<double>> rounded, beside;
  for (int n = 0; n < mesh.node_count; ++n) {
    const Vec3<double> X = mesh.nodes.get(n);
    rounded.push_back({X.x + 1e-6, X.y, X.z});
    beside.push_back({X.x + 1, X.y, X.z});
  }
  refused(refusal([&] {
            static_cast<void>(
                symmetry_constraints(Mesh<4>(beside, mesh.elements, mesh.fibres), {true, false}));
          }),
          {"x = 0", "no node", "mm"});
  CHECK(symmetry_constraints(Mesh<4>(rounded, mesh.elements, mesh.fibres), {true, true}).size() ==
        symmetry_constraints(mesh, {true, true}).size());
  // Bending takes the same nodes for the plane's.
  const BendingStiffness both{1e-3, 1e-3};
  CHECK(BendingSweep<Lane>(Mesh<4>(rounded, mesh.elements, mesh.fibres), both, areal_mass,
                           {true, true})
            .stencils() == BendingSweep<Lane>(mesh, both, areal_mass, {true, true}).stencils());
  // The step.
  refused(refusal([&] { TimeStep::fixed(0); }), {"time_step", "ms"});
  refused(refusal([&] { TimeStep::fraction(1.1); }), {"1.1", "at most 1"});
  refused(refusal<RunError>([&] { CentralDifference(model(), TimeStep::fraction(0.5)); }),
          {"no stiffness"});
  claim("V-MODEL-01", missed, 0, "mismatches that were taken, or refused without both sides");

  // All in one place: the same model as one put together by hand, in every bit.
  auto front = sheet_of(law);
  front.add_membrane(membrane);
  front.add_bending();
  front.nodes().v.z[12] = 3;
  Model<double> by_hand(NodalState<double>(mesh, areal_mass, fixed_rim(4, 4)), 0.1);
  using T = NativePack<double>;
  by_hand.add(
      std::make_unique<MembraneSweep<T, Quadrilateral<1>, Law>>(mesh, law, areal_mass, membrane));
  by_hand.add(std::make_unique<BendingSweep<T>>(mesh, BendingStiffness{1e-3, 2e-3}, areal_mass));
  by_hand.nodes().v.z[12] = 3;
  const auto end = [](auto whole) {
    CentralDifference run(std::move(whole), TimeStep::fraction(0.9));
    run.advance(100);
    return positions(run);
  };
  const Points a = end(std::move(front)), b = end(std::move(by_hand));
  REQUIRE(std::abs(a[12].z()) > 0.01);
  claim("V-MODEL-01", distance(a, b), 0, "front door against a model by hand: positions [mm]");
}

TEST_CASE("V-MODEL-02 calls out of order are refused, and name both calls") {
  const Mesh<4> mesh = rectangle(10, 10, 2, 2);
  const auto law = fabric(pi / 2);
  NodalState<double> state(mesh, areal_mass);
  const auto fresh = [&] {
    return tool<Lane>(Plane<double>({0, 0, -1}, {0, 0, 1}), ToolMotion::fixed(), {}, 9);
  };
  using Order = std::logic_error;
  int missed = 0;
  const auto refused = [&](const std::string& text, std::initializer_list<const char*> words) {
    missed += text.empty() || !names(text, words);
  };
  const BookedTime whole = BookedTime::whole(1e-3);
  for (const bool free : {false, true}) {
    const auto of = [&] {
      return free ? tool<Lane>(Plane<double>({0, 0, -1}, {0, 0, 1}),
                               ToolMotion::free_under([](double) { return 0.0; }, 1, 0), {}, 9)
                  : fresh();
    };
    refused(refusal<Order>([&] { of()->move(0, 1e-3); }), {"move", "follow end"});
    refused(refusal<Order>([&] { of()->book(whole); }), {"book", "follow end"});
    refused(refusal<Order>([&] {
              auto t = of();
              t->begin(1, 0, 1e-3);
              t->begin(1, 0, 1e-3);
            }),
            {"begin", "follow begin"});
    refused(refusal<Order>([&] {
              auto t = of();
              t->begin(1, 0, 1e-3);
              t->book(whole);
            }),
            {"book", "follow begin"});
    refused(refusal<Order>([&] {
              auto t = of();
              t->begin(1, 0, 1e-3);
              t->add_forces(state, 1e-3, 0, {0, 9, 0});
              t->move(0, 1e-3);
              t->move(0, 1e-3);
            }),
            {"move", "follow move"});
    // The right order, in which booking twice (two halves of a step) is one of the rights.
    auto t = of();
    for (int step = 0; step < 3; ++step) {
      t->begin(1, 0, 1e-3);
      t->add_forces(state, 1e-3, 0, {0, 9, 0});
      t->move(0, 1e-3);
      t->book(BookedTime::until_now(1e-3));
      t->book(BookedTime::from_now(1e-3));
      t->end();
    }
  }
  // A simulation closes its model, also where it is reached behind its back.
  {
    auto model = sheet_of(law);
    model.add_membrane();
    CentralDifference run(std::move(model), TimeStep::fraction(0.9));
    refused(refusal([&] { run.model().add(std::make_unique<Gravity<>>(Eigen::Vector3d::Zero())); }),
            {"blocks[1]", "simulation"});
    refused(refusal([&] {
              run.model().add(
                  tool<Lane>(Plane<double>({0, 0, -1}, {0, 0, 1}), ToolMotion::fixed(), {}, 25));
            }),
            {"tools[0]", "simulation"});
  }
  // A step that an exception left is not gone on with.
  struct Failing final : ForceBlock<double> {
    void add_forces(NodalState<double>&, double) override {
      if (++calls == 3) throw std::runtime_error("a block of one's own");
    }
    void add_energy(const NodalState<double>&, EnergyLedger&) const override {}
    [[nodiscard]] double omega_squared() const override { return 1; }
    int calls = 0;
  };
  Model<double> failing{NodalState<double>(mesh, areal_mass)};
  failing.add(Failing{});
  CentralDifference<Lane> run(std::move(failing), TimeStep::fraction(0.5));
  run.step();
  run.step();
  refused(refusal<std::runtime_error>([&] { run.step(); }), {"a block of one's own"});
  refused(refusal<RunError>([&] { run.step(); }), {"left by an exception"});
  refused(refusal<RunError>([&] { run.advance(10); }), {"left by an exception"});
  claim("V-MODEL-02", missed, 0, "calls out of order that were taken, or refused without a word");
}

TEST_CASE("V-MODEL-03 the smallest type that satisfies a concept goes through every public path") {
  const Cell cell(CellParameters<double>{});
  const auto compare = [](const Points& small, const Points& own, const char* what) {
    // Other sums of the same numbers: 50 steps of roundings.
    claim("V-MODEL-03", distance(small, own), 1e-12, std::string(what) + ": positions [mm]");
  };
  // A shear layer, with cells in equilibrium and followed, whose layer lacks the fast gradient.
  const WovenMembrane small(cell, SmallShear{});
  const WovenMembrane own(cell, ConstantShear<double>(0.01));
  compare(exercised_law<Quadrilateral<1>>(small), exercised_law<Quadrilateral<1>>(own),
          "small shear layer");
  compare(exercised_law<Quadrilateral<1>>(small.followed()),
          exercised_law<Quadrilateral<1>>(own.followed()), "small shear layer, cells followed");
  compare(exercised_law<Quadrilateral<4>>(small.followed()),
          exercised_law<Quadrilateral<4>>(own.followed()), "the same with 2x2 points");
  Matrix2<double> E;
  E << 0.01, 0.002, 0.002, 0.003;
  const auto response = membrane_response(small, E, Tangent::yes);
  const auto expected = membrane_response(own, E, Tangent::yes);
  claim("V-MODEL-03", (response.S - expected.S).norm() / expected.S.norm(), 1e-15,
        "small shear layer: stress, relative");
  claim("V-MODEL-03", (response.dS_dE - expected.dS_dE).norm() / expected.dS_dE.norm(), 1e-15,
        "small shear layer: tangent, relative");

  // A cell and a law without a potential: they run, are sampled, and their ledger closes (asked
  // for in `exercised`).
  exercised_law<Quadrilateral<1>>(WovenMembrane(SmallCell{}, SmallShear{}));
  exercised_law<Quadrilateral<1>>(
      WovenMembrane(SecondOrderCell<double>(CellParameters<double>{}), SmallShear{}));
  exercised_law<Quadrilateral<1>>(SmallLaw{});
  exercised_law<Quadrilateral<4>>(SmallLaw{});
  // Without a tangent they say so where one is asked for.
  auto model = sheet_of(SmallLaw{});
  model.add_membrane();
  StaticProblem problem(model, 0);
  std::vector<double> q(static_cast<std::size_t>(problem.unknowns()));
  problem.read(q.data());
  StaticProblem::Matrix K;
  CHECK_THROWS_WITH_AS(problem.tangent(q.data(), K), doctest::Contains("tangent"), InputError);
}

TEST_CASE("V-MODEL-04 the ledger is a list to which every force adds its own terms") {
  EnergyLedger ledger;
  ledger.add("spring", EnergyKind::stored, 2);
  ledger.add("wind", EnergyKind::supplied, 5);
  ledger.add("spring", EnergyKind::stored, 1);
  ledger.add("rubbing", EnergyKind::dissipated, 0.5);
  CHECK(ledger.value("spring") == 3);
  CHECK(ledger.residual() == 1.5);
  CHECK(ledger.terms().size() == 3);
  int missed = 0;
  missed += !names(refusal([&] { ledger.add("wind", EnergyKind::stored, 1); }),
                   {"wind", "stored", "supplied"});
  missed += !names(refusal([&] { static_cast<void>(ledger.value("winds")); }),
                   {"winds", "spring, wind, rubbing"});
  claim("V-MODEL-04", missed, 0, "wrong kinds and names that were taken");

  // A load that supplies the work it has done, instead of a potential: the ledger closes with it.
  struct Wind final : ForceBlock<double> {
    void add_forces(NodalState<double>& s, double) override {
      for (int n = 0; n < s.node_count; ++n) s.f.z[n] += 5 * s.mass[n];
    }
    void add_energy(const NodalState<double>& s, EnergyLedger& l) const override {
      double work = 0;
      for (int n = 0; n < s.node_count; ++n) work += 5 * s.mass[n] * s.x.z[n];
      l.add("wind", EnergyKind::supplied, work);
    }
    [[nodiscard]] double omega_squared() const override { return 0; }
  };
  TautSheet sheet;
  Model<double> blown = sheet.model();
  blown.add(Wind{});
  CentralDifference<Lane> run(std::move(blown), TimeStep::fraction(0.25));
  double worst = 0, size = 0;
  for (int k = 0; k < 400; ++k) {
    const EnergyLedger row = run.sampled_step();
    worst = std::max(worst, std::abs(row.residual()));
    size = std::max(size, row.value("wind"));
  }
  REQUIRE(size > 0);
  claim("V-MODEL-04", worst / size, 2e-2, "residual over the wind's work at a quarter of the step");

  // A start out of equilibrium closes from the first row on, and its residual falls with the square
  // of the step: what is stored at t = 0 is measured as the scheme measures it later.
  const auto residual = [&](int halving) {
    Model<double> model = sheet.model();
    verify::Random random(40404);
    for (int n = 0; n < model.nodes().node_count; ++n) {
      const auto x = model.nodes().x.get(n), free = model.nodes().free.get(n);
      const auto d = random.vector(1e-2);
      model.nodes().x.set(n, x + Vec3<double>{free.x * d.x(), free.y * d.y(), free.z * d.z()});
      model.nodes().v.set(n, {0, 0, 0});
    }
    const double dt = model.critical_step() / 8 / (1 << halving);
    CentralDifference<Lane> rough(std::move(model), TimeStep::fixed(dt));
    std::vector<double> out;
    for (int k = 0; k <= 64 << halving; ++k) out.push_back(rough.sampled_step().residual());
    return out;
  };
  const auto coarse = residual(0), fine = residual(1), finest = residual(2);
  const auto largest = [](const std::vector<double>& r) {
    double out = 0;
    for (double x : r) out = std::max(out, std::abs(x));
    return out;
  };
  claim("V-MODEL-04", std::abs(coarse.front()), 0, "residual of the first row [kN mm]");
  claim("V-MODEL-04", std::abs(std::log2(largest(coarse) / largest(finest)) / 2 - 2), 0.3,
        "order of the residual of a start out of equilibrium over two halvings, off 2");
  REQUIRE(largest(fine) > 0);
}

TEST_SUITE_END();
