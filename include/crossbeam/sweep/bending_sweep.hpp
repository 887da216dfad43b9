#pragma once
/// @file
/// Bending of the yarns along the fibre lines of a mesh, rotation-free; the yarns' natural state is
/// straight. Theory: docs/theory/bending.md.

#include "crossbeam/base/simd.hpp"
#include "crossbeam/element/bending.hpp"
#include "crossbeam/law/fabric.hpp"
#include "crossbeam/model/force_block.hpp"
#include "crossbeam/sweep/index_batches.hpp"
#include "crossbeam/sweep/lane_array.hpp"
#include "crossbeam/sweep/run_vectors.hpp"

#include <algorithm>
#include <array>
#include <cmath>
#include <tuple>
#include <type_traits>
#include <utility>
#include <vector>

namespace crossbeam {

/// @tparam T pack
template <class T>
class BendingSweep final : public ForceBlock<real_t<T>> {
 public:
  using R = real_t<T>;
  static constexpr int lanes = lanes_v<T>;

  /// @param planes mirror planes: a yarn that crosses one continues into its mirror image, tag
  /// [B-4]
  template <int Corners>
  BendingSweep(const Mesh<Corners>& mesh, const BendingStiffness& stiffness, double areal_mass,
               const SymmetryPlanes& planes = {})
      : node_count_(mesh.node_count), areal_mass_(areal_mass) {
    require_positive("areal_mass", areal_mass, "kg/mm^2");
    const double of_family[2] = {require_non_negative("bending.warp", stiffness.warp, "kN mm"),
                                 require_non_negative("bending.weft", stiffness.weft, "kN mm")};
    const std::vector<double> area = mesh.tributary_areas();
    std::vector<double> row_sum(mesh.node_count, 0.0);
    std::vector<std::pair<Key, std::vector<Stencil>>> sorted;
    const std::vector<Surroundings> around = surroundings(mesh, planes);
    for (int n = 0; n < mesh.node_count; ++n)
      for (int family = 0; family < 2; ++family) {
        if (!(of_family[family] > 0)) continue;
        const auto weights = difference(mesh, around, n, family, planes);
        if (weights.empty()) continue;
        Stencil stencil;
        stencil.stiffness = of_family[family] * area[n];
        Key key{weights.size() > 3, family, {}};
        for (const auto& w : weights) {
          stencil.node.push_back(w.id / 4);
          stencil.weight.push_back(w.weight);
          key.mirrors.push_back(w.id % 4);
        }
        double sum = 0;
        for (double w : stencil.weight) sum += std::abs(w);
        for (std::size_t k = 0; k < stencil.node.size(); ++k)
          row_sum[stencil.node[k]] += stencil.stiffness * std::abs(stencil.weight[k]) * sum;
        auto group = std::find_if(sorted.begin(), sorted.end(),
                                  [&](const auto& g) { return g.first == key; });
        if (group == sorted.end()) group = sorted.insert(group, {key, {}});
        group->second.push_back(std::move(stencil));
        ++count_;
      }
    std::sort(sorted.begin(), sorted.end(),
              [](const auto& a, const auto& b) { return a.first < b.first; });
    for (const auto& [key, stencils] : sorted) {
      if (key.mirrors.size() <= 3)
        short_.emplace_back(key.mirrors, stencils);
      else
        long_.emplace_back(key.mirrors, stencils);
    }
    for (int n = 0; n < mesh.node_count; ++n) {
      const double omega_squared = row_sum[n] / (area[n] * areal_mass);  // Gershgorin
      if (!is_finite(omega_squared))
        throw InputError("squared bending frequency of mesh.nodes[" + std::to_string(n) + "]",
                         detail::to_text(omega_squared), "1/ms^2", "a finite number");
      omega_squared_ = maximum(omega_squared_, omega_squared);
    }
  }

