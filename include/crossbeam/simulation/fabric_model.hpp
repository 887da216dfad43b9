#pragma once
/// @file
/// A piece of fabric as a model: the mesh and the fabric are named once, and every part that is
/// added takes its numbers from them. The packs are those of the machine that is compiled for.
///
///     FabricModel model(mesh, fabric, {.symmetry = {true, true}, .mass_damping = 0.05});
///     model.add_membrane<Quadrilateral<1>>({.hourglass_modulus = 1e-4});
///     model.add_tool(Sphere<double>({0, 0, -60}, 60), ToolMotion::fixed());
///     CentralDifference drape(std::move(model), TimeStep::fraction(0.9));

#include "crossbeam/contact/rigid_tool_contact.hpp"
#include "crossbeam/dynamics/central_difference.hpp"
#include "crossbeam/law/fabric.hpp"
#include "crossbeam/model/model.hpp"
#include "crossbeam/sweep/bending_sweep.hpp"
#include "crossbeam/sweep/membrane_sweep.hpp"

#include <memory>
#include <utility>
#include <vector>

namespace crossbeam {

struct ModelOptions {
  SymmetryPlanes symmetry{};                  ///< planes that the model is mirrored at
  std::vector<NodeConstraint> constraints{};  ///< held nodes, besides those of the symmetry
  double mass_damping = 0;                    ///< alpha of the force -alpha m v [1/ms]; >= 0
};

/// @tparam Corners of the mesh's elements, 3 or 4
template <class Law, int Corners>
class FabricModel : public Model<typename Law::Real> {
 public:
  using R = typename Law::Real;
  using T = NativePack<R>;
  /// The element that a membrane has unless another is named.
  using DefaultElement = std::conditional_t<Corners == 3, Triangle, Quadrilateral<1>>;

  /// @throws InputError for a symmetry plane without nodes, a constraint of no node, a negative
  /// damping
  FabricModel(Mesh<Corners> mesh, Fabric<Law> fabric, const ModelOptions& options = {})
      : Model<R>(NodalState<R>(mesh, fabric.areal_mass(), all_constraints(mesh, options)),
                 options.mass_damping),
        mesh_(std::move(mesh)),
        fabric_(std::move(fabric)),
        symmetry_(options.symmetry) {}

  [[nodiscard]] const Mesh<Corners>& mesh() const { return mesh_; }
  [[nodiscard]] const Fabric<Law>& fabric() const { return fabric_; }

  /// The membrane forces of all elements.
  /// @tparam Element Triangle, Quadrilateral<1> or Quadrilateral<4>
  /// @throws InputError where a membrane was added before, or a fibre angle differs from the law's
  template <class Element = DefaultElement>
  void add_membrane(const MembraneOptions& options = {}) {
    static_assert(Element::corners == Corners,
                  "a membrane's element has as many corners as the elements of its mesh");
    require_first(has_membrane_, "add_membrane");
    this->add(std::make_unique<MembraneSweep<T, Element, Law>>(mesh_, fabric_.law(),
                                                               fabric_.areal_mass(), options));
    has_membrane_ = true;
  }

  /// The bending forces of the fabric's yarns; of a fabric that doesn't bend none, at no cost.
  /// @throws InputError where bending was added before
  void add_bending() {
    require_first(has_bending_, "add_bending");
    if (fabric_.bends())
      this->add(std::make_unique<BendingSweep<T>>(mesh_, fabric_.bending(), fabric_.areal_mass(),
                                                  symmetry_));
    has_bending_ = true;
  }

  /// A rigid tool. Its surface is the one that the fabric's middle surface rests on: half the
  /// fabric's thickness off the tool itself.
  template <class Shape>
    requires Surface<Shape, T>
  void add_tool(Shape shape, ToolMotion motion, const ContactParameters& parameters = {}) {
    this->add(std::make_unique<RigidToolContact<T, Shape>>(std::move(shape), std::move(motion),
                                                           parameters, mesh_.node_count));
  }

 private:
  static std::vector<NodeConstraint> all_constraints(const Mesh<Corners>& mesh,
                                                     const ModelOptions& options) {
    std::vector<NodeConstraint> out = symmetry_constraints(mesh, options.symmetry);
    out.insert(out.end(), options.constraints.begin(), options.constraints.end());
    return out;
  }
  static void require_first(bool before, const char* call) {
    if (before) throw InputError(call, "a second call", "", "one call for a model");
  }

  Mesh<Corners> mesh_;
  Fabric<Law> fabric_;
  SymmetryPlanes symmetry_;
  bool has_membrane_ = false, has_bending_ = false;
};

}  // namespace crossbeam
