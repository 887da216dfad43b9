#pragma once
/// @file
/// A model as y' = F(t, y), for time integrators other than crossbeam's own: the same blocks, tools
/// and kernels as the explicit scheme. Theory: docs/theory/reference.md, [R-1].

#include "crossbeam/base/scalar.hpp"
#include "crossbeam/model/model.hpp"

#include <Eigen/SparseCore>

#include <algorithm>
#include <cmath>
#include <cstdint>
#include <string>
#include <vector>

namespace crossbeam {

/// y = (q, q'), q the positions (3 n + i is component i of node n), then z of the free tools.
class FirstOrderSystem {
 public:
  using Matrix = Eigen::SparseMatrix<double, Eigen::ColMajor, std::int64_t>;

  /// @param model changed by every call below; it must outlive the system
  /// @throws InputError for a contact that is not in rate form, and for a moving tool without its
  ///   velocity
  explicit FirstOrderSystem(Model<double>& model) : model_(model) {
    model.require_no_memory();
    for (std::size_t k = 0; k < model.tools().size(); ++k) {
      const std::string field = "tools[" + std::to_string(k) + "]";
      if (!model.tools()[k]->is_rate_form())
        throw InputError(field + ".friction_model", "with memory or a step", "",
                         "smooth, or no friction: a rate knows positions and velocities only");
      const ToolMotion& motion = model.tools()[k]->motion();
      if (motion.is_free()) {
        free_tools_.push_back(static_cast<int>(k));
      } else if (!motion.velocity) {
        throw InputError(field + ".velocity", "empty", "mm/ms", "dz/dt beside the position z(t)");
      }
    }
    degrees_of_freedom_ = 3 * model.nodes().node_count + static_cast<int>(free_tools_.size());
    for (const auto& tool : model.tools()) tool->reset_culling();
  }

  /// Length of y.
  [[nodiscard]] int size() const { return 2 * degrees_of_freedom_; }
  [[nodiscard]] int degrees_of_freedom() const { return degrees_of_freedom_; }
  [[nodiscard]] Model<double>& model() const { return model_; }

  /// y of the model's present state; a component that is held has no velocity.
  void read(double* y) const {
    const NodalState<double>& s = model_.nodes();
    double* v = y + degrees_of_freedom_;
    for (int n = 0; n < s.node_count; ++n) {
      y[3 * n] = s.x.x[n];
      y[3 * n + 1] = s.x.y[n];
      y[3 * n + 2] = s.x.z[n];
      v[3 * n] = s.free.x[n] * s.v.x[n];
      v[3 * n + 1] = s.free.y[n] * s.v.y[n];
      v[3 * n + 2] = s.free.z[n] * s.v.z[n];
    }
    for (std::size_t k = 0; k < free_tools_.size(); ++k) {
      y[3 * s.node_count + k] = model_.tools()[free_tools_[k]]->position();
      v[3 * s.node_count + k] = model_.tools()[free_tools_[k]]->velocity();
    }
  }

  /// Puts y and the tools' places at time t into the model.
  void write(double t, const double* y) {
    NodalState<double>& s = model_.nodes();
    const double* v = y + degrees_of_freedom_;
    double furthest = 0, tools = 0;
    for (int n = 0; n < s.node_count; ++n) {
      const Vec3<double> d = s.x.get(n) - Vec3<double>{y[3 * n], y[3 * n + 1], y[3 * n + 2]};
      furthest = maximum(furthest, dot(d, d));
      s.x.x[n] = y[3 * n];
      s.x.y[n] = y[3 * n + 1];
      s.x.z[n] = y[3 * n + 2];
      s.v.x[n] = s.v_predicted.x[n] = v[3 * n];
      s.v.y[n] = s.v_predicted.y[n] = v[3 * n + 1];
      s.v.z[n] = s.v_predicted.z[n] = v[3 * n + 2];
    }
    for (std::size_t k = 0, free = 0; k < model_.tools().size(); ++k) {
      const ToolMotion& motion = model_.tools()[k]->motion();
      const double before = model_.tools()[k]->position();
      if (motion.is_free()) {
        model_.tools()[k]->place(y[3 * s.node_count + free], v[3 * s.node_count + free]);
        ++free;
      } else {
        model_.tools()[k]->place(motion.position(t), motion.velocity(t));
      }
      tools = maximum(tools, std::abs(model_.tools()[k]->position() - before));
    }
    // However an integrator goes to and fro: the culling [F-4] adds up all of it.
    travel_ += std::sqrt(furthest) + tools;
  }