  void add_forces(NodalState<R>& state, double dt) override {
    const int stages =
        short_.empty() ? (long_.empty() ? 0 : long_[0].stages()) : short_[0].stages();
    for (int stage = 0; stage < stages; ++stage) add_stage(state, dt, stage);
  }
  [[nodiscard]] int bandwidth() const override {
    int widest = 0;
    for (const auto& group : short_) widest = maximum(widest, group.bandwidth());
    for (const auto& group : long_) widest = maximum(widest, group.bandwidth());
    return widest;
  }
  void arrange(const std::vector<int>& level_start) override {
    for (auto& group : short_) group.arrange(level_start);
    for (auto& group : long_) group.arrange(level_start);
  }
  void add_stage(NodalState<R>& state, double, int stage) override {
    for (const auto& group : short_) group.add_forces(state, stage);
    for (const auto& group : long_) group.add_forces(state, stage);
  }
  void add_energy(const NodalState<R>& state, EnergyLedger& ledger) const override {
    double sum = 0;
    for (const auto& group : short_) sum += group.energy(state);
    for (const auto& group : long_) sum += group.energy(state);
    ledger.add("bending", EnergyKind::stored, sum);
  }
  [[nodiscard]] std::optional<int> node_count() const override { return node_count_; }
  [[nodiscard]] std::optional<double> areal_mass() const override { return areal_mass_; }
  void add_tangent(const NodalState<R>&, TangentEntries& tangent) const override {
    for (const auto& group : short_) group.add_tangent(tangent);
    for (const auto& group : long_) group.add_tangent(tangent);
  }
  [[nodiscard]] double omega_squared() const override { return omega_squared_; }

  /// Curvature stencils in the block; at most two per node.
  [[nodiscard]] int stencils() const { return count_; }

 private:
  struct Stencil {
    std::vector<int> node;
    std::vector<double> weight;
    double stiffness = 0;  // D A [kN mm^3]
  };
  // Stencils that one group holds: of one yarn family, so that they follow each other along a row,
  // and with the same mirrorings of their columns: bit 0 at x = 0, bit 1 at y = 0.
  struct Key {
    bool is_long;
    int family;
    std::vector<int> mirrors;
    bool operator==(const Key&) const = default;
    bool operator<(const Key& other) const {
      return std::tie(is_long, family, mirrors) <
             std::tie(other.is_long, other.family, other.mirrors);
    }
  };
  static int label(int node, int mirror) { return node * 4 + mirror; }

  struct Surroundings {
    std::vector<int> nodes;  ///< in their order, each once
    Vec3<double> warp{}, weft{}, normal{};
    bool rim = false;  ///< on a free edge
  };

  static void keep_once(std::vector<int>& nodes) {
    std::sort(nodes.begin(), nodes.end());
    nodes.erase(std::unique(nodes.begin(), nodes.end()), nodes.end());
  }

  template <int Corners>
  static std::vector<Surroundings> surroundings(const Mesh<Corners>& mesh,
                                                const SymmetryPlanes& planes) {
    std::vector<Surroundings> out(mesh.node_count);
    std::vector<std::pair<int, int>> edges;  // of all elements
    for (int e = 0; e < mesh.element_count(); ++e) {
      const auto& corners = mesh.elements[e];
      const Vec3<double> normal = cross(mesh.fibres[e].warp, mesh.fibres[e].weft);
      for (int a = 0; a < Corners; ++a) {
        const int n = corners[a], next = corners[(a + 1) % Corners];
        out[n].warp = out[n].warp + mesh.fibres[e].warp;
        out[n].weft = out[n].weft + mesh.fibres[e].weft;
        out[n].normal = out[n].normal + normal;
        for (int m : corners)
          if (m != n) out[n].nodes.push_back(m);
        edges.push_back(std::minmax(n, next));
      }
    }
    for (Surroundings& around : out) keep_once(around.nodes);
    std::sort(edges.begin(), edges.end());
    for (std::size_t k = 0, next = 0; k < edges.size(); k = next) {
      const auto edge = edges[k];
      while (next < edges.size() && edges[next] == edge) ++next;
      const Vec3<double> A = mesh.nodes.get(edge.first), B = mesh.nodes.get(edge.second);
      const double tolerance = 1e-9 * detail::norm(B - A);
      const auto zero = [&](double a, double b) {
        return std::abs(a) <= tolerance && std::abs(b) <= tolerance;
      };
      const bool mirrored = (planes.x && zero(A.x, B.x)) || (planes.y && zero(A.y, B.y));
      if (next - k == 1 && !mirrored) out[edge.first].rim = out[edge.second].rim = true;
    }
    return out;
  }

