#pragma once
/// @file
/// What a membrane sweep keeps of the reference state: coefficients of the fibre vectors, weights,
/// viscosity and hourglass control of its elements, and the bounds for the time step. Theory:
/// docs/theory/sweep.md, [S-2].

#include "crossbeam/element/frequency.hpp"
#include "crossbeam/element/membrane.hpp"
#include "crossbeam/mesh/mesh.hpp"
#include "crossbeam/sweep/index_batches.hpp"
#include "crossbeam/sweep/lane_array.hpp"

#include <cmath>
#include <cstddef>
#include <numbers>
#include <string>

namespace crossbeam {

struct MembraneOptions {
  double hourglass_modulus = 0;  ///< of one-point quadrilaterals [kN/mm]; >= 0, tag [E-4]
  double bulk_viscosity = 0;     ///< linear, on the fibre stretch rates [-]; >= 0, tag [D-5]
};

/// Constants of the batches of a run at one Gauss point, one batch after the other.
/// @tparam T pack; @tparam M relative vectors in a point; @tparam Hourglass first of its constants
template <class T, int M, int Hourglass>
struct PointConstants {
  const real_t<T>* at;
  std::size_t stride;

  CROSSBEAM_INLINE void next() { at += stride; }
  CROSSBEAM_INLINE T load(int component) const { return T::load(at + component * lanes_v<T>); }
  CROSSBEAM_INLINE PointLanes<T, M> point() const {
    PointLanes<T, M> out;
    unrolled<M>([&](auto k) CROSSBEAM_INLINE_LAMBDA {
      out.t1[k] = load(k);
      out.t2[k] = load(M + k);
    });
    out.weight = load(2 * M);
    return out;
  }
  /// mu of [D-5].
  [[nodiscard]] CROSSBEAM_INLINE T viscosity() const { return load(2 * M + 1); }
  /// p_1, p_2 and the stiffness per unit of the hourglass modulus, [E-4].
  [[nodiscard]] CROSSBEAM_INLINE T hourglass(int k) const { return load(Hourglass + k); }
};

/// @tparam T pack; @tparam Element Triangle or Quadrilateral<1 or 4>
template <class T, class Element>
class MembraneConstants {
 public:
  using R = real_t<T>;
  static constexpr int corners = Element::corners;
  static constexpr int M = Element::membrane_vectors;
  static constexpr int point_size = 2 * M + 2;  ///< t1, t2, weight, viscosity
  static constexpr int hourglass_at = Element::points * point_size;
  static constexpr int size = hourglass_at + (Element::has_hourglass ? 3 : 0);
  using AtPoint = PointConstants<T, M, hourglass_at>;
  using Batches = IndexBatches<corners, T>;

  /// @param angle between the law's yarns; @param stiffness bound of the law's [kN/mm]
  /// @throws InputError when the fibre angle of an element differs from the law's.
  MembraneConstants(const Mesh<corners>& mesh, const Batches& batches, double angle,
                    double stiffness, double areal_mass, const MembraneOptions& options)
      : hourglass_modulus_(
            R(require_non_negative("hourglass_modulus", options.hourglass_modulus, "kN/mm"))),
        viscous_(require_non_negative("bulk_viscosity", options.bulk_viscosity, "-") > 0),
        numbers_(batches.size(), size) {
    require_positive("areal_mass", areal_mass, "kg/mm^2");
    const double impedance = options.bulk_viscosity * std::sqrt(areal_mass * stiffness);
    for (int e = 0; e < mesh.element_count(); ++e) {
      require_angle(mesh, e, angle);
      bound(mesh, e, stiffness, areal_mass, impedance);
    }
    for (int b = 0; b < batches.size(); ++b)
      for (int l = 0; l < lanes_v<T>; ++l) fill(mesh, batches.tuple(b, l), b, l, impedance);
    collapse(batches);
  }

