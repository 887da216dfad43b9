#pragma once
/// @file
/// A checked surface mesh of one element type in space, with explicit fibre directions per element.
/// Nothing about the fibres is taken from the numbering of an element.

#include "crossbeam/base/scalar.hpp"
#include "crossbeam/element/coefficients.hpp"
#include "crossbeam/element/quadrilateral.hpp"
#include "crossbeam/element/triangle.hpp"
#include "crossbeam/mesh/arrays.hpp"

#include <algorithm>
#include <array>
#include <cmath>
#include <limits>
#include <numbers>
#include <string>
#include <vector>

namespace crossbeam {

/// What a mesh must not fall below, or exceed.
namespace mesh_limits {

/// Twice the area of an element over the square of its longest side [-]. Flatter elements are taken
/// for lines: in the arithmetic of the reference coefficients nine of double's digits are gone.
inline constexpr double flatness = 1e-9;

/// Angle between a fibre and the plane of its element [rad]. Up to this one a direction is
/// projected into the plane; beyond, it was probably meant for another element.
inline constexpr double fibre_out_of_plane = 5 * std::numbers::pi / 180;

/// Least angle between warp and weft, and between weft and reversed warp [rad]. Directions nearer
/// than that are taken for a slip, such as the same vector given twice.
inline constexpr double fibre_angle = 1e-3;

}  // namespace mesh_limits

/// @tparam Corners 3 or 4
template <int Corners>
struct Mesh {
  int node_count = 0;
  NodeVectors<double> nodes;                       ///< reference positions [mm]
  std::vector<std::array<int, Corners>> elements;  ///< node numbers, counter-clockwise
  std::vector<FibreDirections<double>> fibres;     ///< per element; normalised by the constructor

  /// Checks everything that a simulation relies on and normalises the fibre directions.
  /// @param positions reference positions [mm]
  /// @param fibre_directions warp and weft of each element: vectors in its plane, of any length
  /// @throws InputError that names element or node: where a node number is out of range, a
  ///   coordinate or direction is not finite, an element has no area or an inverted corner, a fibre
  ///   leaves the element's plane (mesh_limits), or warp and weft lie at 0 or 180 deg or the wrong
  ///   way round.
  Mesh(const std::vector<Vec3<double>>& positions,
       std::vector<std::array<int, Corners>> connectivity,
       std::vector<FibreDirections<double>> fibre_directions)
      : node_count(static_cast<int>(positions.size())),
        nodes(node_count),
        elements(std::move(connectivity)),
        fibres(std::move(fibre_directions)) {
    if (elements.empty()) throw InputError("mesh.elements", "0", "", "1 or more");
    if (fibres.size() != elements.size())
      throw InputError("mesh.fibres", std::to_string(fibres.size()) + " directions", "",
                       "one pair per element, " + std::to_string(elements.size()));
    for (int n = 0; n < node_count; ++n) {
      const std::string name = "mesh.nodes[" + std::to_string(n) + "]";
      require_finite(name + ".x", positions[n].x, "mm");
      require_finite(name + ".y", positions[n].y, "mm");
      require_finite(name + ".z", positions[n].z, "mm");
      nodes.set(n, positions[n]);
    }
    for (std::size_t e = 0; e < elements.size(); ++e) check_element(e);
  }

  [[nodiscard]] int element_count() const { return static_cast<int>(elements.size()); }

  [[nodiscard]] std::array<Vec3<double>, Corners> corners(int element) const {
    std::array<Vec3<double>, Corners> X;
    for (int a = 0; a < Corners; ++a) X[a] = nodes.get(elements[element][a]);
    return X;
  }

  /// Angle from warp to weft of an element in the reference state [rad].
  [[nodiscard]] double fibre_angle(int element) const {
    return std::atan2(detail::norm(cross(fibres[element].warp, fibres[element].weft)),
                      dot(fibres[element].warp, fibres[element].weft));
  }

  [[nodiscard]] double area(int element) const {
    using Element = std::conditional_t<Corners == 3, Triangle, Quadrilateral<1>>;
    return detail::norm(Element::area_vector(corners(element))) / 2;
  }

  /// Reference area that belongs to each node: an equal share of its elements [mm^2].
  [[nodiscard]] std::vector<double> tributary_areas() const {
    std::vector<double> A(node_count, 0.0);
    for (int e = 0; e < element_count(); ++e)
      for (int n : elements[e]) A[n] += area(e) / Corners;
    return A;
  }