  /// A yarn ends at a free edge unless it runs along it. Inside, where no node lies on the yarn's
  /// line and the elements of a node do not determine the weights, the next ring of nodes helps.
  template <int Corners>
  static std::vector<StencilWeight> difference(const Mesh<Corners>& mesh,
                                               const std::vector<Surroundings>& around, int n,
                                               int family, const SymmetryPlanes& planes) {
    auto neighbours = ring(mesh, around[n], n, family, planes);
    auto weights = three_point_difference(label(n, 0), neighbours);
    if (!weights.empty() || around[n].rim) return weights;
    weights = quadratic_difference(label(n, 0), neighbours);
    if (!weights.empty()) return weights;
    Surroundings wider = around[n];
    for (int m : around[n].nodes)
      wider.nodes.insert(wider.nodes.end(), around[m].nodes.begin(), around[m].nodes.end());
    keep_once(wider.nodes);
    wider.nodes.erase(std::find(wider.nodes.begin(), wider.nodes.end(), n));
    return quadratic_difference(label(n, 0), ring(mesh, wider, n, family, planes));
  }

  /// Neighbours of a node in the frame of one fibre family; beyond a mirror plane, their images.
  template <int Corners>
  static std::vector<StencilNeighbour> ring(const Mesh<Corners>& mesh, const Surroundings& around,
                                            int n, int family, const SymmetryPlanes& planes) {
    const Vec3<double> X = mesh.nodes.get(n);
    const Vec3<double> F = family == 0 ? around.warp : around.weft;
    const Vec3<double> along = (1 / detail::norm(F)) * F;
    const Vec3<double> sideways = cross(around.normal, along);
    const Vec3<double> across = (1 / detail::norm(sideways)) * sideways;
    double size = 0;
    for (int m : around.nodes) size = maximum(size, detail::norm(mesh.nodes.get(m) - X));
    const bool on_x = planes.x && std::abs(X.x) < 1e-9 * size;
    const bool on_y = planes.y && std::abs(X.y) < 1e-9 * size;
    std::vector<StencilNeighbour> out;
    for (int m : around.nodes)
      for (int mirror = 0; mirror < 4; ++mirror) {
        if (((mirror & 1) && !on_x) || ((mirror & 2) && !on_y)) continue;
        Vec3<double> Y = mesh.nodes.get(m);
        // The image of a node on the plane is the node itself.
        if ((mirror & 1) && std::abs(Y.x) < 1e-9 * size) continue;
        if ((mirror & 2) && std::abs(Y.y) < 1e-9 * size) continue;
        if (mirror & 1) Y.x = -Y.x;
        if (mirror & 2) Y.y = -Y.y;
        const Vec3<double> d = Y - X;
        out.push_back({label(m, mirror), dot(d, along), dot(d, across)});
      }
    if (out.size() >= most) {  // the nearest ones, and room for the centre
      std::stable_sort(out.begin(), out.end(), [](const auto& a, const auto& b) {
        return std::hypot(a.along, a.across) < std::hypot(b.along, b.across);
      });
      out.resize(most - 1);
    }
    return out;
  }