  /// Constants of the batches from `first` on at point p.
  [[nodiscard]] CROSSBEAM_INLINE AtPoint at_point(int first, int p) const {
    return {numbers_.data(first) + p * point_size * lanes_v<T>, numbers_.stride()};
  }
  [[nodiscard]] CROSSBEAM_INLINE R hourglass_modulus() const { return hourglass_modulus_; }
  /// Whether an element is no parallelogram.
  [[nodiscard]] CROSSBEAM_INLINE bool is_skewed() const { return skewed_; }
  [[nodiscard]] bool is_viscous() const { return viscous_; }
  /// Of all elements, as ForceBlock's.
  [[nodiscard]] double omega_squared() const { return omega_squared_; }
  [[nodiscard]] double damping_rate() const { return damping_rate_; }

 private:
  static void require_angle(const Mesh<corners>& mesh, int e, double angle) {
    if (std::abs(mesh.fibre_angle(e) - angle) <= 1e-6) return;
    constexpr double degree = std::numbers::pi / 180;
    throw InputError("mesh.fibres[" + std::to_string(e) + "] angle from warp to weft",
                     detail::to_text(mesh.fibre_angle(e) / degree), "deg",
                     "the law's " + detail::to_text(angle / degree));
  }

  void bound(const Mesh<corners>& mesh, int e, double stiffness, double areal_mass,
             double impedance) {
    const double omega_squared = element_omega_squared<Element>(
        mesh.corners(e), mesh.fibres[e], stiffness, static_cast<double>(hourglass_modulus_),
        areal_mass * mesh.area(e) / corners);
    if (!std::isfinite(omega_squared))
      throw InputError("squared frequency of mesh.elements[" + std::to_string(e) + "]",
                       detail::to_text(omega_squared), "1/ms^2", "a finite number");
    omega_squared_ = maximum(omega_squared_, omega_squared);
    // mu = b rho c h with h = sqrt(A); it acts where the stiffness acts, mu / stiffness as strong.
    double area = 0;
    for (const auto& p : Element::coefficients(mesh.corners(e), mesh.fibres[e]))
      area = maximum(area, Element::points * p.weight);
    damping_rate_ = maximum(damping_rate_, impedance * std::sqrt(area) / stiffness * omega_squared);
  }

  void fill(const Mesh<corners>& mesh, int e, int b, int lane, double impedance) {
    const auto X = mesh.corners(e);
    const auto points = Element::coefficients(X, mesh.fibres[e]);
    for (int p = 0; p < Element::points; ++p) {
      const int first = p * point_size;
      for (int k = 0; k < M; ++k) {
        numbers_.at(b, first + k, lane) = R(points[p].t1[k]);
        numbers_.at(b, first + M + k, lane) = R(points[p].t2[k]);
      }
      numbers_.at(b, first + 2 * M, lane) = R(points[p].weight);
      numbers_.at(b, first + 2 * M + 1, lane) =
          R(impedance * std::sqrt(Element::points * points[p].weight));
    }
    if constexpr (Element::has_hourglass) {
      const auto h = Element::hourglass(X);
      constexpr double rounding = 1e-11;  // of the mesh's coordinates: a parallelogram has p = 0
      const bool skewed = std::abs(h.p1) > rounding || std::abs(h.p2) > rounding;
      skewed_ = skewed_ || skewed;
      numbers_.at(b, hourglass_at, lane) = skewed ? R(h.p1) : R(0);
      numbers_.at(b, hourglass_at + 1, lane) = skewed ? R(h.p2) : R(0);
      numbers_.at(b, hourglass_at + 2, lane) = R(h.stiffness);
    }
  }

  /// Coefficients are compared with the largest of their point, [1/length].
  void collapse(const Batches& batches) {
    numbers_.collapse_if_uniform(
        [this](int c) {
          R largest(0);
          const int point = c / point_size * point_size;
          if (c < hourglass_at && c % point_size < 2 * M)
            for (int k = 0; k < 2 * M; ++k)
              largest = maximum(largest, std::abs(numbers_.at(0, point + k, 0)));
          else if (c < hourglass_at || c == hourglass_at + 2)
            largest = std::abs(numbers_.at(0, c, 0));
          else
            largest = R(1);
          return largest;
        },
        [&batches](int b, int lane) { return batches[b].holds(lane); });
  }

  R hourglass_modulus_;
  bool viscous_, skewed_ = false;
  double omega_squared_ = 0, damping_rate_ = 0;
  LaneArray<T> numbers_;
};

}  // namespace crossbeam