  /// y' = (q', M^-1 f - alpha q').
  void rate(double t, const double* y, double* dy) {
    write(t, y);
    constexpr double no_step = 1;  // forces in rate form do not ask for it
    model_.compute_forces(no_step, travel_);
    const NodalState<double>& s = model_.nodes();
    const double alpha = model_.mass_damping();
    const double* v = y + degrees_of_freedom_;
    double* a = dy + degrees_of_freedom_;
    std::copy(v, v + degrees_of_freedom_, dy);
    for (int n = 0; n < s.node_count; ++n) {
      const double w = s.inverse_mass[n];
      a[3 * n] = s.free.x[n] * (w * s.f.x[n] - alpha * v[3 * n]);
      a[3 * n + 1] = s.free.y[n] * (w * s.f.y[n] - alpha * v[3 * n + 1]);
      a[3 * n + 2] = s.free.z[n] * (w * s.f.z[n] - alpha * v[3 * n + 2]);
    }
    for (std::size_t k = 0; k < free_tools_.size(); ++k) {
      const ToolContact<double>& tool = *model_.tools()[free_tools_[k]];
      const ToolMotion& motion = tool.motion();
      a[3 * s.node_count + k] = (motion.force(t) - tool.force_on_fabric().z) / motion.mass -
                                motion.damping_rate * tool.velocity();
    }
    ++evaluations_;
  }

  /// dF/dy at (t, y), tag.
  void jacobian(double t, const double* y, Matrix& J) {
    write(t, y);
    TangentEntries tangent;
    tangent.with_damping = true;
    for (const auto& b : model_.blocks()) b->add_tangent(model_.nodes(), tangent);
    int row = 3 * model_.nodes().node_count;
    for (const auto& tool : model_.tools())
      tool->add_tangent(model_.nodes(), tool->motion().is_free() ? row++ : -1, tangent);
    std::vector<Eigen::Triplet<double, std::int64_t>> entries;
    entries.reserve(tangent.stiffness.size() + tangent.damping.size() +
                    2 * static_cast<std::size_t>(degrees_of_freedom_));
    const int n = degrees_of_freedom_;
    for (const auto& e : tangent.stiffness)
      entries.emplace_back(n + e.row, e.column, -inverse_inertia(e.row) * e.value);
    for (const auto& e : tangent.damping)
      entries.emplace_back(n + e.row, n + e.column, -inverse_inertia(e.row) * e.value);
    for (int i = 0; i < n; ++i) {
      entries.emplace_back(i, n + i, 1.0);
      entries.emplace_back(n + i, n + i, -damping_rate(i));
    }
    J.resize(size(), size());
    J.setFromTriplets(entries.begin(), entries.end());
    ++jacobians_;
  }

  [[nodiscard]] long long evaluations() const { return evaluations_; }
  [[nodiscard]] long long jacobians() const { return jacobians_; }

 private:
  /// 1/m of a degree of freedom; 0 where it is held.
  [[nodiscard]] double inverse_inertia(int i) const {
    const NodalState<double>& s = model_.nodes();
    const int n = i / 3;
    if (n >= s.node_count)
      return 1 / model_.tools()[free_tools_[i - 3 * s.node_count]]->motion().mass;
    const double* free[] = {s.free.x.data(), s.free.y.data(), s.free.z.data()};
    return free[i % 3][n] * s.inverse_mass[n];
  }
  [[nodiscard]] double damping_rate(int i) const {
    const int tool = i - 3 * model_.nodes().node_count;
    return tool >= 0 ? model_.tools()[free_tools_[tool]]->motion().damping_rate
                     : model_.mass_damping();
  }

  Model<double>& model_;
  std::vector<int> free_tools_;
  int degrees_of_freedom_ = 0;
  double travel_ = 0;  ///< as ToolContact::add_forces
  long long evaluations_ = 0, jacobians_ = 0;
};

}  // namespace crossbeam