  /// Stencils of the same mirror pattern; Columns of them, unused columns with weight zero.
  template <int Columns>
  class Group {
   public:
    Group(const std::vector<int>& mirrors, const std::vector<Stencil>& stencils) {
      used_ = static_cast<int>(mirrors.size());
      CROSSBEAM_EXPECTS(used_ <= Columns);
      for (int k = 0; k < used_; ++k) {
        sign_x_[k] = (mirrors[k] & 1) ? R(-1) : R(1);
        sign_y_[k] = (mirrors[k] & 2) ? R(-1) : R(1);
        mirrored_ = mirrored_ || mirrors[k] != 0;
      }
      std::vector<std::array<int, Columns>> tuples;
      for (const Stencil& s : stencils) {
        std::array<int, Columns> t;
        for (int k = 0; k < Columns; ++k) t[k] = s.node[minimum(k, used_ - 1)];
        tuples.push_back(t);
      }
      batches_ = IndexBatches<Columns, T>(tuples);
      constants_ = LaneArray<T>(batches_.size(), Columns);
      stiffness_ = LaneArray<T>(batches_.size(), 1);
      for (int b = 0; b < batches_.size(); ++b)
        for (int l = 0; l < lanes; ++l) {
          if (!batches_[b].holds(l)) continue;  // idle lanes keep a stiffness of zero
          const Stencil& s = stencils[batches_.tuple(b, l)];
          for (int k = 0; k < used_; ++k) constants_.at(b, k, l) = R(s.weight[k]);
          stiffness_.at(b, 0, l) = R(s.stiffness);
        }
      constants_.collapse_if_uniform(
          [this](int) {
            R largest(0);
            for (int k = 0; k < used_; ++k)
              largest = maximum(largest, std::abs(constants_.at(0, k, 0)));
            return largest;
          },
          [this](int b, int lane) { return batches_[b].holds(lane); });
      for (int b = 0; b < batches_.size(); ++b)
        has_gathered_ = has_gathered_ || batches_[b].gather_row >= 0;
      for (int k = 0; k < used_ && batches_.size() > 0; ++k) {
        const R w = constants_.at(0, k, 0);
        weights_[0][k] = sign_x_[k] * w;
        weights_[1][k] = sign_y_[k] * w;
        weights_[2][k] = w;
      }
    }

    [[nodiscard]] int stages() const { return batches_.stages(); }
    [[nodiscard]] int bandwidth() const { return batches_.bandwidth(); }
    void arrange(const std::vector<int>& level_start) { batches_.arrange(level_start); }

    void add_forces(NodalState<R>& state, int stage) const {
      const int first = batches_.first_run(stage), last = batches_.first_run(stage + 1);
      if (first == last) return;
      if (mirrored_)
        sweep<true>(state, first, last);
      else
        sweep<false>(state, first, last);
    }

    [[nodiscard]] double energy(const NodalState<R>& state) const {
      double sum = 0;
      const T zero(R(0));
      for (int b = 0; b < batches_.size(); ++b) {
        using U = double_lanes_t<T>;
        const Vec3<T> kappa = curvature<true, T>(
            [&](int k) { return batches_.template gather<U>(state.x, batches_[b], k); },
            constants_.data(b));
        const T energy = stiffness_.load(b, 0) * dot(kappa, kappa);
        sum +=
            0.5 * static_cast<double>(lane_sum(select(batches_.active(batches_[b]), energy, zero)));
      }
      return sum;
    }

    void add_tangent(TangentEntries& tangent) const {
      for (int b = 0; b < batches_.size(); ++b)
        for (int l = 0; l < lanes; ++l)
          for (int i = 0; i < used_ && batches_[b].holds(l); ++i)
            for (int j = 0; j < used_; ++j) {
              const double k = static_cast<double>(stiffness_.load(b, 0)[l]) *
                               static_cast<double>(constants_.load(b, i)[l]) *
                               static_cast<double>(constants_.load(b, j)[l]);
              const Eigen::Vector3d diagonal(
                  k * static_cast<double>(sign_x_[i]) * static_cast<double>(sign_x_[j]),
                  k * static_cast<double>(sign_y_[i]) * static_cast<double>(sign_y_[j]), k);
              TangentEntries::add(tangent.stiffness, 3 * batches_.node(b, i, l),
                                  3 * batches_.node(b, j, l),
                                  Eigen::Matrix3d(diagonal.asDiagonal()));
            }
    }

   private:
    template <bool Mirrored, class U>
    CROSSBEAM_INLINE Vec3<U> signed_copy(const Vec3<U>& v, int k) const {
      if constexpr (Mirrored)
        return {U(sign_x_[k]) * v.x, U(sign_y_[k]) * v.y, v.z};
      else
        return v;
    }

    using Narrow = difference_lanes_t<T>;
    using Wide = double_lanes_t<Narrow>;  // of positions