 private:
  void check_element(std::size_t e) {
    const std::string name = "mesh.elements[" + std::to_string(e) + "]";
    for (int n : elements[e])
      if (n < 0 || n >= node_count)
        throw InputError(name, std::to_string(n), "",
                         "node numbers from 0 to " + std::to_string(node_count - 1));
    const auto X = corners(static_cast<int>(e));
    using Element = std::conditional_t<Corners == 3, Triangle, Quadrilateral<1>>;
    const Vec3<double> area_vector = Element::area_vector(X);
    const double twice_area = detail::norm(area_vector);
    double longest = 0;
    for (int a = 0; a < Corners; ++a)
      longest = maximum(longest, detail::norm(X[(a + 1) % Corners] - X[a]));
    // An area below the second bound has not all its digits.
    constexpr double least =
        (std::numeric_limits<double>::min)() / std::numeric_limits<double>::epsilon();
    if (!(twice_area > mesh_limits::flatness * longest * longest && twice_area > least))
      throw InputError(name + " area", detail::to_text(twice_area / 2), "mm^2",
                       "> 0 (the corners are collinear or coincide)");
    const Vec3<double> n = (1 / twice_area) * area_vector;
    for (int a = 0; a < Corners; ++a) {
      const Vec3<double> in = X[a] - X[(a + Corners - 1) % Corners];
      const Vec3<double> out = X[(a + 1) % Corners] - X[a];
      const double turn = dot(cross(in, out), n);
      if (!(turn > 0))
        throw InputError(name + " corner " + std::to_string(a), detail::to_text(turn), "mm^2",
                         "> 0 (the element is inverted or not convex)");
    }
    FibreDirections<double>& f = fibres[e];
    f.warp = direction("mesh.fibres[" + std::to_string(e) + "].warp", f.warp, n);
    f.weft = direction("mesh.fibres[" + std::to_string(e) + "].weft", f.weft, n);
    const double angle = std::atan2(dot(cross(f.warp, f.weft), n), dot(f.warp, f.weft));
    if (!(angle > mesh_limits::fibre_angle && angle < std::numbers::pi - mesh_limits::fibre_angle))
      throw InputError("mesh.fibres[" + std::to_string(e) + "] angle from warp to weft",
                       detail::to_text(angle * 180 / std::numbers::pi), "deg",
                       "strictly between 0 and 180, seen against the element's normal");
  }

  static Vec3<double> direction(const std::string& name, const Vec3<double>& v,
                                const Vec3<double>& n) {
    const double size = std::abs(v.x) + std::abs(v.y) + std::abs(v.z);
    require_positive(name + " length", size, "mm");
    // A power of two brings it to about 1 first, exactly: no length over- or underflows.
    const int exponent = std::ilogb(size);
    const Vec3<double> u{std::scalbn(v.x, -exponent), std::scalbn(v.y, -exponent),
                         std::scalbn(v.z, -exponent)};
    const double length = detail::norm(u);
    const double out_of_plane = std::asin(minimum(std::abs(dot(u, n)) / length, 1.0));
    if (out_of_plane > mesh_limits::fibre_out_of_plane)
      throw InputError(name + " angle to the element's plane",
                       detail::to_text(out_of_plane * 180 / std::numbers::pi), "deg", "0 to 5");
    const Vec3<double> in_plane = u - dot(u, n) * n;
    return (1 / detail::norm(in_plane)) * in_plane;
  }
};

/// Which coordinate planes through the origin the model is mirrored at.
struct SymmetryPlanes {
  bool x = false;  ///< the plane x = 0
  bool y = false;  ///< the plane y = 0
};

/// Longest distance between two nodes of one element [mm].
template <int Corners>
[[nodiscard]] double widest_element(const Mesh<Corners>& mesh) {
  double squared = 0;
  for (const auto& element : mesh.elements)
    for (int i = 0; i < Corners; ++i)
      for (int j = 0; j < i; ++j) {
        const Vec3<double> across = mesh.nodes.get(element[i]) - mesh.nodes.get(element[j]);
        squared = maximum(squared, dot(across, across));
      }
  return std::sqrt(squared);
}

/// A thousandth of the mesh's shortest edge [mm]: nodes closer to a mirror plane lie on it. Meshes
/// written with six digits are off by far less, and no element is as flat.
template <int Corners>
[[nodiscard]] double plane_tolerance(const Mesh<Corners>& mesh) {
  double shortest = (std::numeric_limits<double>::max)();
  for (int e = 0; e < mesh.element_count(); ++e) {
    const auto X = mesh.corners(e);
    for (int a = 0; a < Corners; ++a)
      shortest = (std::min)(shortest, detail::norm(X[(a + 1) % Corners] - X[a]));
  }
  return 1e-3 * shortest;
}

/// A flat rectangle [0, width] x [0, length] of nx x ny quadrilaterals in the plane z = 0. Nodes
/// are numbered along y first, so that consecutive elements have consecutive nodes.
/// @param warp_angle direction of the warp from the x axis [rad]
/// @param fibre_angle from warp to weft [rad]
inline Mesh<4> rectangle(double width, double length, int nx, int ny, double warp_angle = 0,
                         double fibre_angle = std::numbers::pi / 2) {
  require_positive("rectangle.width", width, "mm");
  require_positive("rectangle.length", length, "mm");
  if (nx < 1 || ny < 1)
    throw InputError("rectangle.elements", std::to_string(nx) + " x " + std::to_string(ny), "",
                     "1 x 1 or more");
  std::vector<Vec3<double>> X;
  for (int i = 0; i <= nx; ++i)
    for (int j = 0; j <= ny; ++j) X.push_back({width * i / nx, length * j / ny, 0.0});
  std::vector<std::array<int, 4>> elements;
  const int pitch = ny + 1;
  for (int i = 0; i < nx; ++i)
    for (int j = 0; j < ny; ++j) {
      const int n = i * pitch + j;
      elements.push_back({n, n + pitch, n + pitch + 1, n + 1});
    }
  // cos(90 deg) must be zero, not 6e-17: the fibre lines then pass exactly through the nodes.
  const auto unit = [](double angle) {
    constexpr double rounding_of_pi = 1e-15;
    const auto exact = [](double x) { return std::abs(x) < rounding_of_pi ? 0.0 : x; };
    return Vec3<double>{exact(std::cos(angle)), exact(std::sin(angle)), 0.0};
  };
  const std::vector<FibreDirections<double>> fibres(
      elements.size(), {unit(warp_angle), unit(warp_angle + fibre_angle)});
  return Mesh<4>(X, elements, fibres);
}

}  // namespace crossbeam
