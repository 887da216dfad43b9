#pragma once
/// @file
/// Equilibrium of a model at one instant: the forces at rest and their consistent tangent, for any
/// nonlinear solver. Theory: docs/theory/reference.md, [R-4].

#include "crossbeam/model/model.hpp"

#include <Eigen/SparseCore>

#include <algorithm>
#include <cmath>
#include <cstdint>
#include <vector>

namespace crossbeam {

/// r(q) = 0, q as in FirstOrderSystem. Friction: an elastic stick is stretched on from where it
/// stands and slips at the cone; a friction of rates vanishes at rest.
class StaticProblem {
 public:
  using Matrix = Eigen::SparseMatrix<double, Eigen::ColMajor, std::int64_t>;

  /// @param model changed by every call below; it must outlive the problem
  /// @param time  whose tool positions and forces are held [ms]
  StaticProblem(Model<double>& model, double time) : model_(model), time_(time) {
    model.require_no_memory();
    for (std::size_t k = 0; k < model.tools().size(); ++k) {
      model.tools()[k]->come_to_rest(model.nodes());
      const ToolMotion& motion = model.tools()[k]->motion();
      if (motion.is_free())
        free_tools_.push_back(static_cast<int>(k));
      else
        model.tools()[k]->place(motion.position(time), 0);
    }
    unknowns_ = 3 * model.nodes().node_count + static_cast<int>(free_tools_.size());
    for (auto* v : {&model.nodes().v, &model.nodes().v_predicted})
      for (auto* component : {&v->x, &v->y, &v->z})
        std::fill(component->begin(), component->end(), 0.0);
  }

  [[nodiscard]] int unknowns() const { return unknowns_; }

  void read(double* q) const {
    for (int n = 0; n < model_.nodes().node_count; ++n) {
      const Vec3<double> x = model_.nodes().x.get(n);
      q[3 * n] = x.x;
      q[3 * n + 1] = x.y;
      q[3 * n + 2] = x.z;
    }
    for (std::size_t k = 0; k < free_tools_.size(); ++k)
      q[3 * model_.nodes().node_count + k] = model_.tools()[free_tools_[k]]->position();
  }

  void write(const double* q) {
    for (int n = 0; n < model_.nodes().node_count; ++n)
      model_.nodes().x.set(n, {q[3 * n], q[3 * n + 1], q[3 * n + 2]});
    for (std::size_t k = 0; k < free_tools_.size(); ++k)
      model_.tools()[free_tools_[k]]->place(q[3 * model_.nodes().node_count + k], 0);
  }

  /// Unbalanced forces [kN]; 0 in components that are held.
  void residual(const double* q, double* r) {
    evaluate(q, nullptr);
    for (int i = 0; i < unknowns_; ++i) r[i] = is_free(i) ? force_[i] : 0.0;
  }

  /// dr/dq [kN/mm], with -1 on the diagonal of components that are held.
  void tangent(const double* q, Matrix& K) {
    TangentEntries tangent;
    evaluate(q, &tangent);
    std::vector<Eigen::Triplet<double, std::int64_t>> entries;
    entries.reserve(tangent.stiffness.size() + static_cast<std::size_t>(unknowns_));
    for (const auto& e : tangent.stiffness)
      if (is_free(e.row) && is_free(e.column)) entries.emplace_back(e.row, e.column, -e.value);
    for (int i = 0; i < unknowns_; ++i) entries.emplace_back(i, i, is_free(i) ? 0.0 : -1.0);
    K.resize(unknowns_, unknowns_);
    K.setFromTriplets(entries.begin(), entries.end());
  }

  /// Norm of the internal forces alone, those at held nodes included [kN]: what a residual is
  /// compared with.
  [[nodiscard]] double internal_force(const double* q) {
    evaluate(q, nullptr);
    return internal_;
  }

 private:
  void evaluate(const double* q, TangentEntries* tangent) {
    write(q);
    NodalState<double>& s = model_.nodes();
    model_.clear_forces();
    for (const auto& b : model_.blocks()) b->add_forces(s, 1);
    double squared = 0;
    for (int n = 0; n < s.node_count; ++n) squared += dot(s.f.get(n), s.f.get(n));
    internal_ = std::sqrt(squared);
    if (tangent)
      for (const auto& b : model_.blocks()) b->add_tangent(s, *tangent);
    force_.assign(static_cast<std::size_t>(unknowns_), 0.0);
    int row = 3 * s.node_count;
    for (const auto& tool : model_.tools()) {
      const bool free = tool->motion().is_free();
      const double f = tool->add_rest_forces(s, free ? row : -1, tangent);
      if (free) force_[row++] = tool->motion().force(time_) - f;
    }
    for (int n = 0; n < s.node_count; ++n) {
      const Vec3<double> f = s.f.get(n);
      force_[3 * n] = f.x;
      force_[3 * n + 1] = f.y;
      force_[3 * n + 2] = f.z;
    }
  }

  [[nodiscard]] bool is_free(int i) const {
    const NodalState<double>& s = model_.nodes();
    const int n = i / 3;
    if (n >= s.node_count) return true;
    const double* free[] = {s.free.x.data(), s.free.y.data(), s.free.z.data()};
    return free[i % 3][n] > 0;
  }

  Model<double>& model_;
  double time_;
  std::vector<int> free_tools_;
  std::vector<double> force_;
  double internal_ = 0;
  int unknowns_ = 0;
};

}  // namespace crossbeam