    /// Second difference of the positions of a tuple along its yarn.
    /// @tparam U lanes of T, or half of them
    /// @param x(k) column k of the tuple, in double; @param weight where the weights begin
    template <bool Mirrored, class U, class Position>
    CROSSBEAM_INLINE Vec3<U> curvature(const Position& x, const R* weight) const {
      constexpr bool is_double = std::is_same_v<R, double>;
      // Positions more precise than the run: differences first, for the weights' sum is zero [D-6].
      const auto x0 = signed_copy<Mirrored>(x(0), 0);
      const auto term = [&](int k) CROSSBEAM_INLINE_LAMBDA {
        const auto xk = signed_copy<Mirrored>(x(k), k);
        if constexpr (is_double)
          return U::load(weight + k * lanes) * xk;
        else
          return U::load(weight + k * lanes) * convert<U>(xk - x0);
      };
      constexpr int first = is_double ? 0 : 1;
      Vec3<U> kappa = term(first);
      if constexpr (Columns == 3)  // unused columns have no weight
        unrolled<Columns - 1 - first>(
            [&](auto k) CROSSBEAM_INLINE_LAMBDA { kappa = kappa + term(first + 1 + k); });
      else
        for (int k = first + 1; k < used_; ++k) kappa = kappa + term(k);
      return kappa;
    }

    template <bool Mirrored>
    void sweep(NodalState<R>& state, int first_run, int last_run) const {
      if (constants_.is_uniform()) walk<Mirrored, 1>(state, first_run, last_run);
      if (!constants_.is_uniform() || has_gathered_)
        walk<Mirrored, Columns>(state, first_run, last_run);
    }

    /// @tparam Vectors 1: the contiguous runs of uniform stencils, whose columns get the moment times a
    /// constant. Columns: the others, with weights of every stencil's own or nodes all over the place.
    template <bool Mirrored, int Vectors>
    void walk(NodalState<R>& state, int first_run, int last_run) const {
      typename IndexBatches<Columns, T>::template Gathered<Wide> gathered;
      RunVectors<Vectors, Columns, T> forces;
      if constexpr (Vectors > 1) clear_unused(forces);
      for (int r = first_run; r < last_run; ++r) {
        const auto& run = batches_.run(r);
        if ((constants_.is_uniform() && run.contiguous) != (Vectors == 1)) continue;
        const auto x = batches_.template view<Wide>(state.x, run, gathered);
        const R *weight = constants_.data(run.first_batch),
                *stiffness = stiffness_.data(run.first_batch);
        const std::size_t stride = constants_.stride();
        const int end = run.batches * lanes;
        for (int i = 0; i < end; i += lanes, weight += stride, stiffness += lanes)
          for (int part = 0; part < lanes; part += lanes_v<Narrow>) {
            const R* const w = weight + part;
            const Vec3<Narrow> kappa = curvature<Mirrored, Narrow>(
                [&](int k) CROSSBEAM_INLINE_LAMBDA { return x.load(k, i + part); }, w);
            const Vec3<Narrow> m = Narrow::load(stiffness + part) * kappa;
            if constexpr (Vectors == 1)
              forces.put(0, i + part, m);
            else
              for (int k = 0; k < used_; ++k)
                forces.put(k, i + part, Narrow::load(w + k * lanes) * signed_copy<Mirrored>(m, k));
          }
        if (end > run.length)
          forces.keep(Vectors == 1 ? 1 : used_, end - lanes,
                      batches_.active(batches_[run.first_batch + run.batches - 1]));
        if constexpr (Vectors == 1)
          forces.subtract_from(state.f, batches_, run, weights_);
        else
          forces.subtract_from(state.f, batches_, run);
      }
    }

    /// Columns without a node have no force.
    void clear_unused(RunVectors<Columns, Columns, T>& forces) const {
      const T zero(R(0));
      for (int k = used_; k < Columns; ++k)
        for (int i = 0; i < IndexBatches<Columns, T>::run_capacity; i += lanes)
          forces.put(k, i, Vec3<T>{zero, zero, zero});
    }

    int used_ = 0;
    bool mirrored_ = false, has_gathered_ = false;
    std::array<R, Columns> sign_x_{}, sign_y_{};
    std::array<R, Columns> weights_[3]{};  // with their signs, of uniform stencils
    IndexBatches<Columns, T> batches_;
    LaneArray<T> constants_;  // weights
    LaneArray<T> stiffness_;
  };

  static constexpr int most = 32;  // nodes of an oblique stencil: the ring and its images
  std::vector<Group<3>> short_;
  std::vector<Group<most>> long_;
  int node_count_;
  double areal_mass_, omega_squared_ = 0;
  int count_ = 0;
};

}  // namespace crossbeam
