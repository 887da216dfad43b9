#pragma once
/// @file
/// The quarter of the double dome as a model in space: mesh, fabric, tools. Every integrator and the
/// statics begin with it.

#include "case.hpp"
#include "formed_part.hpp"

#include "crossbeam/model/model.hpp"
#include "crossbeam/sweep/membrane_sweep.hpp"

#include <cmath>
#include <numbers>
#include <utility>

namespace crossbeam::drape {

/// Punch travel: a cosine over the stroke, then held.
struct PunchStroke {
  double stroke, duration;
  double operator()(double t) const {
    return t >= duration ? stroke : stroke / 2 * (1 - std::cos(std::numbers::pi * t / duration));
  }
  [[nodiscard]] double speed(double t) const {
    return t >= duration ? 0
                         : stroke / 2 * std::numbers::pi / duration *
                               std::sin(std::numbers::pi * t / duration);
  }
};

/// Tools in their order in the model.
enum QuarterTool { punch_tool = 0, die_tool = 1, holder_tool = 2 };

/// @tparam R double or float
template <class R>
class QuarterModel {
 public:
  explicit QuarterModel(const DrapeCase& c);

  [[nodiscard]] const QuarterGrid& grid() const { return grid_; }
  [[nodiscard]] const Mesh<4>& mesh() const { return mesh_; }
  [[nodiscard]] const PunchStroke& punch() const { return punch_; }
  /// Hands the model over; mesh, grid and punch stay here.
  [[nodiscard]] Model<R> release() { return std::move(model_); }

 private:
  NodalState<R> initial_state() const;
  void add_membrane();
  template <class Cell>
  void add_membrane_with(const Cell& cell);
  template <class Cell, class Shear>
  void add_membrane_with(const Cell& cell, const Shear& shear);
  template <class Law>
  void add_membrane_of(const Law& law);
  template <class Element, class Law>
  void add_block(const Law& law, const MembraneOptions& options);
  void add_tools();

  DrapeCase case_;
  QuarterGrid grid_;
  SymmetryPlanes symmetry_{true, true};
  Mesh<4> mesh_;
  PunchStroke punch_;
  Model<R> model_;
};

extern template class QuarterModel<double>;
extern template class QuarterModel<float>;

}  // namespace crossbeam::drape
